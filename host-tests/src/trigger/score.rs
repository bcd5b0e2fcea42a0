//! Score of the strikes that were found against those that were played.

use super::piezo::{RATE_HZ, Strike};

/// A strike that a trigger reported.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// ADC frame of the decision.
    pub frame: u64,
    /// Index of the pad.
    pub pad: usize,
    /// Velocity of the strike.
    pub velocity: f64,
}

/// Score of one or more scenes.
#[derive(Clone, Debug, Default)]
pub struct Score {
    /// Number of strikes played.
    pub played: usize,
    /// Number of strikes found.
    pub found: usize,
    /// Number of reports without a strike, and of second reports of a strike.
    pub false_or_double: usize,
    /// Velocity error of each found strike in dB.
    pub errors_db: Vec<f64>,
    /// Frames from the onset to the decision, of each found strike.
    pub latencies: Vec<f64>,
}

impl Score {
    /// Share of the strikes that were found, in percent.
    pub fn found_percent(&self) -> f64 {
        100.0 * self.found as f64 / self.played.max(1) as f64
    }

    /// False and double reports as a share of the strikes, in percent.
    pub fn false_percent(&self) -> f64 {
        100.0 * self.false_or_double as f64 / self.played.max(1) as f64
    }

    /// Share of the found strikes whose velocity is right within 1 dB, in percent.
    pub fn within_1_db_percent(&self) -> f64 {
        let good = self.errors_db.iter().filter(|error| error.abs() <= 1.0).count();
        100.0 * good as f64 / self.errors_db.len().max(1) as f64
    }

    /// Smallest and largest latency in milliseconds.
    pub fn latency_ms(&self) -> (f64, f64) {
        let ms = |frames: f64| frames / RATE_HZ * 1e3;
        let least = self.latencies.iter().copied().fold(f64::INFINITY, f64::min);
        (ms(least), ms(self.latencies.iter().copied().fold(0.0, f64::max)))
    }

    /// Adds another score.
    pub fn add(&mut self, other: &Self) {
        self.played += other.played;
        self.found += other.found;
        self.false_or_double += other.false_or_double;
        self.errors_db.extend(&other.errors_db);
        self.latencies.extend(&other.latencies);
    }
}

/// Matches reports with strikes, and counts the rest as false or double.
///
/// Each strike takes the first free report on its pad within 4 ms of its onset.
pub fn score(played: &[Strike], reported: &[Found]) -> Score {
    let mut taken = vec![false; reported.len()];
    let mut score = Score { played: played.len(), ..Score::default() };
    for strike in played {
        let onset = strike.time_s * RATE_HZ;
        let latency = |found: &Found| found.frame as f64 - onset;
        let candidate = reported.iter().enumerate().find(|(index, found)| {
            !taken[*index] && found.pad == strike.pad && (0.0..0.004 * RATE_HZ).contains(&latency(found))
        });
        if let Some((index, found)) = candidate {
            taken[index] = true;
            score.found += 1;
            score.errors_db.push(20.0 * (found.velocity / strike.velocity).log10());
            score.latencies.push(latency(found));
        }
    }
    score.false_or_double = taken.iter().filter(|taken| !**taken).count();
    score
}
