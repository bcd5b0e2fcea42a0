//! Errors of the joint fit and of the descent on excerpts of the set *plain*.
//!
//! `cargo bench -p fit --bench descent` fits three excerpts of 2 s with four strikes. The descent
//! gets ten times the CPU time of the joint fit. `-- SEEDS FIRST TIMES` chooses the number of
//! seeds, the first seed, and this factor.

use cpu_time::ProcessTime;
use fit::descent;
use fit::modes;
use fit::multi_strike::synthetic::{StruckOften, plain};
use fit::multi_strike::{Estimate, Layout, cramer_rao, estimate};
use fit::score::quantile;

/// Largest distance in seconds of a strike that is counted as found from the true one.
const FOUND_S: f64 = 0.01;
/// Largest distance in seconds at which errors are taken: half the least gap between two strikes.
const NEAR_S: f64 = 0.05;
/// Largest distance in cents of a found mode that is counted as found.
const NEAR_CENTS: f64 = 20.0;
/// Bound of T60 in percent up to which a mode is heard.
const HEARD_PERCENT: f64 = 5.0;
/// Number of steps from which the time of a step is measured.
const TIMED_STEPS: usize = 20;
/// Factor of the number of steps, because late steps are faster than those that are timed.
const MARGIN: f64 = 1.15;

/// Errors of one way.
#[derive(Default)]
struct Errors {
    cents: Vec<f64>,
    t60_percent: Vec<f64>,
    middle_us: Vec<f64>,
    peak_db: Vec<f64>,
    strikes: usize,
    spurious: usize,
    seconds: f64,
}

/// Pairs of indices of two lists, nearest first, each index once.
fn pairs(count: [usize; 2], apart: impl Fn(usize, usize) -> f64) -> Vec<[usize; 2]> {
    let mut all: Vec<[usize; 2]> = (0..count[0]).flat_map(|a| (0..count[1]).map(move |b| [a, b])).collect();
    all.sort_by(|x, y| apart(x[0], x[1]).total_cmp(&apart(y[0], y[1])));
    let mut taken = [vec![false; count[0]], vec![false; count[1]]];
    all.retain(|pair| {
        let is_free = !taken[0][pair[0]] && !taken[1][pair[1]];
        if is_free {
            (taken[0][pair[0]], taken[1][pair[1]]) = (true, true);
        }
        is_free
    });
    all
}

impl Errors {
    fn add(&mut self, sound: &StruckOften, bounds: &Estimate, fit: &Estimate, seconds: f64) {
        self.seconds += seconds;
        let heard: Vec<f64> = sound
            .modes
            .iter()
            .filter(|truth| {
                let own = bounds.modes.iter().find(|mode| (mode.frequency_hz / truth.frequency_hz - 1.0).abs() < 1e-9);
                own.is_some_and(|mode| 100.0 * mode.decay_per_s_sd / mode.decay_per_s < HEARD_PERCENT)
            })
            .map(|truth| truth.frequency_hz)
            .collect();
        let cents = |a: usize, b: usize| (1200.0 * (fit.modes[b].frequency_hz / heard[a]).log2()).abs();
        for [a, b] in pairs([heard.len(), fit.modes.len()], cents) {
            self.cents.push(cents(a, b));
            let truth = sound.modes.iter().find(|mode| mode.frequency_hz == heard[a]);
            self.t60_percent.extend(truth.map(|truth| 100.0 * (fit.modes[b].t60_s() / truth.t60_s() - 1.0).abs()));
        }
        let late_s = |a: usize, b: usize| (fit.strikes[b].middle_s - sound.strikes[a].middle_s()).abs();
        let mut found = pairs([sound.strikes.len(), fit.strikes.len()], late_s);
        found.retain(|pair| late_s(pair[0], pair[1]) < NEAR_S);
        let within = found.iter().filter(|pair| late_s(pair[0], pair[1]) < FOUND_S).count();
        self.strikes += within;
        self.spurious += fit.strikes.len() - within;
        let ratio =
            |pair: &[usize; 2]| 20.0 * (fit.strikes[pair[1]].peak_force / sound.strikes[pair[0]].peak_force).log10();
        // Only ratios of peaks are told: the median ratio is the unit.
        let unit_db = quantile(&found.iter().map(ratio).collect::<Vec<f64>>(), 0.5);
        for pair in &found {
            self.middle_us.push(1e6 * late_s(pair[0], pair[1]));
            self.peak_db.push((ratio(pair) - unit_db).abs());
        }
    }
}

