//! Elliptic low-passes of odd order as poles, for splits and doublings.
//!
//! Pass band and stop band lie at equal ratios on either side of 1 rad/s: the pass band ends at √k,
//! the stop band begins at 1/√k. Poles by the series in the nome q (Antoniou, Digital Filters,
//! elliptic approximation; for σ = 1 the half-band filters of Valenzuela and Constantinides, 1983).
//! An all-pass of every second pair, and one of the others with the real pole, add up to the
//! low-pass, and differ by the high-pass of the same order.

use crate::{exponential, sine};

/// Maximum number of pole pairs.
pub(super) const MOST_PAIRS: usize = 4;

/// Poles of a low-pass of order `2 count + 1`: a real one at -σ, and pairs `s² + b1 s + b0`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Elliptic {
    pub(super) count: usize,
    pub(super) sigma: f64,
    /// `[b1, b0]`, from the real pole outwards.
    pub(super) pairs: [[f64; 2]; MOST_PAIRS],
}

impl Elliptic {
    /// A low-pass whose attenuation is also that of the high-pass.
    pub(super) fn even(count: usize, k: f64) -> Self {
        Self::new(count, k, 1.0)
    }

    /// A low-pass with a high-pass that is `high_db` down in the low-pass's pass band.
    pub(super) fn leaning(count: usize, k: f64, high_db: f64) -> Self {
        let (q, order) = (nome(k), (2 * count + 1) as f64);
        // cosh(order · Λ) is the high-pass's attenuation.
        let cosh = exponential::power(10.0, high_db / 20.0);
        let base = exponential::power(cosh + libm::sqrt(cosh * cosh - 1.0), 1.0 / order);
        let (mut numerator, mut denominator, mut sign) = (0.0, 0.5, 1.0);
        for i in 0..TERMS {
            let i = f64::from(i);
            let (odd, even) = (exponential::power(base, 2.0 * i + 1.0), exponential::power(base, 2.0 * i));
            numerator += sign * exponential::power(q, i * (i + 1.0)) * 0.5 * (odd - 1.0 / odd);
            if i > 0.0 {
                denominator += sign * exponential::power(q, i * i) * 0.5 * (even + 1.0 / even);
            }
            sign = -sign;
        }
        Self::new(count, k, libm::fabs(libm::sqrt(libm::sqrt(q)) * numerator / denominator))
    }

    fn new(count: usize, k: f64, sigma: f64) -> Self {
        let (q, order, squared) = (nome(k), (2 * count + 1) as f64, sigma * sigma);
        let outer = (1.0 + k * squared) * (1.0 + squared / k);
        let pairs = core::array::from_fn(|index| {
            let angle = (index + 1) as f64 * core::f64::consts::PI / order;
            let (mut numerator, mut denominator, mut sign) = (0.0, 0.5, 1.0);
            for i in 0..TERMS {
                let i = f64::from(i);
                numerator += sign * exponential::power(q, i * (i + 1.0)) * sine::sin((2.0 * i + 1.0) * angle);
                if i > 0.0 {
                    denominator += sign * exponential::power(q, i * i) * sine::cos(2.0 * i * angle);
                }
                sign = -sign;
            }
            let w = libm::sqrt(libm::sqrt(q)) * numerator / denominator;
            let inner = (1.0 - w * w * k) * (1.0 - w * w / k);
            let scale = 1.0 / (1.0 + squared * w * w);
            let b1 = 2.0 * sigma * libm::sqrt(libm::fabs(inner)) * scale;
            [b1, (squared * inner + w * w * outer) * scale * scale]
        });
        Self { count, sigma, pairs }
    }

    /// Power of the low-pass at `w` rad/s; that of the high-pass is the rest to 1.
    pub(super) fn low_power(&self, w: f64) -> f64 {
        // Halved phases of both all-passes as complex numbers: the low-pass is the cosine of their
        // difference.
        let mut branches = [[1.0, 0.0], [self.sigma, w]];
        for (index, &[b1, b0]) in self.pairs.iter().take(self.count).enumerate() {
            if let Some([re, im]) = branches.get_mut(index % 2) {
                let (a, b) = (b0 - w * w, b1 * w);
                [*re, *im] = [*re * a - *im * b, *re * b + *im * a];
            }
        }
        let [[a, b], [c, d]] = branches;
        let product = a * c + b * d;
        product * product / ((a * a + b * b) * (c * c + d * d))
    }
}

/// Sum of the attenuations of low-pass and high-pass, each in the other's pass band, in dB: the
/// one's gain is the other's loss.
pub(super) fn shared_db(count: usize, k: f64) -> f64 {
    -20.0 * core::f64::consts::LOG10_2 * exponential::log2(4.0 * exponential::power(nome(k), count as f64 + 0.5))
}

/// Number of terms of the series: with q below 0.1 the last is below 1e-40.
const TERMS: i32 = 8;

fn nome(k: f64) -> f64 {
    let root = libm::sqrt(libm::sqrt(1.0 - k * k));
    let e = 0.5 * (1.0 - root) / (1.0 + root);
    let e4 = e * e * e * e;
    e * (1.0 + e4 * (2.0 + e4 * (15.0 + 150.0 * e4)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pass_bands_and_stop_bands_hold_the_attenuations_that_were_asked_for() {
        for (count, k) in [(2, 0.65), (3, 0.72), (4, 0.8)] {
            let all_db = shared_db(count, k);
            for high_db in [10.0, 20.0, all_db / 2.0, all_db - 20.0, all_db - 10.0] {
                let filter = Elliptic::leaning(count, k, high_db);
                let (mut most_high, mut most_low) = (0.0f64, 0.0f64);
                for step in 0..=2000 {
                    let w = f64::from(step) / 2000.0 * k.sqrt();
                    most_high = most_high.max(1.0 - filter.low_power(w));
                    most_low = most_low.max(filter.low_power(1.0 / w.max(1e-6)));
                }
                let [high, low] = [most_high, most_low].map(|power| -10.0 * power.log10());
                assert!((high - high_db).abs() < 0.4, "{count} pairs: high-pass {high:.2} dB, asked for {high_db:.2}");
                assert!((low - (all_db - high_db)).abs() < 1.0, "{count} pairs: low-pass {low:.2} dB of {all_db:.2}");
            }
        }
    }
}
