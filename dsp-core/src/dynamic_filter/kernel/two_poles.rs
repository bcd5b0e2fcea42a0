//! The second order at work, in plain Rust: the definition of the bits. It has a complex pole, or
//! two real poles one behind the other, with parameters that move.
//!
//! ```text
//! conjugate poles:  z = p z + g e'              s = Re z + d e
//! real poles:       z1 = p1 z1 + e'             s = d e + α z1 + z2
//!                   z2 = p2 z2 + β z1'
//! ```
//!
//! A direct form whose coefficients move can grow, even if it is stable at each point. These forms
//! cannot: see [`super::super::path`].
//!
//! A state has 32 bits below its word, and all its bits are multiplied. So slow poles neither
//! gather noise nor stop short of silence. The word is rounded to nearest and multiplied exactly.
//! The rest, which then has a sign, is multiplied too, and the high word of that product is added.
//! A factor in Q31 gives half of the product, so every sum holds half of its result.
//!
//! **Nothing can wrap.** The path's scales keep words of states below 2^30 (conjugate) and 2^29
//! (real). e is below 2^30; p, g, d are below 1 as Q31, α and β as Q30. Sums may wrap on their way
//! to results that do not. A rest is at most 2^31. So its product with a real pole or β is at most
//! 2^30, and a complex pole makes at most 2^31/√2 of two rests.

use super::super::path::{PARAMETERS, Path};
use super::super::walk::Line;
use crate::fixed::{qadd, smmla, smmls, smmul, times_q31};

/// States of the two poles, and scales that are chosen on load. The assembly reads the fields in
/// this order.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct TwoPoles {
    /// Re z and Im z, or z1 and z2, times 2^32.
    z: [i64; 2],
    /// Input e of the frame before; for real poles it is shifted by `input_bits`.
    last: i32,
    /// Scale h: a word of s is larger than the bus by 2^h.
    shift: i32,
    /// Half of the factor that takes `last` to z1, for real poles.
    inner: i32,
    /// Number of bits by which `last` is shifted to the left, for real poles.
    input_bits: u32,
}

// The assembly relies on these offsets.
#[cfg(cortex_m4f)]
const _: () = {
    use core::mem::offset_of;
    assert!(offset_of!(TwoPoles, z) == 0 && offset_of!(TwoPoles, last) == 16 && offset_of!(TwoPoles, shift) == 20);
    assert!(offset_of!(TwoPoles, inner) == 24 && offset_of!(TwoPoles, input_bits) == 28);
};

/// Adds `buffer`, filtered, to `out`, for as many frames as both have.
///
/// Leaves s in the buffer, larger than the bus by 2^h. `real` is true for real poles.
pub fn two_poles(
    poles: &mut TwoPoles,
    real: bool,
    lines: &mut [Line; PARAMETERS],
    buffer: &mut [i32],
    out: &mut [i32],
) {
    for (word, out) in buffer.iter_mut().zip(out) {
        let parameters = lines.map(|line| line.value);
        let half = if real { poles.real(parameters, *word) } else { poles.conjugate(parameters, *word) };
        lines.iter_mut().for_each(Line::advance);
        *word = (half >> 31) as i32;
        *out = qadd(*out, poles.sound(half));
    }
}

impl TwoPoles {
    pub(in super::super) const REST: Self = Self { z: [0; 2], last: 0, shift: 0, inner: 0, input_bits: 0 };

    /// True if s is smaller than the bus.
    #[cfg(cortex_m4f)]
    pub(super) const fn is_loud(&self) -> bool {
        self.shift < 0
    }

    /// Makes the states at rest, for a loaded path.
    pub(in super::super) fn new(path: &Path<'_>) -> Self {
        // e is at most 2^(28 - q).
        let input_bits = (path.input_shift + 2).clamp(0, 6);
        let inner = 1 << (31 + path.inner_scale + path.input_shift - input_bits).clamp(0, 30);
        Self { shift: path.scale, inner, input_bits: input_bits as u32, ..Self::REST }
    }

