//! A mode for each of the loudest partials of a strike.

use std::f64::consts::TAU;

use fourier::Complex;

use crate::hearing::Partial;
use crate::modes::DampedSine;

/// Relative distance within which a mode is a partial's.
const NEAR: f64 = 0.002;
/// Number of samples under the window that measures a decay.
const SIZE: usize = 8_192;
/// Largest time between two measurements of a partial, in seconds.
const APART_S: f64 = 0.2;
/// Least level of a partial's mode relative to the partial, in the partial's spectrum: -12 dB.
const LEAST_LEVEL: f64 = 0.25;
/// Slowest and fastest decay in 1/s of a mode that is added.
const DECAYS_PER_S: [f64; 2] = [0.3, 60.0];

/// Modes with one for each of the loudest partials, which
/// [`Partials::loudest`](crate::hearing::Partials::loudest) gives.
///
/// A mode whose width reaches the partial is moved to it, if it still rings in the spectrum in
/// which the partial is heard: a mode of the attack alone cannot be the partial's at any gain.
/// Without one, a mode is added; if there are already `most`, it takes the place of the last that
/// is no partial's. The modes most worth their place come first.
pub(super) fn with_partials(
    mut modes: Vec<DampedSine>,
    partials: &[(usize, Partial)],
    strike: &[f64],
    rate_hz: f64,
    most: usize,
) -> Vec<DampedSine> {
    let bin_hz = rate_hz / SIZE as f64;
    let mut is_partial = vec![false; modes.len()];
    for (_, partial) in partials {
        let distance = |mode: &DampedSine| (mode.frequency_hz - partial.frequency_hz).abs();
        let start = (partial.at_s * rate_hz) as usize;
        let least = LEAST_LEVEL * size_at(strike, TAU * partial.frequency_hz / rate_hz, start);
        let rings = |k: &usize| modes[*k].amplitude * left_at(modes[*k].decay_per_s / rate_hz, start) >= least;
        let free = (0..modes.len()).filter(|k| !is_partial[*k] && rings(k));
        let nearest = free.min_by(|&a, &b| distance(&modes[a]).total_cmp(&distance(&modes[b])));
        let reaches = |k: &usize| {
            let mode = &modes[*k];
            distance(mode) < (mode.decay_per_s / TAU).min(2.0 * bin_hz).max(NEAR * partial.frequency_hz)
        };
        let place = match nearest.filter(reaches) {
            Some(place) => place,
            None if modes.len() < most => {
                modes.push(of_partial(partial, strike, rate_hz));
                is_partial.push(true);
                continue;
            }
            None => {
                let Some(place) = (0..modes.len()).rev().find(|&k| !is_partial[k]) else { break };
                modes[place] = of_partial(partial, strike, rate_hz);
                place
            }
        };
        is_partial[place] = true;
        if distance(&modes[place]) > NEAR * partial.frequency_hz {
            modes[place].frequency_hz = partial.frequency_hz;
        }
    }
    modes
}

/// A damped sine of a partial's frequency, with the decay between two spectra.
fn of_partial(partial: &Partial, strike: &[f64], rate_hz: f64) -> DampedSine {
    let start = (partial.at_s * rate_hz) as usize;
    let apart = ((APART_S * rate_hz) as usize).min(strike.len().saturating_sub(start + SIZE / 2)).max(1);
    let angular = TAU * partial.frequency_hz / rate_hz;
    let [first, second] = [start, start + apart].map(|from| size_at(strike, angular, from));
    let decay_per_s = ((first / second).ln() * rate_hz / apart as f64).clamp(DECAYS_PER_S[0], DECAYS_PER_S[1]);
    DampedSine { frequency_hz: partial.frequency_hz, decay_per_s, amplitude: first, phase: 0.0 }
}

/// Amplitude of a frequency in rad/sample, in the spectrum that begins at a sample.
fn size_at(strike: &[f64], angular: f64, from: usize) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (n, x) in strike.iter().skip(from).take(SIZE).enumerate() {
        let (sine, cosine) = (angular * n as f64).sin_cos();
        let weighed = x * hann(n);
        re += weighed * cosine;
        im += weighed * sine;
    }
    re.hypot(im).max(f64::MIN_POSITIVE) * 4.0 / SIZE as f64
}

