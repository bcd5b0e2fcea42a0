//! Strikes of which samples are clipped.

use crate::clipping::Limits;

/// Time in seconds before and behind a strike's beginning in which it may be clipped.
const CLIPPED_S: [f64; 2] = [0.003, 0.02];

/// Distance below which two samples are equal, full scale 1: noise that was added and taken off
/// leaves its rounding.
const EQUAL: f64 = 1e-12;

/// True if the sound stands still at one of its limits near a moment at which a strike begins.
pub(crate) fn is_clipped(samples: &[f64], onset: usize, rate_hz: f64, limits: Limits) -> bool {
    let [before, behind] = CLIPPED_S.map(|seconds| (seconds * rate_hz) as usize);
    let attack = &samples[onset.saturating_sub(before).min(samples.len())..(onset + behind).min(samples.len())];
    let stands = |three: &[f64]| three.iter().all(|x| (x - three[0]).abs() < EQUAL && limits.are_reached(*x, 0.999));
    attack.windows(3).any(stands)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;

    #[test]
    fn strikes_clipped_at_either_limit_are_told_without_and_with_an_offset() {
        let sound = plain(8, 6.0, 10, -60.0);
        let full_scale = 0.7 * sound.samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let onsets: Vec<usize> = sound.strikes.iter().map(|strike| (strike.at_s * sound.rate_hz) as usize).collect();
        let clipped_among = |low: f64, high: f64, offset: f64| {
            // Noise that was added and taken off again leaves its rounding.
            let rounded = |(n, x): (usize, &f64)| {
                let noise = 1e-4 * (n as f64).sin();
                (x + offset).clamp(low, high) - offset + noise - noise
            };
            let cut: Vec<f64> = sound.samples.iter().enumerate().map(rounded).collect();
            let limits = Limits::of(&cut);
            let is_clipped = |onset: &&usize| is_clipped(&cut, **onset, sound.rate_hz, limits);
            onsets.iter().filter(is_clipped).copied().collect::<Vec<usize>>()
        };
        for offset in [0.0, 0.1 * full_scale, -0.1 * full_scale] {
            let [above, below, both] = [(f64::MIN, full_scale), (-full_scale, f64::MAX), (-full_scale, full_scale)]
                .map(|(low, high)| clipped_among(low, high, offset));
            assert!(!above.is_empty() && !below.is_empty(), "{above:?} {below:?}");
            let all: Vec<usize> =
                onsets.iter().copied().filter(|onset| above.contains(onset) || below.contains(onset)).collect();
            assert_eq!(both, all, "with an offset of {offset}");
        }
    }
}