fn print(what: &str, joint: &[f64], descent: &[f64]) {
    let [joint, descent] = [joint, descent].map(|errors| quantile(errors, 0.5));
    println!("{what:28} joint fit {joint:10.4}, descent {descent:10.4}, ratio {:8.0}", descent / joint);
}

fn main() {
    let numbers: Vec<u64> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let number = |index: usize, usual: u64| numbers.get(index).copied().unwrap_or(usual);
    let (seeds, first, times) = (number(0, 3), number(1, 601), number(2, 10));
    let (mut by_joint, mut by_descent) = (Errors::default(), Errors::default());
    let (mut strikes, mut fits) = (0, 0);
    for seed in first..first + seeds {
        let sound = plain(seed, 2.0, 4, -60.0);
        let start = ProcessTime::now();
        let joint = estimate(&sound.samples, sound.rate_hz, modes::Settings::default(), Layout::default(), |_| {});
        let joint_s = start.elapsed().as_secs_f64();
        let (joint, bounds) = match (joint, cramer_rao(&sound)) {
            (Ok(joint), Some(bounds)) => (joint, bounds),
            (Err(error), _) => {
                println!("seed {seed}: {error}");
                continue;
            }
            (_, None) => {
                println!("seed {seed}: two modes cannot be told apart");
                continue;
            }
        };
        let mut settings = descent::Settings::default();
        let by = |settings: &descent::Settings| {
            let start = ProcessTime::now();
            let found = descent::estimate(&sound.samples, sound.rate_hz, settings, |_| {});
            (found, start.elapsed().as_secs_f64())
        };
        let timed = |steps: usize| by(&descent::Settings { steps, rates: vec![0.001], ..settings.clone() }).1;
        let once_s = timed(1);
        let step_s = (timed(1 + TIMED_STEPS) - once_s) / TIMED_STEPS as f64;
        let before_s = settings.rates.len() as f64 * (once_s - step_s).max(0.0);
        let whole = settings.all_steps() as f64 / settings.steps as f64;
        settings.steps = (((times as f64 * joint_s - before_s) / step_s / whole * MARGIN).ceil() as usize).max(1);
        let (found, descent_s) = by(&settings);
        let found = match found {
            Ok(found) => found,
            Err(error) => {
                println!("seed {seed}: descent: {error}");
                continue;
            }
        };
        eprintln!(
            "seed {seed}: joint fit {joint_s:.2} s; descent {descent_s:.1} s, {} steps of {:.0} ms",
            settings.all_steps(),
            1e3 * step_s
        );
        by_joint.add(&sound, &bounds, &joint, joint_s);
        by_descent.add(&sound, &bounds, &found, descent_s);
        strikes += sound.strikes.len();
        fits += 1;
    }
    println!("{fits} of {seeds} excerpts fitted by both ways, {strikes} strikes, {} heard modes", by_joint.cents.len());
    println!(
        "CPU time: joint fit {:.1} s, descent {:.1} s: {:.1} times",
        by_joint.seconds,
        by_descent.seconds,
        by_descent.seconds / by_joint.seconds
    );
    for (name, errors) in [("joint fit", &by_joint), ("descent", &by_descent)] {
        let near = errors.cents.iter().filter(|cents| **cents < NEAR_CENTS).count();
        println!(
            "{name}: {} strikes found within 10 ms, {} false; {near} heard modes within 20 cents",
            errors.strikes, errors.spurious
        );
    }
    print("frequency, cents", &by_joint.cents, &by_descent.cents);
    print("T60, %", &by_joint.t60_percent, &by_descent.t60_percent);
    print("middle of contact, µs", &by_joint.middle_us, &by_descent.middle_us);
    print("peak, dB", &by_joint.peak_db, &by_descent.peak_db);
}
