//! Charts of a page on many strikes: timeline, forces, contact law, decay, gains along the object
//! and residual.

use std::path::Path;

use fit::multi_strike::{ModeEstimate, StrikeEstimate};
use fit::score::quantile;

use super::chart::{Axis, Chart};
use super::markup::data_uri;
use super::strikes_page::StrikesPage;
use crate::plot::{PlotError, SPECTROGRAM_HZ, spectrogram_pngs};

/// Width of the timeline's spectrogram in pixels.
const COLUMNS: u32 = 960;
/// Height of the timeline's spectrogram in pixels.
const ROWS: u32 = 300;
/// Largest number of points of a line over time.
const POINTS: usize = 600;
/// Shortest frame of a level over time, in seconds.
const FRAME_S: f64 = 0.02;
/// Lowest level that is shown, in dB of full scale.
const LOWEST_DBFS: f64 = -120.0;
/// Largest number of modes whose gains are drawn along the object.
const MOST_LINES: usize = 5;
/// Colours of strikers in their order, and of modes along the object.
const CLASSES: [&str; MOST_LINES] = ["fit", "recording", "law", "noise", "room"];
/// Label of the axis of time.
const TIME: &str = "time, s";

/// Charts over time, and those of contact law, gains and decay.
pub(super) struct Figures {
    /// Charts with time to the right, the timeline first.
    pub(super) over_time: String,
    /// Contact law, decay of the modes, and gains along the object.
    pub(super) laws: String,
}

impl Figures {
    /// Draws all charts of a page.
    ///
    /// # Errors
    /// [`PlotError`] with `path`, the page, if the spectrogram cannot be encoded.
    pub(super) fn of(path: &Path, page: &StrikesPage<'_>) -> Result<Self, PlotError> {
        let over_time = [timeline(path, page)?, peaks(page), contact_times(page), residual(page)].concat();
        let laws = [contact_law(page), decays(page), gains(page).unwrap_or_default()].concat();
        Ok(Self { over_time, laws })
    }
}

fn class_of(strike: &StrikeEstimate) -> &'static str {
    CLASSES[strike.striker % CLASSES.len()]
}

/// Sentence on the standard deviations of times and forces; empty if there are none.
pub(super) fn deviations(page: &StrikesPage<'_>) -> String {
    let median = |deviation: fn(&StrikeEstimate) -> f64| {
        let all: Vec<f64> = page.estimate.strikes.iter().map(deviation).filter(|sd| sd.is_finite()).collect();
        (!all.is_empty()).then(|| quantile(&all, 0.5))
    };
    let decibels = |strike: &StrikeEstimate| 20.0 / std::f64::consts::LN_10 * strike.peak_force_sd / strike.peak_force;
    let percent = |strike: &StrikeEstimate| 100.0 * strike.contact_time_s_sd / strike.contact_time_s;
    let found = median(|strike| 1e6 * strike.at_s_sd).zip(median(percent)).zip(median(decibels));
    found.map_or_else(String::new, |((onset_us, contact_percent), peak_db)| {
        format!(
            "<p class=\"muted\">Standard deviations in the median: onset {onset_us:.2} µs, contact time {contact_percent:.2} %, peak {peak_db:.3} dB. Bars that are shorter than a dot are hidden by it.</p>\n"
        )
    })
}

/// Names the strikers in a legend, if there are several.
fn explain_strikers(chart: &mut Chart, page: &StrikesPage<'_>) {
    let count = page.strikers();
    for striker in 0..count {
        let name = if count > 1 { format!("striker {}", striker + 1) } else { "strikes".to_owned() };
        chart.explain(CLASSES[striker % CLASSES.len()], &name);
    }
}

fn timeline(path: &Path, page: &StrikesPage<'_>) -> Result<String, PlotError> {
    let sound: Vec<f32> = page.recording.iter().map(|x| *x as f32).collect();
    let pictures = spectrogram_pngs(path, &[&sound], page.estimate.rate_hz, COLUMNS, ROWS)?;
    let frequency = Axis::frequency(SPECTROGRAM_HZ.0, SPECTROGRAM_HZ.1);
    let mut chart = Chart::new("Strikes over the recording", Axis::linear(0.0, page.seconds(), TIME), frequency);
    explain_strikers(&mut chart, page);
    pictures.iter().for_each(|png| chart.picture(&data_uri("image/png", png)));
    // Marks hang from the upper edge, longer for stronger strikes: 40 dB are the whole range.
    let ratio = SPECTROGRAM_HZ.1 / SPECTROGRAM_HZ.0;
    for strike in &page.estimate.strikes {
        let depth = 0.03 + 0.2 * (1.0 + level_db(strike.peak_force) / 40.0).clamp(0.0, 1.0);
        let foot_hz = SPECTROGRAM_HZ.1 * ratio.powf(-depth);
        chart.line(&format!("wide {}", class_of(strike)), [(strike.at_s, SPECTROGRAM_HZ.1), (strike.at_s, foot_hz)]);
    }
    Ok(chart.figure())
}

