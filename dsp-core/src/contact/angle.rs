//! Angle along a pulse, from 0 to half a turn. Each sample turns it by four products.

use super::shape::{cos_half_pi_sqrt, negated_square, sinc_half_pi_sqrt};

/// Phase at the end of a contact, 1.0.
///
/// A contact may be as short as a 16th of a sample: the phase and a step beyond it still fit 64
/// bits.
pub const WHOLE: u64 = 1 << 58;

/// Width of a sample's interval as a fraction w of the pulse, 0 to 1, and what is derived from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Width {
    /// The width w, 1.0 = [`WHOLE`].
    width: u64,
    /// Value of `sin(πw/2) / w`, Q29.
    pub(super) sinc: i32,
    /// Value of `cos(πw/2)`, Q29.
    pub(super) cosine: i32,
}

impl Width {
    /// Derives the values of a fraction of the pulse, at most 1 = [`WHOLE`].
    #[inline(never)] // one for all
    pub(super) fn new(width: u64) -> Self {
        // Q31; 1.0 itself lies a step above.
        let w = i64::from((width >> 27).min(i32::MAX as u64) as i32);
        let minus_z = -((w * w) >> 31) as i32;
        Self { width, sinc: sinc_half_pi_sqrt(minus_z), cosine: cos_half_pi_sqrt(minus_z) }
    }

    /// Rotation by πw, for w up to [`MOST_TURNED`].
    pub(super) fn rotation(self) -> Rotation {
        // sin(πw/2), Q34: the errors of turns add up, and are as small as w where there are many.
        let half = (((self.width.min(MOST_TURNED) >> 24) as i64) * i64::from(self.sinc)) >> 29;
        let sine = (half * i64::from(self.cosine) + (1 << 29)) >> 30;
        let half = (half + 1) >> 1;
        Rotation { sine: sine as i32, minus_versine: -((half * half + (1 << 32)) >> 33) as i32 }
    }
}

/// Widest interval whose rotation is below a half of Q32: contacts of fewer than 7 samples are not
/// turned.
pub(super) const MOST_TURNED: u64 = WHOLE / 7;

/// Rotation by an angle δ from 0 to π/7.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Rotation {
    /// Value of sin δ, Q32.
    sine: i32,
    /// Value of `cos δ - 1`, Q32.
    minus_versine: i32,
}

/// Sine and cosine of an angle, Q62.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Angle {
    sine: i64,
    cosine: i64,
}

impl Angle {
    /// Beginning of a pulse.
    pub(super) const ZERO: Self = Self { sine: 0, cosine: 1 << 62 };

    /// Angle πm at a fraction m of the pulse, 2^32 = 1.
    #[inline(never)] // one for all
    pub(super) fn at(fraction: u32) -> Self {
        // y = 2m - 1, Q31: sin(πm) = cos(π/2 y), cos(πm) = -sin(π/2 y) = -y P(y²).
        let from_middle = (fraction ^ 0x8000_0000) as i32;
        let minus_z = negated_square(from_middle);
        let cosine = -i64::from(from_middle) * i64::from(sinc_half_pi_sqrt(minus_z));
        Self { sine: i64::from(cos_half_pi_sqrt(minus_z)) << 33, cosine: cosine << 2 }
    }

    /// Sine, Q30, rounded down.
    #[inline(always)]
    pub(super) fn sine(self) -> i32 {
        (self.sine >> 32) as i32
    }

    /// Cosine, Q30, rounded down.
    #[inline(always)]
    pub(super) fn cosine(self) -> i32 {
        (self.cosine >> 32) as i32
    }

    /// Turns the angle by four products of upper words: what they miss is as small as the angle.
    ///
    /// Both values stay within ±1 and a few steps of 2^-30: nothing wraps.
    #[inline(always)]
    #[cfg_attr(cortex_m4f, expect(unused, reason = "the assembly has its own"))]
    pub(super) fn turned(self, by: Rotation) -> Self {
        let [sine, cosine, by_sine, less] = [self.sine(), self.cosine(), by.sine, by.minus_versine].map(i64::from);
        Self { sine: self.sine + sine * less + cosine * by_sine, cosine: self.cosine + cosine * less - sine * by_sine }
    }
}
