//! Emergence of modes: the level by which they stand out of the smooth part of the spectrum.

use super::filter_bank::Spectrum;
use super::scale::bark;
use crate::modes::DampedSine;

/// Half the width in Bark over which the smooth part is taken.
const HALF_WIDTH_BARK: f64 = 0.5;
/// Default emergence from which a mode counts as emerging, in dB.
///
/// In a band of noise, one bin in 70 000 stands 12 dB above the median.
pub const EMERGENT_DB: f64 = 12.0;

/// Emergence in dB of each mode in a strike's spectrum (the emergence ratio of dynamic-filter
/// §IV-B2).
///
/// It is the mode's own peak `A/2α` (eq. 2 for a real sine) over the median magnitude of the
/// strike's spectrum within half a Bark of its frequency. Where modes overlap, or noise is strong,
/// the median is high and modes do not emerge.
///
/// `strike` has full scale 1 and begins at its onset; `rate_hz` is its rate. The modes' amplitudes
/// are those at its first sample. The result is minus infinity for a mode without amplitude and for
/// silence.
pub fn emergence_db(modes: &[DampedSine], strike: &[f64], rate_hz: f64) -> Vec<f64> {
    let Some(spectrum) = Spectrum::of(strike, rate_hz) else { return vec![f64::NEG_INFINITY; modes.len()] };
    let magnitude: Vec<f64> = spectrum.power().map(f64::sqrt).collect();
    let rates: Vec<f64> = (0..magnitude.len()).map(|bin| bark(bin as f64 * spectrum.bin_hz())).collect();
    let length_s = strike.len() as f64 / rate_hz;
    modes
        .iter()
        .map(|mode| {
            let rate = bark(mode.frequency_hz);
            let first = rates.partition_point(|x| *x < rate - HALF_WIDTH_BARK);
            let last = rates.partition_point(|x| *x < rate + HALF_WIDTH_BARK);
            let mut near = magnitude.get(first..last).unwrap_or(&[]).to_vec();
            if near.is_empty() {
                return f64::NEG_INFINITY;
            }
            let middle = near.len() / 2;
            let (_, smooth, _) = near.select_nth_unstable_by(middle, f64::total_cmp);
            // Sum of A e^{-αt} over the strike's samples; a sine has half of it on each side of the
            // spectrum.
            let heard = -(-mode.decay_per_s * length_s).exp_m1();
            let peak = 0.5 * mode.amplitude * heard * rate_hz / mode.decay_per_s;
            20.0 * (peak / smooth.max(f64::MIN_POSITIVE)).log10()
        })
        .collect()
}
