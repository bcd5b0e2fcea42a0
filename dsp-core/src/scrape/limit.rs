//! Limit α of the path's curvature at a normal force (scraping-rolling eq. 6 and 7).

use super::ramp::power_of_two;

/// Limits of a contact between its least and its largest normal force.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Limit at the largest and at the least normal force, in metres.
    alpha_m: [f32; 2],
    least_n: f32,
    /// One over the range of the normal forces, 0 if there is none.
    per_n: f32,
    exponent: f32,
}

impl Limits {
    /// Limits in metres at the largest and at the least of two normal forces, with the exponent ζ.
    pub(super) fn new(alpha_m: [f32; 2], [least_n, most_n]: [f32; 2], exponent: f32) -> Self {
        let per_n = if most_n > least_n { 1.0 / (most_n - least_n) } else { 0.0 };
        Self { alpha_m, least_n, per_n, exponent }
    }

    /// Mean of both limits.
    pub(super) fn mean_m(&self) -> f32 {
        let [least_m, most_m] = self.alpha_m;
        0.5 * (least_m + most_m)
    }

    /// Limit at a normal force; the mean if there is but one force.
    pub(super) fn at(&self, normal_n: f32) -> f32 {
        let [least_m, most_m] = self.alpha_m;
        if self.per_n == 0.0 {
            return self.mean_m();
        }
        let share = (normal_n - self.least_n) * self.per_n;
        let power = match share {
            ..=0.0 => 0.0,
            1.0.. => 1.0,
            _ => power_of_half(-self.exponent * log2(share)),
        };
        most_m + power * (least_m - most_m)
    }
}

/// Logarithm of a normal number above 0, exact to 3e-7 and to the last bits of larger ones.
fn log2(number: f32) -> f32 {
    // The mantissa from 0.707 to 1.414.
    let shifted = number.to_bits().wrapping_sub(0x3f35_04f3);
    let exponent = (shifted as i32) >> 23;
    let mantissa = f32::from_bits((shifted & 0x007f_ffff).wrapping_add(0x3f35_04f3));
    // log2 m = 2/ln 2 artanh s.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let square = s * s;
    const SCALE: f32 = 2.0 * core::f32::consts::LOG2_E;
    let series = [SCALE / 7.0, SCALE / 5.0, SCALE / 3.0].into_iter().fold(0.0, |sum, term| (sum + term) * square);
    exponent as f32 + s * (series + SCALE)
}

/// Power of one half, exact to 2e-7, for exponents from 0 on.
pub(super) fn power_of_half(exponent: f32) -> f32 {
    let whole = exponent as i32;
    // e^-y about the middle of an octave.
    let y = core::f32::consts::LN_2 * (exponent - whole as f32 - 0.5);
    let series = [-1.0 / 5040.0, 1.0 / 720.0, -1.0 / 120.0, 1.0 / 24.0, -1.0 / 6.0, 0.5, -1.0, 1.0];
    let power = series.into_iter().fold(0.0, |sum, term| sum * y + term);
    core::f32::consts::FRAC_1_SQRT_2 * power * power_of_two(-whole.min(126))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limit_follows_the_power_of_the_normal_force_within_1e_6() {
        for exponent in [0.05_f32, 0.95, 1.0, 8.0] {
            let limits = Limits::new([1e-6, 5e-6], [0.0, 2.0], exponent);
            for step in 0..4000_u16 {
                let normal_n = 2.0 * f32::from(step) / 4000.0;
                let power = f64::from(normal_n / 2.0).powf(exponent.into());
                let error = f64::from(limits.at(normal_n)) / (5e-6 - 4e-6 * power) - 1.0;
                assert!(error.abs() < 1e-6 * f64::from(exponent.max(1.0)), "{normal_n} ^ {exponent}: {error:e}");
            }
        }
    }
}
