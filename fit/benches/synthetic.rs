//! Measures the estimators on sounds of known modes, beside the Cramer-Rao bounds.
//!
//! `cargo bench -p fit --bench synthetic`

use std::time::Instant;

use fit::bins;
use fit::distance::RecordedLevels;
use fit::modes::{DampedSine, Settings, cramer_rao_bounds, estimate};
use fit::score::{matches, quantile};
use fit::synthetic::{Synthetic, struck};

const SEEDS: u64 = 20;

#[derive(Default)]
struct Tally {
    cents: Vec<f64>,
    t60_percent: Vec<f64>,
    amplitude_db: Vec<f64>,
    bound_cents: Vec<f64>,
    bound_t60_percent: Vec<f64>,
    bound_amplitude_db: Vec<f64>,
    true_modes: usize,
    reported: Vec<f64>,
    seconds: Vec<f64>,
    lsd_db: Vec<f64>,
}

impl Tally {
    fn add(&mut self, sound: &Synthetic, estimates: &[DampedSine], seconds: f64) {
        for found in matches(&sound.modes, estimates, 20.0) {
            self.cents.push(found.cents());
            self.t60_percent.push(found.t60_percent());
            self.amplitude_db.push(found.amplitude_db());
        }
        let bounds = cramer_rao_bounds(&sound.modes, sound.samples.len(), sound.rate_hz, sound.noise_rms);
        for (bound, mode) in bounds.iter().flatten().zip(&sound.modes) {
            self.bound_cents.push(1200.0 / 2f64.ln() * bound.frequency_hz / mode.frequency_hz);
            self.bound_t60_percent.push(100.0 * bound.decay_per_s / mode.decay_per_s);
            self.bound_amplitude_db.push(20.0 / 10f64.ln() * bound.amplitude);
        }
        self.true_modes += sound.modes.len();
        self.reported.push(estimates.len() as f64);
        self.seconds.push(seconds);
        let mut rendering = vec![0.0; sound.samples.len()];
        estimates.iter().for_each(|sine| sine.add_to(&mut rendering, sound.rate_hz));
        self.lsd_db.push(RecordedLevels::new(&[], &sound.samples, sound.rate_hz).lsd_db(&rendering));
    }

    fn print(&self, name: &str, noise_dbfs: f64) {
        let most = |values: &[f64]| quantile(values, 1.0);
        println!(
            "{name:5} {noise_dbfs:>6} | {:>5.1} % | {:.5} ({:.5}) | {:.4} ({:.4}), p90 {:.3} ({:.3}) | {:.4} ({:.4}) | {:.1}, at most {} | {:.2}, at most {:.2} | {:.2}",
            100.0 * self.cents.len() as f64 / self.true_modes as f64,
            quantile(&self.cents, 0.5),
            quantile(&self.bound_cents, 0.5),
            quantile(&self.t60_percent, 0.5),
            quantile(&self.bound_t60_percent, 0.5),
            quantile(&self.t60_percent, 0.9),
            quantile(&self.bound_t60_percent, 0.9),
            quantile(&self.amplitude_db, 0.5),
            quantile(&self.bound_amplitude_db, 0.5),
            self.reported.iter().sum::<f64>() / self.reported.len() as f64,
            most(&self.reported),
            self.seconds.iter().sum::<f64>() / self.seconds.len() as f64,
            most(&self.seconds),
            self.lsd_db.iter().sum::<f64>() / self.lsd_db.len() as f64,
        );
    }
}

fn main() {
    println!(
        "{SEEDS} sounds of 20 modes; errors are medians, the Cramer-Rao bounds (standard deviations) in brackets\n"
    );
    println!(
        "        dBFS | found   | cents             | T60, %                              | amplitude, dB   | modes reported | seconds | LSD, dB"
    );
    type Estimator = fn(&Synthetic) -> Vec<DampedSine>;
    let modal: Estimator = |sound| estimate(&sound.samples, sound.rate_hz, Settings::default());
    let by_bins: Estimator = |sound| bins::estimate(&sound.samples, sound.rate_hz);
    for (name, estimator) in [("modal", modal), ("bins", by_bins)] {
        for noise_dbfs in [-80.0, -50.0] {
            let mut tally = Tally::default();
            for seed in 1..=SEEDS {
                let sound = struck(seed, noise_dbfs);
                let start = Instant::now();
                let estimates = estimator(&sound);
                tally.add(&sound, &estimates, start.elapsed().as_secs_f64());
            }
            tally.print(name, noise_dbfs);
        }
    }
}
