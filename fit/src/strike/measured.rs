//! Strikes with a measured force, cut out of a recording.

use super::high_pass::high_pass;
use crate::error::FitError;
use crate::modes::Stretch;
use crate::segment::Hit;

/// Cutoff of the high-pass on force and sound, in Hz: an impact hammer and a room say little below.
pub(super) const HIGH_PASS_HZ: f64 = 300.0;
/// Start of a strike's force before its peak, in seconds.
const FORCE_BEFORE_S: f64 = 0.0015;
/// Length of a strike's force from there on, in seconds.
const FORCE_LENGTH_S: f64 = 0.0045;
/// Maximum length of a strike's sound that is fitted, in seconds.
const LONGEST_S: f64 = 0.3;
/// Largest delay between force and microphone in seconds (1 m).
const LONGEST_DELAY_S: f64 = 0.003;

/// One strike, cut out: high-passed sound and force that begin together, without the microphone's
/// delay.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredHit {
    /// Time of the force's peak in the recording, in seconds.
    pub at_s: f64,
    /// Samples of the microphone.
    pub sound: Vec<f64>,
    /// Samples of the force.
    pub force: Vec<f64>,
    /// Delay of the microphone in samples, which was removed.
    pub delay: usize,
}

/// Width of a force pulse at half its maximum, in seconds.
pub fn force_width_s(force: &[f64], peak: usize, rate_hz: f64) -> f64 {
    let half = force.get(peak).copied().unwrap_or(0.0) / 2.0;
    let before = force[..peak.min(force.len())].iter().rev().take_while(|x| **x > half).count();
    let after = force[peak.min(force.len())..].iter().take_while(|x| **x > half).count();
    // The crossing lies on a straight line between the last sample above half and the first below.
    let crossing = |inside: usize, outside: Option<usize>| {
        let (inside, outside) = (force.get(inside).copied(), outside.and_then(|at| force.get(at)).copied());
        match (inside, outside) {
            (Some(inside), Some(outside)) if inside > outside => (inside - half) / (inside - outside),
            _ => 0.0,
        }
    };
    let first = peak.saturating_sub(before);
    let last = (peak + after).saturating_sub(1);
    ((last - first) as f64 + crossing(first, first.checked_sub(1)) + crossing(last, Some(last + 1))) / rate_hz
}

/// Cuts the strikes out of a recording with its force.
///
/// # Errors
/// [`FitError::NoForce`] for a force channel without pulses.
pub fn measured_hits(
    sound: &[f64],
    force: &[f64],
    channel: usize,
    rate_hz: f64,
    hits: &[Hit],
) -> Result<Vec<MeasuredHit>, FitError> {
    let samples = |seconds: f64| (seconds * rate_hz).round() as usize;
    let loudest = force.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let mut levels: Vec<f64> = force.iter().map(|x| x.abs()).collect();
    levels.sort_by(f64::total_cmp);
    let noise = levels.get(levels.len() / 2).copied().unwrap_or(0.0);
    if loudest <= 10.0 * noise || loudest <= 0.0 {
        return Err(FitError::NoForce { channel });
    }
    let (sound, filtered) = (high_pass(sound, HIGH_PASS_HZ, rate_hz), high_pass(force, HIGH_PASS_HZ, rate_hz));
    let mut cuts = Vec::new();
    for hit in hits {
        let from = hit.onset.saturating_sub(samples(0.004));
        let near = &force[from.min(force.len())..force.len().min(hit.onset + samples(0.002))];
        let Some((peak, height)) = near.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) else { continue };
        if *height < 10.0 * noise {
            continue;
        }
        let peak = from + peak;
        let start = peak.saturating_sub(samples(FORCE_BEFORE_S));
        let rise = (start..peak).find(|&n| force[n] > 0.1 * height).unwrap_or(start);
        cuts.push((hit, peak, start, hit.onset.saturating_sub(rise).min(samples(LONGEST_DELAY_S))));
    }
    // Hammer and microphone stand still, so all strikes have one delay.
    let mut delays: Vec<usize> = cuts.iter().map(|cut| cut.3).collect();
    delays.sort_unstable();
    let delay = delays.get(delays.len() / 2).copied().unwrap_or(0);
    let mut measured = Vec::new();
    for (hit, peak, start, _) in cuts {
        let end = sound.len().min(hit.end).min(start + delay + samples(LONGEST_S));
        if end <= start + delay + samples(FORCE_LENGTH_S) {
            continue;
        }
        let force_end = filtered.len().min(start + samples(FORCE_LENGTH_S));
        measured.push(MeasuredHit {
            at_s: peak as f64 / rate_hz,
            sound: sound[start + delay..end].to_vec(),
            force: filtered[start..force_end].to_vec(),
            delay,
        });
    }
    if measured.is_empty() { Err(FitError::NoForce { channel }) } else { Ok(measured) }
}

impl MeasuredHit {
    pub(super) fn stretch(&self) -> Stretch<'_> {
        Stretch { samples: &self.sound, force: Some(&self.force) }
    }

    pub(super) fn energy(&self) -> f64 {
        self.sound.iter().map(|x| x * x).sum()
    }

    /// This strike with sound and force multiplied by `weight`.
    pub(super) fn weighed(&self, weight: f64) -> Self {
        let times = |samples: &[f64]| samples.iter().map(|x| x * weight).collect();
        Self { sound: times(&self.sound), force: times(&self.force), ..*self }
    }
}