fn level_db(ratio: f64) -> f64 {
    20.0 * ratio.max(1e-6).log10()
}

/// Chart of values of strikes over time, with bars of one standard deviation to both sides.
fn over_time(
    page: &StrikesPage<'_>,
    (title, axis): (&'static str, Axis),
    value: impl Fn(&StrikeEstimate) -> [f64; 3],
) -> String {
    let mut chart = Chart::new(title, Axis::linear(0.0, page.seconds(), TIME), axis);
    explain_strikers(&mut chart, page);
    for strike in &page.estimate.strikes {
        let [low, middle, high] = value(strike);
        if low.is_finite() && high.is_finite() {
            chart.interval(class_of(strike), strike.at_s, low, high);
        }
        chart.dot(class_of(strike), strike.at_s, middle, 2.6);
    }
    chart.figure()
}

fn peaks(page: &StrikesPage<'_>) -> String {
    let lowest = page.estimate.strikes.iter().map(|strike| level_db(strike.peak_force)).fold(-6.0, f64::min);
    let axis = Axis::linear((lowest / 6.0).floor() * 6.0, 3.0, "dB of the strongest");
    over_time(page, ("Peak of each force, one deviation to both sides", axis), |strike| {
        let [peak, sd] = [strike.peak_force, strike.peak_force_sd];
        [level_db(peak - sd), level_db(peak), level_db(peak + sd)]
            .map(|db| if sd.is_nan() { level_db(peak) } else { db })
    })
}

/// Contact time of a strike in ms, and one deviation to both sides.
fn contact_ms(strike: &StrikeEstimate) -> [f64; 3] {
    let [time, sd] = [strike.contact_time_s, strike.contact_time_s_sd].map(|s| 1e3 * s);
    [time - sd, time, time + sd]
}

fn contact_times(page: &StrikesPage<'_>) -> String {
    let longest = page.estimate.strikes.iter().map(|strike| contact_ms(strike)[1]).fold(0.1, f64::max);
    let axis = Axis::linear(0.0, 1.1 * longest, "contact time, ms");
    over_time(page, ("Contact time of each force, one deviation to both sides", axis), contact_ms)
}

/// Level of a sound in dB of full scale over time.
fn levels(sound: &[f64], rate_hz: f64) -> Vec<(f64, f64)> {
    let frame = ((FRAME_S * rate_hz) as usize).max(sound.len().div_ceil(POINTS)).max(1);
    let level = |(index, frame_of): (usize, &[f64])| {
        let power = frame_of.iter().map(|x| x * x).sum::<f64>() / frame_of.len() as f64;
        let middle_s = (index as f64 + 0.5) * frame as f64 / rate_hz;
        (middle_s, (10.0 * power.max(1e-30).log10()).max(LOWEST_DBFS))
    };
    sound.chunks(frame).enumerate().map(level).collect()
}

fn residual(page: &StrikesPage<'_>) -> String {
    let rate_hz = page.estimate.rate_hz;
    let curves = [
        ("recording", "recording", levels(page.recording, rate_hz)),
        // Both lie on one another, as a rule.
        ("fit wide", "left by the replay", levels(&page.left(), rate_hz)),
        ("law", "left by the fit", levels(&page.estimate.residual, rate_hz)),
    ];
    let all = curves.iter().flat_map(|curve| &curve.2).map(|point| point.1);
    let (low, high) = all.fold((0.0f64, LOWEST_DBFS), |(low, high), level| (low.min(level), high.max(level)));
    let axis = Axis::linear((low / 10.0).floor() * 10.0, (high / 10.0).ceil() * 10.0, "rms, dBFS");
    let mut chart = Chart::new("What is left over time", Axis::linear(0.0, page.seconds(), TIME), axis);
    for (class, name, curve) in curves {
        chart.explain(class, name);
        chart.line(class, curve);
    }
    chart.figure()
}

fn contact_law(page: &StrikesPage<'_>) -> String {
    let strikes = &page.estimate.strikes;
    let range = |value: fn(&StrikeEstimate) -> f64| {
        let values = strikes.iter().map(value);
        values.fold((f64::INFINITY, 1e-6f64), |(low, high), x| (low.min(x), high.max(x)))
    };
    let (softest, hardest) = range(|strike| strike.peak_force);
    let (shortest, longest) = range(|strike| contact_ms(strike)[1]);
    let mut chart = Chart::new(
        "Contact law: contact time over peak",
        Axis::decades(softest.clamp(1e-4, 0.5), hardest, "peak, share of the strongest"),
        Axis::decades(shortest.max(1e-3), longest, "contact time, ms"),
    );
    explain_strikers(&mut chart, page);
    chart.explain("mark", "law of the table");
    for (index, striker) in page.kit.strikers.iter().enumerate() {
        let own = || strikes.iter().filter(|strike| strike.striker == index).map(|strike| strike.peak_force);
        let most = own().fold(0.0, f64::max);
        let least = own().fold(most, f64::min);
        let law = |peak: f64| {
            let velocity = (peak / most).powf(1.0 / f64::from(striker.peak_exponent));
            1e3 * f64::from(striker.contact_time_s) * velocity.powf(f64::from(striker.contact_exponent))
        };
        if most > 0.0 {
            chart.line("mark", [least, most].map(|peak| (peak, law(peak))));
        }
    }
    for strike in strikes {
        let [low, middle, high] = contact_ms(strike);
        if low.is_finite() && high.is_finite() {
            chart.interval(class_of(strike), strike.peak_force, low, high);
        }
        chart.dot(class_of(strike), strike.peak_force, middle, 2.6);
    }
    chart.figure()
}

fn decays(page: &StrikesPage<'_>) -> String {
    let modes = &page.estimate.modes;
    let t60 = modes.iter().map(ModeEstimate::t60_s);
    let (low, high) = t60.fold((f64::INFINITY, 0.0f64), |(low, high), t60| (low.min(t60), high.max(t60)));
    let range_hz = (SPECTROGRAM_HZ.0, SPECTROGRAM_HZ.1.min(0.5 * page.estimate.rate_hz));
    let axis = Axis::decades(low.clamp(1e-3, 1e2), high.clamp(2e-3, 1e2), "T60, s");
    let mut chart = Chart::new("Decay of the modes", Axis::frequency(range_hz.0, range_hz.1), axis);
    chart.explain("fit", "modes (size: energy), one deviation to both sides");
    let most = modes.iter().map(energy).fold(f64::MIN_POSITIVE, f64::max);
    for mode in modes {
        let spread = mode.decay_per_s_sd / mode.decay_per_s;
        if spread.is_finite() {
            let t60_s = mode.t60_s();
            chart.interval("fit", mode.frequency_hz, t60_s / (1.0 + spread), t60_s / (1.0 - spread).max(0.1));
        }
        let level = (1.0 + (energy(mode) / most).log10() / 6.0).clamp(0.0, 1.0);
        chart.dot("fit", mode.frequency_hz, mode.t60_s(), 1.5 + 4.0 * level);
    }
    chart.figure()
}

/// Energy of a mode after an impulse, in units that all modes share.
fn energy(mode: &ModeEstimate) -> f64 {
    mode.gain.iter().map(|part| part * part).sum::<f64>() / mode.decay_per_s
}

/// Chart of the gains of the loudest modes along the object; `None` if there is one place.
fn gains(page: &StrikesPage<'_>) -> Option<String> {
    let mut modes: Vec<&ModeEstimate> = page.estimate.modes.iter().filter(|mode| mode.gains.len() > 1).collect();
    modes.sort_by(|a, b| energy(b).total_cmp(&energy(a)));
    modes.truncate(MOST_LINES);
    modes.first()?;
    let axis = Axis::linear(-1.1, 1.1, "share of the mode's largest gain");
    let mut chart = Chart::new("Gains along the object", Axis::linear(0.0, 1.0, "position"), axis);
    for (class, mode) in CLASSES.into_iter().zip(modes) {
        chart.explain(class, &format!("{:.0} Hz", mode.frequency_hz));
        // The part of each gain that has the phase of the largest one.
        let size = mode.gain.iter().map(|part| part * part).sum::<f64>().max(f64::MIN_POSITIVE);
        let share = |gain: &[f64; 2]| (gain[0] * mode.gain[0] + gain[1] * mode.gain[1]) / size;
        let last = (mode.gains.len() - 1) as f64;
        chart.line(class, mode.gains.iter().enumerate().map(|(index, gain)| (index as f64 / last, share(gain))));
    }
    chart.explain("mark", "strikes");
    page.estimate.strikes.iter().for_each(|strike| chart.dot("mark", strike.position, -1.05, 2.0));
    Some(chart.figure())
}
