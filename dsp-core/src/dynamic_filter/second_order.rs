//! The second order: a complex pole, or two real ones one behind the other, with parameters that move.
//!
//! A direct form with moving coefficients can grow although each of them is stable. These forms cannot: see [`super::path`]. States
//! are 32-bit words, rounded to nearest.

use super::path::{Form, PARAMETERS, Path};
use super::walk::Line;
use crate::fixed::times_q31;
use crate::resonator::TICK_FRAMES;

/// The filter's states.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TwoPoles {
    /// Re z and Im z, or z1 and z2.
    z: [i32; 2],
    last: i32,
}

impl TwoPoles {
    pub(super) const REST: Self = Self { z: [0; 2], last: 0 };

    /// At a tick into which nothing came: what rounding would keep for ever, half a step a frame over 1 - |p|, is led to 0. Gives whether all is.
    pub(super) fn settle(&mut self, form: Form) -> bool {
        if self.last != 0 {
            return false;
        }
        if self.z.iter().all(|z| z.unsigned_abs() <= SMALL) {
            self.z = self.z.map(|z| z - z.clamp(-LED, LED));
        } else if form == Form::Real && self.z[0].unsigned_abs() <= SMALL {
            // Of two real poles the second cannot end before the first.
            self.z[0] -= self.z[0].clamp(-LED, LED);
        }
        self.z == [0; 2]
    }

    /// Leaves so much (Q31) of what rings.
    pub(super) fn attenuate(&mut self, left: i32) {
        let [one, other] = self.z;
        *self = Self { z: [times_q31(one, left), times_q31(other, left)], last: times_q31(self.last, left) };
    }

    /// What lies in `buffer` through the filter; s is left there, larger than the bus by 2^h.
    pub(super) fn run<const N: usize>(&mut self, path: &Path<N>, lines: &mut [Line; PARAMETERS], buffer: &mut [i32]) {
        match path.form {
            Form::Real => {
                let shift = (31 + path.inner_scale + path.input_shift).clamp(0, 32) as u32;
                buffer.iter_mut().for_each(|word| *word = self.real(lines, *word, shift));
            }
            _ => buffer.iter_mut().for_each(|word| *word = self.conjugate(lines, *word)),
        }
    }

    /// `z = p z + g e'; s = Re z + d e`. |p| < 1 as Q31 and |z| < 2^30, |g| < 1 as Q31 and |e| <= 2^30: each sum is below 2^62.
    #[inline(always)]
    fn conjugate(&mut self, lines: &mut [Line; PARAMETERS], e: i32) -> i32 {
        let [p_re, p_im, g_re, g_im, d] = lines.map(|line| i64::from(line.value));
        let ([re, im], last) = (self.z.map(i64::from), i64::from(self.last));
        self.z = [rounded(p_re * re - p_im * im + g_re * last), rounded(p_re * im + p_im * re + g_im * last)];
        self.last = e;
        lines.iter_mut().for_each(Line::advance);
        self.z[0] + rounded(d * i64::from(e))
    }

    /// `z1 = p1 z1 + e'; z2 = p2 z2 + β z1'; s = d e + α z1 + z2`; α and β are Q30.
    #[inline(always)]
    fn real(&mut self, lines: &mut [Line; PARAMETERS], e: i32, shift: u32) -> i32 {
        let [p1, p2, alpha, beta, d] = lines.map(|line| i64::from(line.value));
        let [z1, z2] = self.z.map(i64::from);
        self.z = [rounded(p1 * z1 + (i64::from(self.last) << shift)), rounded(p2 * z2 + 2 * beta * z1)];
        self.last = e;
        lines.iter_mut().for_each(Line::advance);
        self.z[1] + rounded(2 * alpha * i64::from(self.z[0]) + d * i64::from(e))
    }
}

/// States below this, some 90 dB below the largest, are led to 0: a few times half a step over 1 - [`super::path::MAX_POLE`].
const SMALL: u32 = 1 << 15;

/// By how much in a tick: twice what rounding can add.
const LED: i32 = 2 * TICK_FRAMES as i32;

/// Q31 to whole, nearest.
#[inline(always)]
fn rounded(wide: i64) -> i32 {
    ((wide + (1 << 30)) >> 31) as i32
}
