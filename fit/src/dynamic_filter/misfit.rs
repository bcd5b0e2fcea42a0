//! Misfit: decays of band powers, and their distance from a damping law.

use super::damping::counted;
use crate::bark::{DampingBand, DampingLaw, width_hz};

/// Largest error of a decay that counts, as a difference of logarithms.
const WORST: f64 = 0.45;

/// Decay in dB/s of a decay rate in 1/s.
pub(crate) fn db_per_s(decay_per_s: f64) -> f64 {
    20.0 / std::f64::consts::LN_10 * decay_per_s
}

/// Squared error of ln α, summed over the bands that count, for powers `[time][band]`.
pub(crate) fn misfit(law: &DampingLaw, times_s: &[f64], powers: &[Vec<f64>]) -> f64 {
    let counts: Vec<f64> = counted(law).map(|band| band.bark).collect();
    let error = |(index, band): (usize, &DampingBand)| {
        let powers: Vec<f64> = powers.iter().map(|powers| powers.get(index).copied().unwrap_or(0.0)).collect();
        let decay = decay_db_per_s(band, times_s, &powers);
        (decay / db_per_s(band.decay_per_s)).max(1e-3).ln().abs().min(WORST).powi(2)
    };
    law.bands.iter().enumerate().filter(|(_, band)| counts.contains(&band.bark)).map(error).sum()
}

/// Decay in dB/s of a band's power: slope of the straight line through its first 40 dB.
///
/// Every second has equal weight, as in the analysis of a recording.
pub(crate) fn decay_db_per_s(band: &DampingBand, times_s: &[f64], powers: &[f64]) -> f64 {
    let from_s = settled_s(band);
    let loudest = powers.iter().copied().fold(0.0, f64::max);
    let mut sums = [0.0; 5];
    for (pair, power) in times_s.windows(2).zip(powers.windows(2)) {
        let &[from, to] = pair else { continue };
        let time_s = 0.5 * (from + to);
        let mean = (power[0] * power[1]).sqrt();
        if time_s < from_s || mean < 1e-4 * loudest {
            continue;
        }
        let (weight, level) = (to - from, 10.0 * mean.max(1e-30).log10());
        for (sum, term) in sums.iter_mut().zip([1.0, time_s, level, time_s * time_s, time_s * level]) {
            *sum += weight * term;
        }
    }
    let [count, time, level, squared, product] = sums;
    let spread = count * squared - time * time;
    if spread <= 0.0 { 0.0 } else { -(count * product - time * level) / spread }
}

/// Time in seconds at which the analysis of a band begins: three standard deviations of its
/// response after the strike.
pub(crate) fn settled_s(band: &DampingBand) -> f64 {
    3.0 / (std::f64::consts::TAU * 0.5 * width_hz(band.centre_hz))
}