    /// Clears the states.
    pub(in super::super) fn rest(&mut self) {
        (self.z, self.last) = ([0; 2], 0);
    }

    /// Clears the states on a tick without input, if all are below a step. Gives true if all are 0.
    pub(in super::super) fn settle(&mut self) -> bool {
        if self.last == 0 && self.z.iter().all(|z| z.unsigned_abs() < 1 << 31) {
            self.z = [0; 2];
        }
        self.last == 0 && self.z == [0; 2]
    }

    /// Multiplies the states by `left` (Q31).
    pub(in super::super) fn attenuate(&mut self, left: i32) {
        self.z = self.z.map(|z| (z >> 31) * i64::from(left));
        self.last = times_q31(self.last, left);
    }

    /// Renders a frame of a complex pole. Gives half of s.
    #[inline(always)]
    fn conjugate(&mut self, [p_re, p_im, g_re, g_im, d]: [i32; PARAMETERS], e: i32) -> i64 {
        let [(re, re_rest), (im, im_rest)] = self.z.map(split);
        let rests = [smmls(smmul(p_re, re_rest), p_im, im_rest), smmla(smmul(p_re, im_rest), p_im, re_rest)];
        let half_re = product(p_re, re).wrapping_sub(product(p_im, im)).wrapping_add(i64::from(rests[0]));
        let half_im = product(p_re, im).wrapping_add(product(p_im, re)).wrapping_add(i64::from(rests[1]));
        let half_re = half_re.wrapping_add(product(g_re, self.last));
        let half_im = half_im.wrapping_add(product(g_im, self.last));
        (self.z, self.last) = ([half_re.wrapping_mul(2), half_im.wrapping_mul(2)], e);
        half_re.wrapping_add(product(d, e))
    }

    /// Renders a frame of two real poles. Gives half of s. α and β are Q30.
    #[inline(always)]
    fn real(&mut self, [p1, p2, alpha, beta, d]: [i32; PARAMETERS], e: i32) -> i64 {
        let [(z1, rest1), (z2, rest2)] = self.z.map(split);
        let half1 = product(p1, z1).wrapping_add(i64::from(smmul(p1, rest1)));
        let half1 = half1.wrapping_add(product(self.inner, self.last));
        let half2 = product(p2, z2).wrapping_add(i64::from(smmul(p2, rest2)));
        let half2 = half2.wrapping_add(twice(beta, z1, rest1));
        (self.z, self.last) = ([half1.wrapping_mul(2), half2.wrapping_mul(2)], e << self.input_bits);
        let (z1, rest1) = split(self.z[0]);
        product(d, e).wrapping_add(twice(alpha, z1, rest1)).wrapping_add(half2)
    }

    /// Converts half of s to the bus' format: shifted right, rounding down, or left, clipped.
    #[inline(always)]
    fn sound(&self, half: i64) -> i32 {
        let word = (half >> 31) as i32;
        if self.shift >= 0 {
            return word >> self.shift.min(31);
        }
        let left = self.shift.unsigned_abs().min(30);
        let most = (1 << (31 - left)) - 1;
        let below = (half as u32) << 1;
        word.clamp(-1 - most, most) << left | (below >> (32 - left)) as i32
    }
}

/// Splits a state into its word, rounded to nearest, and its signed rest.
#[inline(always)]
fn split(z: i64) -> (i32, i32) {
    ((z.wrapping_add(1 << 31) >> 32) as i32, z as i32)
}

#[inline(always)]
fn product(a: i32, b: i32) -> i64 {
    i64::from(a) * i64::from(b)
}

/// Half of the product of a state with a factor in Q30.
#[inline(always)]
fn twice(factor: i32, word: i32, rest: i32) -> i64 {
    product(factor, word).wrapping_add(i64::from(smmul(factor, rest))).wrapping_mul(2)
}
