//! Clipped strikes: they tell no contacts; what they ring is found in what the others leave.

use super::error::LEAST_STRIKES;

/// Time in seconds before and behind a strike's beginning in which it may be clipped.
const CLIPPED_S: [f64; 2] = [0.003, 0.02];

/// Moments near which strikes begin that are not clipped; all, if too few are not.
pub(super) fn usable(samples: &[f64], onsets: &[usize], rate_hz: f64) -> Vec<usize> {
    let largest = samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let is_sound = |onset: &usize| !is_clipped(samples, *onset, rate_hz, largest);
    let sound: Vec<usize> = onsets.iter().copied().filter(is_sound).collect();
    if sound.len() < LEAST_STRIKES { onsets.to_vec() } else { sound }
}

/// True if the sound stands still at its largest value near a moment at which a strike begins.
pub(crate) fn is_clipped(samples: &[f64], onset: usize, rate_hz: f64, largest: f64) -> bool {
    let [before, behind] = CLIPPED_S.map(|seconds| (seconds * rate_hz) as usize);
    let attack = &samples[onset.saturating_sub(before).min(samples.len())..(onset + behind).min(samples.len())];
    let stands = |three: &[f64]| three.iter().all(|x| *x == three[0] && x.abs() >= 0.999 * largest);
    attack.windows(3).any(stands)
}
