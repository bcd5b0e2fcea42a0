//! Decimation by an integer factor.

use std::f64::consts::PI;

/// Half the length of the filter, in output samples.
const HALF_LENGTH: usize = 32;
/// Shape parameter β of the Kaiser window, for 100 dB.
const BETA: f64 = 10.0;

/// Every `factor`-th sample of the low-passed sound less its offset, without delay.
///
/// The pass band ends at 0.9 of the new Nyquist frequency; images lie 100 dB down. The end of a
/// sound that may ring on is left out as far as the filter would hear it stop: a fit would take
/// that for modes. Sounds of less than four times that length are kept whole.
pub(super) fn decimate(samples: &[f32], offset: f64, factor: usize) -> Vec<f64> {
    if factor <= 1 {
        return samples.iter().map(|&x| f64::from(x) - offset).collect();
    }
    let half = (HALF_LENGTH * factor) as i64;
    let cutoff = 0.95 / factor as f64;
    let taps: Vec<f64> = (-half..=half)
        .map(|n| {
            let x = n as f64;
            let sinc = if n == 0 { cutoff } else { (PI * cutoff * x).sin() / (PI * x) };
            sinc * bessel_i0(BETA * (1.0 - (x / half as f64).powi(2)).max(0.0).sqrt()) / bessel_i0(BETA)
        })
        .collect();
    let heard = if samples.len() > 8 * half as usize { samples.len() - half as usize } else { samples.len() };
    (0..heard.div_ceil(factor))
        .map(|index| {
            let first = (index * factor) as i64 - half;
            let skip = (-first).max(0) as usize;
            let from = first.max(0) as usize;
            taps[skip.min(taps.len())..]
                .iter()
                .zip(&samples[from.min(samples.len())..])
                .map(|(h, x)| h * (f64::from(*x) - offset))
                .sum()
        })
        .collect()
}

/// Modified Bessel function of order 0, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let (mut sum, mut term, mut k) = (1.0, 1.0, 1.0);
    while term > sum * 1e-17 {
        term *= (x / (2.0 * k)).powi(2);
        sum += term;
        k += 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sound_that_rings_on_at_its_end_is_decimated_without_a_transient() {
        for factor in [2, 4] {
            let wave = |n: usize| (0.05 * n as f64 / factor as f64).sin();
            let samples: Vec<f32> = (0..4_000 * factor).map(|n| wave(n) as f32).collect();
            let decimated = decimate(&samples, 0.0, factor);
            assert_eq!(decimated.len(), 4_000 - HALF_LENGTH);
            let rings = decimated.iter().enumerate().skip(HALF_LENGTH);
            let worst = rings.fold(0.0f64, |worst, (n, x)| worst.max((x - wave(n * factor)).abs()));
            assert!(worst < 2e-5, "{worst:e}");
        }
    }
}
