//! The shapes of a contact: force over time, as a fraction of the peak.

use core::num::NonZeroU32;

pub use super::angle::WHOLE;
use super::angle::{Angle, Width};
use super::shape::MAX_SHAPE;
use crate::fixed::{self, Log2, ONE_Q27};
use crate::square_root::rounded_root;

/// Shape of the contact force over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pulse {
    /// Contact of spheres that lose energy, `N sin(πx) (1 + A cos(πx))`, x = t/τ in 0 to 1.
    Hertz(Asymmetry),
    /// Gaussian, `exp(-6/τ² (t - t_i - τ/2)²)` (diffimpact eq. 2).
    ///
    /// It begins where it is 100 dB below its peak, and ends at that level.
    Gaussian,
}

/// Parameters A and N of a [`Pulse::Hertz`], from the coefficient of restitution e.
///
/// `A = (1-r)/(1+r)`, where r is the ratio of the force's last slope to its first. `r = e^4.6` is
/// within 4 % of Hunt and Crossley's contact `x'' = -x^1.5 (1 + μ x')` for e from 0.45 to 1. N
/// makes the peak 1. At e = 1 the pulse is the half-sine of diffimpact §3.2; below, its
/// spectrum `N² (2/π)² [c²/(1-4x²)² + (A/4)² s²/(1-x²)²]`, x = fτ, c = cos πx, s = sin πx, has no
/// zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Asymmetry {
    /// Skew A, Q31, from 0 to below 1.
    skew: i32,
    /// Mean of the pulse over τ, `2N/π`, Q31, 0.49 to 0.64.
    area: NonZeroU32,
}

/// Coefficients of a Hertz pulse's means over intervals of one width.
///
/// The mean about the middle m is `sin(πm) (even + odd cos(πm))`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Means {
    /// Coefficient of `sin(πm)`, Q29, 0 to 1.
    even: i32,
    /// Coefficient of `sin(πm) cos(πm)`, Q31, 0 to 0.77.
    odd: i32,
}

/// Length of the Gaussian in contact times τ: `2 sqrt(ln(10^5)/6)`.
const GAUSSIAN_LENGTH: f64 = 2.770_430_227_115_183;
/// Shortest Gaussian contact time in samples: with fewer the sum of the samples misses the impulse.
const SHORTEST_GAUSSIAN_SAMPLES: f64 = 1.75;

impl Pulse {
    /// Derives the Hertz pulse of a coefficient of restitution, 0.1 to 1, once a strike.
    ///
    /// It is computed in `f32`: A and N are within 2^-21. `Part::Strike` counts its cycles.
    pub fn hertz(restitution: f32) -> Self {
        const SLOPE_EXPONENT_Q27: i32 = (4.6 * ONE_Q27 as f64) as i32;
        // At most 1, and 2^-16 at e = 0.1: `Log2` holds numbers at 1, shifts are held at 31.
        let slopes = Log2::new(restitution).power(SLOPE_EXPONENT_Q27).of(1 << 31) as f32 / (1u32 << 31) as f32;
        let skew = (1.0 - slopes) / (1.0 + slopes);
        // The force is largest at 2A cos²(πx) + cos(πx) - A = 0. The product of both factors below
        // is 1 to 1.3.
        let cosine = 2.0 * skew / (1.0 + rounded_root(1.0 + 8.0 * skew * skew));
        let scale = 1.0 / (rounded_root(1.0 - cosine * cosine) * (1.0 + skew * cosine));
        let q31 = |value: f32| (value * (1u32 << 31) as f32) as u32;
        Self::Hertz(Asymmetry {
            skew: q31(skew).min(i32::MAX as u32) as i32, // `as` saturates
            area: NonZeroU32::new(q31(scale * core::f32::consts::FRAC_2_PI)).unwrap_or(NonZeroU32::MIN),
        })
    }

    /// Length of the pulse in contact times τ: 1, or 2.770 for the Gaussian.
    pub const fn length(self) -> f64 {
        match self {
            Self::Hertz(_) => 1.0,
            Self::Gaussian => GAUSSIAN_LENGTH,
        }
    }

    /// Mean of the pulse over τ, relative to its peak: the impulse is `m τ` times this mean.
    pub fn area(self) -> f32 {
        match self {
            Self::Hertz(Asymmetry { area, .. }) => area.get() as f32 / (1u32 << 31) as f32,
            // sqrt(π/6) erf(sqrt(ln(10^5))).
            Self::Gaussian => 0.723_600_1,
        }
    }

