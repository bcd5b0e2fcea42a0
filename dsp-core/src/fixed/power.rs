//! Powers of a fraction in integers: they turn a velocity into force and contact time.

/// `number^exponent`, for numbers from 0 to 1 and exponents from 0.1 to 16.
///
/// Numbers below 0 count as 0, numbers above 1 as 1.
///
/// The relative error is below the larger of 1e-7 and 2e-8 times the exponent. An exponent of 1
/// takes a few cycles and changes no bit.
pub fn power(number: f32, exponent: f32) -> f32 {
    match (number, exponent) {
        (..=0.0, _) => 0.0,
        (_, 1.0) => number.min(1.0),
        _ => Log2::new(number).power((exponent * (1 << 27) as f32) as i32).value(),
    }
}

/// Base-2 logarithm of a number in (0, 1], Q26: 0 down to -31.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Log2(i32);

/// A power as `mantissa · 2^(exponent - 31)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Power {
    /// Q31, from 1.0 = 2^31 to below 2.
    pub mantissa: u32,
    /// Power of two.
    pub exponent: i32,
}

impl Log2 {
    /// Takes the logarithm of a number above 0, exact to 2^-27 (half a step).
    ///
    /// Numbers below 2^-31 count as 2^-31, numbers above 1 as 1. The method is
    /// a table of 16 reciprocals and `ln(1 + z) = z - z²/2 + ... - z⁶/6` for |z| < 1/32.
    pub fn new(number: f32) -> Self {
        if number >= 1.0 {
            return Self(0);
        }
        let bits = number.to_bits();
        let exponent = (bits >> 23) as i32 - 127;
        if exponent < -31 {
            return Self(-31 << 26);
        }
        let mantissa = 1 << 31 | bits << 9 >> 1;
        let index = (mantissa >> 27 & 15) as usize;
        let reciprocal = RECIPROCALS_Q32.get(index).copied().unwrap_or(u32::MAX);
        // Q31 by Q32, to Q32, less 1.
        let z = ((u64::from(mantissa) * u64::from(reciprocal)) >> 31) as i64 - (1 << 32);
        let (z2, z3) = (high(z, z), high(high(z, z), z));
        let (z4, z5, z6) = (high(z2, z2), high(z2, z3), high(z3, z3));
        let natural = z - (z2 >> 1) + high(z3, part(3)) - (z4 >> 2) + high(z5, part(5)) - high(z6, part(6));
        let fraction = i64::from(LOGARITHMS_Q32.get(index).copied().unwrap_or(0)) + ((natural * LOG2_E_Q31) >> 31);
        Self(((i64::from(exponent) << 26) + ((fraction + 32) >> 6)).min(0) as i32)
    }

    /// Raises the number to the power `exponent`, given as Q27 (-16 to 16).
    ///
    /// The error is below 2e-8 for exponents up to 2 in size, and in proportion for larger ones.
    /// The method is a table of 16 powers and `e^y - 1 = y + y²/2 + ... + y⁵/120` for y < 0.044.
    pub fn power(self, exponent_q27: i32) -> Power {
        // Q26 by Q27 to Q32: at most 31 · 2^26 · 2^31 < 2^63.
        let q32 = (i64::from(self.0) * i64::from(exponent_q27) + (1 << 20)) >> 21;
        let fraction = q32 as u32;
        let index = (fraction >> 28) as usize;
        let y = high(i64::from(fraction & 0x0fff_ffff), LN_2_Q32);
        let (y2, y3) = (high(y, y), high(high(y, y), y));
        let grown = y + (y2 >> 1) + high(y3, part(6)) + high(high(y2, y2), part(24)) + high(high(y2, y3), part(120));
        let start = i64::from(POWERS_Q31.get(index).copied().unwrap_or(1 << 31));
        let mantissa = (start + high(start, grown)).min(i64::from(u32::MAX));
        Power { mantissa: mantissa as u32, exponent: (q32 >> 32) as i32 }
    }
}

impl Power {
    /// The power as a number, within half a step of its 24 bits. Powers below 2^-95 are held
    /// between 2^-95 and 2^-94, above 0.
    pub fn value(self) -> f32 {
        // The power of two is put together from its bits.
        self.mantissa as f32 * f32::from_bits(((self.exponent - 31 + 127).clamp(1, 254) as u32) << 23)
    }

    /// Multiplies `value` by the power, rounded down; saturates at `u64::MAX`.
    pub fn of(self, value: u64) -> u64 {
        let product = (u128::from(value) * u128::from(self.mantissa)) >> 31;
        let scaled = match self.exponent {
            right @ ..=0 => product.checked_shr(right.unsigned_abs()).unwrap_or(0),
            // Below 2^65 · 2^62.
            left => product << left.min(62),
        };
        u64::try_from(scaled).unwrap_or(u64::MAX)
    }
}

