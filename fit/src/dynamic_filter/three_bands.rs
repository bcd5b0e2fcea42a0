//! The paper's criterion: a first-order filter that keeps the damping in the bands of three
//! spectral centroids (dynamic-filter eq. 17 to 21).

use std::f64::consts::TAU;

use super::model::{Coefficients, RATE_HZ};
use super::response::{NoiseBand, response};
use crate::bark::{DampingLaw, bark};

/// Number of values of a1 that are tried before the golden-section search.
const TRIED: usize = 400;
/// Bound on |a1| (eq. 21), just below 1.
const MOST_A1: f64 = 0.99995;

/// Coefficients {a1, b0} at each of `times_s`, the first of which is 0.
///
/// Eq. 20 fixes differences of amplitudes only. At the strike, which has no predecessor, `|F|`
/// itself meets `Λ(G_k)` by least squares; from there on each step minimises criterion 19. For a
/// given a1 that is linear in b0, so a1 alone is searched: over -1 to 1 (eq. 21), then by golden
/// section. Λ is divided by the band's response to the filter's white noise.
pub(crate) fn keep_three(law: &DampingLaw, times_s: &[f64]) -> Vec<Coefficients> {
    let centroids = &law.centroids;
    let bands: Vec<Kept> = [centroids.whole_hz, centroids.below_hz, centroids.above_hz]
        .into_iter()
        .map(|frequency_hz| {
            let heard = NoiseBand::new(bark(frequency_hz)).power(|_| 1.0).max(1e-30).sqrt();
            Kept {
                angular: TAU * frequency_hz / RATE_HZ,
                gain: law.gain(frequency_hz) / heard,
                decay_per_s: law.decay_per_s(frequency_hz),
            }
        })
        .collect();
    let mut filters: Vec<Coefficients> = Vec::with_capacity(times_s.len());
    let mut before_s = 0.0;
    for &time_s in times_s {
        let wanted = |band: &Kept| match filters.last() {
            None => band.gain * (-band.decay_per_s * time_s).exp(),
            // |F(t1)| that makes δ equal to δ~.
            Some(last) => {
                let fallen = (-band.decay_per_s * before_s).exp() - (-band.decay_per_s * time_s).exp();
                response(last, band.angular).norm() - band.gain * fallen
            }
        };
        let wanted: Vec<f64> = bands.iter().map(wanted).collect();
        filters.push(best(&bands, &wanted));
        before_s = time_s;
    }
    filters
}

struct Kept {
    angular: f64,
    gain: f64,
    decay_per_s: f64,
}

/// The first-order filter (eq. 17) whose magnitudes in the bands come nearest to those wanted.
fn best(bands: &[Kept], wanted: &[f64]) -> Coefficients {
    let with_a1 = |a1: f64| {
        let shape = Coefficients { a: [a1, 0.0], b: [1.0, 1.0, 0.0] };
        let shapes: Vec<f64> = bands.iter().map(|band| response(&shape, band.angular).norm()).collect();
        let (both, own) = shapes.iter().zip(wanted).fold((0.0, 0.0), |(both, own), (h, w)| (both + h * w, own + h * h));
        let b0 = (both / own.max(f64::MIN_POSITIVE)).max(0.0);
        let criterion: f64 = shapes.iter().zip(wanted).map(|(h, w)| 0.5 * (b0 * h - w).powi(2)).sum();
        (criterion, Coefficients { a: [a1, 0.0], b: [b0, b0, 0.0] })
    };
    // Even steps in the logarithm of the pole's distance to the unit circle, which sets a
    // low-pass's edge.
    let a1_of = |place: f64| MOST_A1 * place.tanh();
    let widest = 5.0;
    let step = 2.0 * widest / TRIED as f64;
    let places = (0..=TRIED).map(|index| -widest + step * index as f64);
    let start = places.min_by(|a, b| with_a1(a1_of(*a)).0.total_cmp(&with_a1(a1_of(*b)).0)).unwrap_or(0.0);
    let (mut low, mut high) = (start - step, start + step);
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..40 {
        let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
        if with_a1(a1_of(left)).0 < with_a1(a1_of(right)).0 { high = right } else { low = left }
    }
    with_a1(a1_of(0.5 * (low + high))).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bark::{Centroids, DampingBand, frequency_hz};

    #[test]
    fn a_law_that_a_first_order_filter_can_follow_is_followed_within_2_percent() {
        let bands = (2..22).map(f64::from).map(|rate| DampingBand {
            bark: rate,
            centre_hz: frequency_hz(rate),
            // White noise through a constant gain decays alike in all bands.
            gain: 0.1 * NoiseBand::new(rate).power(|_| 1.0).sqrt(),
            decay_per_s: 20.0,
        });
        let centroids = Centroids { whole_hz: 1000.0, below_hz: 400.0, above_hz: 2500.0, highest_hz: 9000.0 };
        let law = DampingLaw { bands: bands.collect(), centroids };
        let times_s: Vec<f64> = (0..40).map(|step| 0.005 * f64::from(step)).collect();
        for (filter, time_s) in keep_three(&law, &times_s).iter().zip(&times_s) {
            for frequency in [400.0, 1000.0, 2500.0] {
                let ratio = response(filter, TAU * frequency / RATE_HZ).norm() / (0.1 * (-20.0 * time_s).exp());
                assert!((ratio - 1.0).abs() < 0.02, "{time_s} s, {frequency} Hz: {ratio}");
            }
            assert!(filter.a[0].abs() < 1.0);
        }
    }
}