    /// Limits the step of a contact, and returns step and peak as played.
    ///
    /// A Gaussian too fast for its samples to add up to its impulse is played slower and weaker,
    /// with that impulse.
    pub(super) fn played(self, step: u64, peak: i32) -> (u64, i32) {
        const FASTEST_GAUSSIAN: u64 = (WHOLE as f64 / (SHORTEST_GAUSSIAN_SAMPLES * GAUSSIAN_LENGTH)) as u64;
        match self {
            Self::Gaussian if step > FASTEST_GAUSSIAN => {
                let ratio = q31_ratio(FASTEST_GAUSSIAN, step);
                (FASTEST_GAUSSIAN, ((i64::from(peak) * i64::from(ratio) + (1 << 30)) >> 31) as i32)
            }
            // More than the law's shortest contact asks for at the lowest rate.
            Self::Hertz(_) | Self::Gaussian => (step.min(16 * WHOLE), peak),
        }
    }
}

impl Asymmetry {
    /// Skew A, Q31.
    #[cfg(test)]
    pub(super) fn skew(self) -> i32 {
        self.skew
    }

    /// Coefficients of the means over intervals of a width, of which the pulse fills a share.
    ///
    /// `share` is the part of a sample's interval that the pulse fills, Q31, 0 to 1.
    ///
    /// Let the pulse fill the width w about the middle m of a sample, with `share = w τ fs`. The
    /// mean is `share N [sinc(w/2) sin(πm) + A/2 sinc(w) sin(2πm)]`. With P(w) = `sin(πw/2)/w` that
    /// is `share (2N/π) P(w) sin(πm) [1 + A cos(πw/2) cos(πm)]`: no difference of nearly equal
    /// numbers, however long or short the contact.
    #[inline(never)] // one for all
    pub(super) fn means(self, width: Width, share: u32) -> Means {
        // At most (2/π) 2^31 · 2^31, then times P < 2 in Q29: below 2^62.
        let filled = (u64::from(self.area.get()) * u64::from(share)) >> 31;
        let even = (filled as i64 * i64::from(width.sinc) + (1 << 30)) >> 31;
        // At most 2^31 · 2^31.
        let odd = (((even * i64::from(width.cosine)) >> 27) * i64::from(self.skew) + (1 << 30)) >> 31;
        Means { even: even as i32, odd: odd.min(i32::MAX.into()) as i32 }
    }

    /// Mean over the first or last sample's interval, Q29, of which the pulse may fill any part.
    ///
    /// The interval ends at the phase `end` and is `step` long.
    #[inline(never)] // twice a contact, and its registers would be the inner loop's
    pub(super) fn edge(self, end: u64, step: u64) -> i32 {
        let (from, to) = (end.saturating_sub(step).min(WHOLE), end.min(WHOLE));
        let width = to - from;
        let middle = ((from + to) >> 27).min(u64::from(u32::MAX));
        self.means(Width::new(width), q31_ratio(width, step)).at(Angle::at(middle as u32))
    }
}

/// Ratio `part / whole` in Q31, within 2^-28, for a part of at most the whole and a whole below
/// 2^63.
///
/// Two divisions in single precision; the second divides the remainder of the first. A division of
/// 64-bit integers takes 864 bytes of flash.
fn q31_ratio(part: u64, whole: u64) -> u32 {
    let shift = whole.leading_zeros().saturating_sub(1);
    // Of 31 bits, the whole of at least 2^30.
    let (part, whole) = (((part << shift) >> 32) as u32, (((whole << shift) >> 32) as u32).max(1 << 30));
    let unit = (1u32 << 31) as f32;
    let first = (part as f32 / whole as f32 * unit) as u32; // `as` saturates
    // Less than 2^31 · 2^9 either way.
    let left = (i64::from(part) << 31) - i64::from(first.min(1 << 31)) * i64::from(whole);
    let correction = (left >> 16) as i32 as f32 / (whole >> 16) as f32;
    first.min(1 << 31).saturating_add_signed(correction as i32).min(1 << 31)
}

impl Means {
    /// Mean about a middle, Q29, 0 to below 1. The error is at most 1e-8 of the peak, that of the
    /// angle included.
    ///
    /// [`crate::engine::CostItem::ContactFrame`] counts its cycles.
    #[inline(always)]
    pub(super) fn at(self, angle: Angle) -> i32 {
        // The bracket is at most 0.77 + 1 in Q29.
        let bracket = fixed::smmlar(self.even, self.odd, angle.cosine());
        let mean = (i64::from(angle.sine()) * i64::from(bracket)) >> 30;
        (mean as i32).clamp(0, MAX_SHAPE)
    }
}

#[cfg(test)]
mod tests {
    use super::super::shape::{SHAPE_BITS, gaussian};
    use super::*;
    use core::f64::consts::PI;