/// Share of its amplitude that a mode has in the spectrum that begins at a sample; the decay is per
/// sample.
///
/// `Σ h[n] e^(-d(s+n)) = e^(-ds) (1 - e^(-dN))/2 · (1/(1 - e^-d) - Re 1/(1 - e^(-d + 2πj/N)))`.
fn left_at(decay: f64, from: usize) -> f64 {
    let decay = decay.max(f64::EPSILON);
    let turned = (Complex::new(1.0, 0.0) - Complex::new(-decay, TAU / SIZE as f64).exp()).inv().re;
    let sum = -0.5 * (-decay * SIZE as f64).exp_m1() * (-1.0 / (-decay).exp_m1() - turned);
    (-decay * from as f64).exp() * sum * 2.0 / SIZE as f64
}

/// Hann window of a spectrum at a sample, 0 to 1.
fn hann(n: usize) -> f64 {
    0.5 - 0.5 * (TAU * n as f64 / SIZE as f64).cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hearing::Partials;
    use crate::joint::LOUDEST;

    /// Modes with one for each of the loudest partials of a strike at 44.1 kHz.
    fn with_partials_of(strike: &[f64], modes: Vec<DampedSine>, most: usize) -> Vec<DampedSine> {
        let partials = Partials::new(&[], strike, 44_100.0).loudest(LOUDEST);
        with_partials(modes, &partials, strike, 44_100.0, most)
    }

    #[test]
    fn share_of_a_mode_in_a_spectrum_is_the_sum_over_its_samples() {
        for (decay, from) in [(1e-9, 0), (2e-5, 4_000), (1e-3, 100), (0.2, 3)] {
            let weighed = (0..SIZE).map(|n| hann(n) * (-decay * (from + n) as f64).exp());
            let summed = weighed.sum::<f64>() * 2.0 / SIZE as f64;
            assert!((left_at(decay, from) / summed - 1.0).abs() < 1e-6, "{decay} {from}: {summed}");
        }
    }

    fn sine(frequency_hz: f64, decay_per_s: f64, amplitude: f64) -> DampedSine {
        DampedSine { frequency_hz, decay_per_s, amplitude, phase: 0.3 }
    }

    #[test]
    fn a_mode_that_dies_away_before_its_partial_is_heard_does_not_count_as_its_mode() {
        let partial = sine(4_425.0, 8.0, 0.05);
        let mut strike = vec![0.0; 44_100];
        partial.add_to(&mut strike, 44_100.0);
        let modes = with_partials_of(&strike, vec![sine(4_427.0, 280.0, 0.5)], 4);
        assert_eq!(modes[0].decay_per_s, 280.0);
        assert!(modes.iter().any(|mode| (mode.decay_per_s / 8.0 - 1.0).abs() < 0.1), "{modes:?}");
        // With no place left, it gives way.
        let modes = with_partials_of(&strike, modes[..1].to_vec(), 1);
        assert!(modes.len() == 1 && modes[0].decay_per_s < 10.0, "{modes:?}");
    }

    #[test]
    fn each_of_the_loudest_partials_gets_a_mode() {
        let partials = [sine(323.0, 4.0, 0.1), sine(900.0, 6.0, 0.08), sine(2_500.0, 9.0, 0.05)];
        let mut strike = vec![0.0; 44_100];
        partials.iter().for_each(|partial| partial.add_to(&mut strike, 44_100.0));
        // One mode is a partial's, one lies beside it within its width, none is at the third.
        let modes = vec![sine(900.2, 6.0, 0.08), sine(327.0, 60.0, 0.1), sine(7_000.0, 9.0, 0.01)];
        let modes = with_partials_of(&strike, modes, 3);
        assert_eq!(modes.len(), 3);
        for partial in partials {
            let is_its = |mode: &DampedSine| (mode.frequency_hz / partial.frequency_hz - 1.0).abs() < 0.003;
            assert!(modes.iter().any(is_its), "{partial:?}: {modes:?}");
        }
        let added = modes.iter().find(|mode| mode.frequency_hz > 2_000.0).expect("it is there");
        assert!((added.decay_per_s / 9.0 - 1.0).abs() < 0.1, "{added:?}");
    }
}
