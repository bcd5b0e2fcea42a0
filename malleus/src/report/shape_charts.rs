//! Charts of the modes of a shape: levels, gains along the path, decays, and errors.

use shape::solve::{Mode, Solved};

use super::chart::{Axis, Chart};

/// Range of levels that is shown, in dB below the loudest mode.
const RANGE_DB: f64 = 80.0;
/// Colours of modes along the path.
const CLASSES: [&str; 5] = ["fit", "recording", "law", "noise", "room"];
/// Lowest error and change that is shown, percent.
const LEAST_PERCENT: f64 = 1e-5;

/// All charts that have something to show.
pub(super) fn charts(solved: &Solved, error: f64) -> String {
    let charts = [levels(solved), along_path(solved), decays(solved), Some(estimates(solved, error)), meshes(solved)];
    charts.into_iter().flatten().collect()
}

/// Largest gain of a mode among all positions.
pub(super) fn largest_gain(mode: &Mode) -> f64 {
    mode.gains.iter().map(|gain| gain.sine.hypot(gain.cosine)).fold(0.0, f64::max)
}

/// Time in which a mode falls by 60 dB, in seconds; infinite without damping.
pub(super) fn t60_s(mode: &Mode) -> f64 {
    3.0 * std::f64::consts::LN_10 / mode.decay_per_s
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, 0.0], |[low, high], value| [low.min(value), high.max(value)])
}

fn frequency(solved: &Solved) -> Axis {
    let [low, high] = range(solved.modes.iter().map(|mode| mode.frequency_hz));
    Axis::decades(low, high, "frequency, Hz")
}

/// Chart of the level of each mode; `None` if no mode is heard.
fn levels(solved: &Solved) -> Option<String> {
    let loudest = solved.modes.iter().map(largest_gain).fold(0.0, f64::max);
    if loudest == 0.0 {
        return None;
    }
    let axis = Axis::linear(-RANGE_DB, 0.0, "dB of the loudest mode");
    let mut chart = Chart::new("Level of each mode, at its loudest position", frequency(solved), axis);
    for mode in &solved.modes {
        let level = 20.0 * (largest_gain(mode) / loudest).max(1e-9).log10();
        if level > -RANGE_DB {
            chart.stem("fit", mode.frequency_hz, level);
        } else {
            chart.dot("hollow mark", mode.frequency_hz, -RANGE_DB, 3.0);
        }
    }
    if solved.modes.iter().any(|mode| largest_gain(mode) <= loudest * 10.0_f64.powf(-RANGE_DB / 20.0)) {
        chart.explain("hollow mark", "at least 80 dB softer");
    }
    Some(chart.figure())
}

/// Chart of the gains of the loudest modes along the path; `None` if there is one position.
fn along_path(solved: &Solved) -> Option<String> {
    let mut modes: Vec<&Mode> = solved.modes.iter().filter(|mode| mode.gains.len() > 1).collect();
    modes.sort_by(|a, b| largest_gain(b).total_cmp(&largest_gain(a)));
    modes.truncate(CLASSES.len());
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    let largest = modes.iter().map(|mode| largest_gain(mode)).fold(0.0, f64::max);
    let last = modes.first()?.gains.len() as f64;
    if largest == 0.0 {
        return None;
    }
    let axis = Axis::linear(-1.05, 1.05, "share of the largest gain");
    let mut chart =
        Chart::new("Gain by position, of the loudest modes", Axis::linear(1.0, last, "position of the strike"), axis);
    for (class, mode) in CLASSES.into_iter().zip(modes) {
        chart.explain(class, &hertz(mode.frequency_hz));
        // The larger of both parts, with its sign.
        let share = |gain: &shape::gain::Gain| {
            (if gain.sine.abs() > gain.cosine.abs() { gain.sine } else { gain.cosine }) / largest
        };
        chart.line(class, mode.gains.iter().enumerate().map(|(index, gain)| (1.0 + index as f64, share(gain))));
    }
    Some(chart.figure())
}

/// Writes a frequency with five significant digits or all before the point.
pub(super) fn hertz(frequency_hz: f64) -> String {
    let digits = (4 - frequency_hz.max(1e-3).log10().floor() as i32).clamp(0, 4) as usize;
    format!("{frequency_hz:.digits$} Hz")
}

/// Chart of the decay of each mode; `None` without damping.
fn decays(solved: &Solved) -> Option<String> {
    let damped = || solved.modes.iter().filter(|mode| mode.decay_per_s > 0.0);
    damped().next()?;
    let [low, high] = range(damped().map(t60_s));
    let axis = Axis::decades(low.max(1e-4), high.clamp(2e-4, 1e5), "T60, s");
    let mut chart = Chart::new("Decay: time in which each mode falls by 60 dB", frequency(solved), axis);
    damped().for_each(|mode| chart.dot("fit", mode.frequency_hz, t60_s(mode), 3.0));
    Some(chart.figure())
}

/// Chart of the estimated error of each mode.
fn estimates(solved: &Solved, error: f64) -> String {
    let percent = |share: f64| (100.0 * share).max(LEAST_PERCENT);
    let [low, high] = range(solved.modes.iter().map(|mode| percent(mode.error)).chain([percent(error)]));
    let last = solved.modes.len() as f64;
    let mut chart = Chart::new(
        "Estimated error of each frequency",
        Axis::linear(0.0, last + 1.0, "mode, from the lowest"),
        Axis::decades(low, high, "error, %"),
    );
    chart.explain("fit", "estimate");
    chart.explain("mark", "asked for");
    chart.level("mark", 0.0, last + 1.0, percent(error));
    for (index, mode) in solved.modes.iter().enumerate() {
        chart.dot("fit", 1.0 + index as f64, percent(mode.error), 3.0);
    }
    chart.figure()
}

/// Chart of the change of the frequencies from mesh to mesh; `None` if there was one mesh.
fn meshes(solved: &Solved) -> Option<String> {
    let changes = |pair: &[shape::solve::Tried]| {
        let both = pair[0].frequencies_hz.iter().zip(&pair[1].frequencies_hz);
        both.map(|(before, after)| (100.0 * (before - after).abs() / after).max(LEAST_PERCENT)).collect::<Vec<f64>>()
    };
    let steps: Vec<(f64, Vec<f64>)> =
        solved.meshes.windows(2).map(|pair| (pair[1].unknowns as f64, changes(pair))).collect();
    let [low, high] = range(steps.iter().flat_map(|step| step.1.iter().copied()));
    if high == 0.0 {
        return None;
    }
    let [fewest, most] = range(solved.meshes.iter().map(|mesh| mesh.unknowns as f64));
    let mut chart = Chart::new(
        "Change of the frequencies from mesh to mesh",
        Axis::decades(fewest, most, "unknowns of the finer mesh"),
        Axis::decades(low, high, "change, %"),
    );
    chart.explain("fit", "largest");
    chart.explain("mark", "each mode");
    for (unknowns, changes) in &steps {
        changes.iter().for_each(|change| chart.dot("mark", *unknowns, *change, 2.0));
    }
    let largest = |changes: &[f64]| changes.iter().copied().fold(0.0, f64::max);
    chart.line("fit", steps.iter().map(|(unknowns, changes)| (*unknowns, largest(changes))));
    for (unknowns, changes) in &steps {
        chart.dot("fit", *unknowns, largest(changes), 3.5);
    }
    Some(chart.figure())
}