    #[test]
    fn a_ratio_is_that_of_its_numbers_within_2_to_the_minus_28() {
        let (mut random, mut worst) = (1u64, 0.0f64);
        let mut next = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            random
        };
        for _ in 0..100_000 {
            let whole = ((next() >> 1) >> (next() % 62)).max(1);
            let part = ((whole >> (next() % 20)) as f64 * (next() >> 11) as f64 / (1u64 << 53) as f64) as u64;
            let ratio = f64::from(q31_ratio(part.min(whole), whole)) / (1u64 << 31) as f64;
            worst = worst.max((ratio - part.min(whole) as f64 / whole as f64).abs());
        }
        assert_eq!((q31_ratio(0, 7), q31_ratio(WHOLE, WHOLE)), (0, 1 << 31));
        assert!(worst < 1.0 / (1u64 << 28) as f64, "{worst:e}");
    }

    /// A and N of the law, in `f64`.
    fn law(restitution: f64) -> (f64, f64) {
        let slopes = libm::pow(restitution, 4.6);
        let skew = (1.0 - slopes) / (1.0 + slopes);
        let shape = |x: f64| libm::sin(PI * x) * (1.0 + skew * libm::cos(PI * x));
        // The peak by search, not by the formula of the code.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..200 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if shape(a) < shape(b) { low = a } else { high = b }
        }
        (skew, 1.0 / shape((low + high) / 2.0))
    }

    fn asymmetry(restitution: f32) -> Asymmetry {
        match Pulse::hertz(restitution) {
            Pulse::Hertz(asymmetry) => asymmetry,
            Pulse::Gaussian => unreachable!("asked for another pulse"),
        }
    }

    const RESTITUTIONS: [f32; 6] = [0.1, 0.3, 0.45, 0.7, 0.95, 1.0];

    #[test]
    fn skew_and_area_follow_the_law_within_two_to_the_minus_21() {
        for restitution in RESTITUTIONS {
            let (skew, scale) = law(restitution.into());
            let got = asymmetry(restitution);
            let errors = [
                f64::from(got.skew) / 2f64.powi(31) - skew,
                f64::from(got.area.get()) / 2f64.powi(31) / (scale * 2.0 / PI) - 1.0,
            ];
            assert!(errors.iter().all(|error| error.abs() < 2f64.powi(-21)), "{restitution}: {errors:?}");
        }
    }

    #[test]
    fn means_of_any_interval_follow_the_integral_to_1e_8_of_the_peak() {
        let mut worst = 0.0f64;
        for restitution in RESTITUTIONS {
            let pulse = asymmetry(restitution);
            let (skew, area) = (f64::from(pulse.skew) / 2f64.powi(31), f64::from(pulse.area.get()) / 2f64.powi(31));
            // The integral from 0, as a sum of squares of sines: no cancellation near 0.
            let integral = |x: f64| {
                let x = x.clamp(0.0, 1.0);
                let (half, whole) = (libm::sin(PI * x / 2.0), libm::sin(PI * x));
                area * (half * half + skew / 4.0 * whole * whole)
            };
            for samples in [0.08, 0.3, 0.96, 1.0, 1.04, 2.5, 7.7, 33.3, 480.1] {
                let step = (WHOLE as f64 / samples) as u64;
                let h = step as f64 / WHOLE as f64;
                for early in 0..50u64 {
                    let mut phase = step / 50 * early;
                    while phase < WHOLE + step {
                        let x = phase as f64 / WHOLE as f64;
                        let exact = (integral(x) - integral(x - h)) / h;
                        let edge = pulse.edge(phase, step);
                        let inner = (step..=WHOLE).contains(&phase).then(|| {
                            pulse.means(Width::new(step), 1 << 31).at(Angle::at(((phase - step / 2) >> 26) as u32))
                        });
                        for got in core::iter::once(edge).chain(inner) {
                            worst = worst.max((f64::from(got) / 2f64.powi(29) - exact).abs());
                        }
                        phase += step;
                    }
                }
            }
        }
        assert!(worst < 1e-8, "{worst:e}");
    }

    #[test]
    fn gaussian_follows_its_law_to_7e_9_of_the_peak() {
        let worst = (0..=1_000_000u64)
            .map(|step| {
                let fraction = (step * u64::from(u32::MAX) / 1_000_000) as u32;
                let got = f64::from(gaussian(fraction)) / f64::from(1 << SHAPE_BITS);
                let x = f64::from(fraction) / 2f64.powi(32);
                (got - (-1e5f64.ln() * (2.0 * x - 1.0).powi(2)).exp()).abs()
            })
            .fold(0.0, f64::max);
        assert!(worst < 7e-9, "{worst}");
    }

    #[test]
    fn length_and_area_of_the_gaussian_are_those_of_its_law() {
        assert!((Pulse::Gaussian.length() - 2.0 * (1e5f64.ln() / 6.0).sqrt()).abs() < 1e-12);
        let sum: f64 = (0..100_000u32).map(|step| f64::from(gaussian(step.wrapping_mul(42_950)))).sum::<f64>();
        let area = sum / 100_000.0 / f64::from(1 << SHAPE_BITS) * Pulse::Gaussian.length();
        assert!((area - f64::from(Pulse::Gaussian.area())).abs() < 1e-4, "{area}");
    }
}
