//! The second order: a complex pole, or two real ones one behind the other, with parameters that move.
//!
//! A direct form with moving coefficients can grow although each of them is stable. These forms cannot: see [`super::path`]. States have 32 bits below
//! their words and are multiplied whole, so that slow poles neither gather noise nor stop short of silence.

use super::path::{Form, PARAMETERS, Path};
use super::walk::Line;
use crate::fixed::{qadd, saturate, times_q31};

/// The filter's states.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TwoPoles {
    /// Re z and Im z, or z1 and z2, times 2^32.
    z: [i64; 2],
    last: i32,
}

impl TwoPoles {
    pub(super) const REST: Self = Self { z: [0; 2], last: 0 };

    /// At a tick into which nothing came: clears what is below a step; gives whether all is.
    pub(super) fn settle(&mut self) -> bool {
        if self.last == 0 && self.z.iter().all(|z| z.unsigned_abs() < 1 << 31) {
            self.z = [0; 2];
        }
        self.last == 0 && self.z == [0; 2]
    }

    /// Leaves so much (Q31) of what rings.
    pub(super) fn attenuate(&mut self, left: i32) {
        self.z = self.z.map(|z| (z >> 31) * i64::from(left));
        self.last = times_q31(self.last, left);
    }

    /// What lies in `buffer` through the filter, added to `out`; s is left there, larger than the bus by 2^h.
    pub(super) fn run<const N: usize>(
        &mut self,
        path: &Path<N>,
        lines: &mut [Line; PARAMETERS],
        buffer: &mut [i32],
        out: &mut [i32],
    ) {
        let down = (32 + path.scale).clamp(0, 63) as u32;
        let put = |word: &mut i32, out: &mut i32, s: i64| {
            *word = (s >> 32) as i32;
            *out = qadd(*out, saturate(s >> down));
        };
        let frames = buffer.iter_mut().zip(out);
        match path.form {
            Form::Real => {
                let shift = (32 + path.inner_scale + path.input_shift).clamp(0, 33) as u32;
                frames.for_each(|(word, out)| {
                    let s = self.real(lines, *word, shift);
                    put(word, out, s);
                });
            }
            _ => frames.for_each(|(word, out)| {
                let s = self.conjugate(lines, *word);
                put(word, out, s);
            }),
        }
    }

    /// `z = p z + g e'; s = Re z + d e`. |p| < 1 as Q31 and |z| < 2^62, |g| < 1 as Q31 and |e| <= 2^30: z stays below 2^62, and sums on the way to it
    /// may wrap.
    #[inline(always)]
    fn conjugate(&mut self, lines: &mut [Line; PARAMETERS], e: i32) -> i64 {
        let [p_re, p_im, g_re, g_im, d] = lines.map(|line| i64::from(line.value));
        let ([re, im], last) = (self.z, 2 * i64::from(self.last));
        self.z = [
            times(p_re, re).wrapping_sub(times(p_im, im)).wrapping_add(g_re * last),
            times(p_re, im).wrapping_add(times(p_im, re)).wrapping_add(g_im * last),
        ];
        self.last = e;
        lines.iter_mut().for_each(Line::advance);
        self.z[0].wrapping_add(2 * d * i64::from(e))
    }

    /// `z1 = p1 z1 + e'; z2 = p2 z2 + β z1'; s = d e + α z1 + z2`; α and β are Q30, states below 2^61.
    #[inline(always)]
    fn real(&mut self, lines: &mut [Line; PARAMETERS], e: i32, shift: u32) -> i64 {
        let [p1, p2, alpha, beta, d] = lines.map(|line| i64::from(line.value));
        let [z1, z2] = self.z;
        self.z = [
            times(p1, z1).wrapping_add(i64::from(self.last) << shift),
            times(p2, z2).wrapping_add(times(beta, z1).wrapping_mul(2)),
        ];
        self.last = e;
        lines.iter_mut().for_each(Line::advance);
        let ring = self.z[1].wrapping_add(times(alpha, self.z[0]).wrapping_mul(2));
        ring.wrapping_add(2 * d * i64::from(e))
    }
}

/// A Q31 factor of a state, rounded down.
#[inline(always)]
fn times(factor: i64, state: i64) -> i64 {
    ((factor * (state >> 32)) << 1) + ((factor * (state & 0xffff_ffff)) >> 31)
}