/// The high word of a product of Q32 numbers below 2 in size.
fn high(a: i64, b: i64) -> i64 {
    (a * b) >> 32
}

/// `1/n` as Q32: a division of 64 bits would cost as much as all the rest.
const fn part(n: i64) -> i64 {
    ((1 << 32) + n / 2) / n
}

const LN_2_Q32: i64 = 0xb172_17f8;
const LOG2_E_Q31: i64 = 0xb8aa_3b29;

/// `1 / (1 + (i + 1/2) / 16)`.
const RECIPROCALS_Q32: [u32; 16] = [
    0xf83e_0f84,
    0xea0e_a0ea,
    0xdd67_c8a6,
    0xd20d_20d2,
    0xc7ce_0c7d,
    0xbe82_fa0c,
    0xb60b_60b6,
    0xae4c_415d,
    0xa72f_0539,
    0xa0a0_a0a1,
    0x9a90_e7d9,
    0x94f2_094f,
    0x8fb8_23ee,
    0x8ad8_f2fc,
    0x864b_8a7e,
    0x8208_2082,
];

/// `-log2` of each reciprocal.
const LOGARITHMS_Q32: [u32; 16] = [
    0x0b5d_69bb,
    0x2118_b11a,
    0x359e_bc5c,
    0x4910_1eac,
    0x5b88_8736,
    0x6d1f_afdd,
    0x7dea_15a3,
    0x8df9_88f4,
    0x9d5d_9fd6,
    0xac24_1134,
    0xba58_feb3,
    0xc807_30b0,
    0xd538_47ac,
    0xe1f4_e516,
    0xee44_cd5a,
    0xfa2f_045f,
];

/// `2^(i / 16)`.
const POWERS_Q31: [u32; 16] = [
    0x8000_0000,
    0x85aa_c368,
    0x8b95_c1e4,
    0x91c3_d374,
    0x9837_f052,
    0x9ef5_3261,
    0xa5fe_d6aa,
    0xad58_3eea,
    0xb504_f334,
    0xbd08_a39f,
    0xc567_2a11,
    0xce24_8c15,
    0xd744_fccb,
    0xe0cc_deec,
    0xeac0_c6e8,
    0xf525_7d15,
];

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn powers_are_exact_to_a_few_parts_in_a_hundred_million(base in 1e-9f32..=1.0, exponent in -2.0f64..2.0) {
            let q27 = libm::rint(exponent * 134_217_728.0);
            let Power { mantissa, exponent: power } = Log2::new(base).power(q27 as i32);
            let got = f64::from(mantissa) * libm::scalbn(1.0, power - 31);
            let exact = libm::pow(f64::from(base), q27 / 134_217_728.0);
            prop_assert!((got / exact - 1.0).abs() < 2e-8, "{got} {exact}");
        }

        #[test]
        fn a_power_scales_a_number(value: u64, exponent in -2.0f64..2.0, base in 1e-4f32..=1.0) {
            let power = Log2::new(base).power((exponent * 134_217_728.0) as i32);
            let exact = value as f64 * f64::from(power.mantissa) * libm::scalbn(1.0, power.exponent - 31);
            let got = power.of(value) as f64;
            prop_assert!((got - exact.min(u64::MAX as f64)).abs() <= 2.0 + exact * 1e-9, "{got} {exact}");
        }
    }

    #[test]
    fn powers_of_shares_are_those_of_f64_from_nothing_to_the_whole() {
        for exponent in [0.1, 0.5, 1.0, 1.7, 8.0] {
            assert_eq!((power(0.0, exponent), power(1.0, exponent), power(1.5, exponent)), (0.0, 1.0, 1.0));
            for step in 1..=1000 {
                let share = step as f32 / 1000.0;
                let (got, exact) = (power(share, exponent), libm::pow(share.into(), exponent.into()));
                let most = 1e-7_f64.max(2e-8 * f64::from(exponent));
                assert!((f64::from(got) / exact - 1.0).abs() < most, "{share}^{exponent}: {got} {exact}");
            }
        }
    }

    #[test]
    fn a_whole_velocity_changes_nothing() {
        assert_eq!(Log2::new(1.0).power(1 << 27), Power { mantissa: 1 << 31, exponent: 0 });
        assert_eq!(Log2::new(1.0).power(-(1 << 27)).of(12345), 12345);
    }
}
