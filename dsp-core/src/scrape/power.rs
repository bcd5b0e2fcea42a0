//! Power of a signal's size, `|x|^p`, sample by sample.

use super::ramp::power_of_two;
use crate::fixed::{self, Log2};

/// Number of intervals of a mantissa, 1 to 2.
const INTERVALS: usize = 64;

/// Tables for powers with a fixed exponent p: `m^p` of mantissas m, and `2^(-i p)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Powers {
    /// `(1 + i/64)^p / 2^p`, Q29, up to a mantissa of 2 + 1/64.
    mantissas: [i32; INTERVALS + 2],
    /// `2^(-i p)` as a mantissa from 1 to 2, Q30, and a number of halvings.
    octaves: [(i32, u32); 32],
}

/// Power from 0 to 1: `mantissa · 2^(-30 - halvings)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Power {
    /// Mantissa, below 2^31.
    pub(super) mantissa: i32,
    /// Number of halvings.
    pub(super) halvings: u32,
}

impl Powers {
    /// Makes the tables of an exponent from 0.25 to 4.
    pub(super) fn new(exponent: f32) -> Self {
        let q27 = (exponent * (1 << 27) as f32) as i32;
        let power = |number: f32, one: u64| Log2::new(number).power(q27).of(one) as i32;
        let mut powers = Self { mantissas: [0; INTERVALS + 2], octaves: [(0, 0); 32] };
        for (index, mantissa) in powers.mantissas.iter_mut().enumerate() {
            let number = (INTERVALS + index) as f32 / (2 * INTERVALS) as f32;
            // Logarithms end at 1: the last number is taken as the inverse of its inverse.
            let inverse = |x: f32| ((1_u64 << 58) / power(1.0 / x, 1 << 29).max(1) as u64) as i32;
            *mantissa = if number > 1.0 { inverse(number) } else { power(number, 1 << 29) };
        }
        for (index, octave) in powers.octaves.iter_mut().enumerate() {
            let power = Log2::new(power_of_two(-(index as i32))).power(q27);
            *octave = ((power.mantissa >> 1) as i32, power.exponent.unsigned_abs());
        }
        powers
    }

    /// Power of a number from 0 to below 1 in Q63. Between the table's values it is a parabola,
    /// which is within 6e-6 of the power. Below 2^-31 it is 0.
    #[inline(always)]
    pub(super) fn of(&self, x: u64) -> Power {
        let none = Power { mantissa: 0, halvings: 0 };
        if x == 0 {
            return none;
        }
        // The mantissa, 2^31 to 2^32, stands for 1/2 to 1.
        let zeros = x.leading_zeros();
        let mantissa = ((x << zeros) >> 32) as u32;
        let index = (mantissa >> 25 & 63) as usize;
        let Some(&[low, high, next]) = self.mantissas.get(index..).and_then(<[i32]>::first_chunk) else { return none };
        let within = (mantissa << 7 >> 1) as i32;
        let bend = fixed::times_q31((next - 2 * high + low) >> 1, within - i32::MAX);
        let fine = low + fixed::times_q31(high - low + bend, within);
        // A number below 1 has a leading zero at least, which the mantissa's 1/2 makes up for.
        let Some(&(octave, halvings)) = self.octaves.get(zeros.saturating_sub(1) as usize) else { return none };
        Power { mantissa: ((i64::from(fine) * i64::from(octave)) >> 29) as i32, halvings }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_within_6e_6_of_themselves_over_30_octaves() {
        for exponent in [0.25_f32, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0] {
            let powers = Powers::new(exponent);
            for step in 1..40_000u64 {
                let x = (step * 0xcafe_9876_5432) >> (step % 30) | (1 << 32);
                let exact = (x as f64 / 2f64.powi(63)).powf(exponent.into());
                let power = powers.of(x);
                let value = f64::from(power.mantissa) * 2f64.powi(-30 - power.halvings as i32);
                let error = value - exact;
                assert!(error.abs() < 6e-6 * exact, "{x} ^ {exponent}: {error:e} of {exact:e}");
            }
        }
    }
}
