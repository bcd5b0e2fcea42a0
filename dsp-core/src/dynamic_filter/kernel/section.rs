//! A trapezoidal state-variable section (Zavalishin) in plain Rust: the definition of the bits. The
//! exciter's band consists of two.
//!
//! ```text
//! v1 = c1 - m c1 + p (g x - c2);  v2 = c2 + p c1 + n (g x - c2);  c1 = 2 v1 - c1;  c2 = 2 v2 - c2
//! ```
//!
//! v1 and v2 are rounded down, and their remainders are added in the next frame.

use crate::fixed::smmulr;

/// A section at work: states that change with each frame, and multipliers. The assembly reads the
/// fields in this order.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Section {
    /// States c1 and c2.
    pub c: [i32; 2],
    /// Remainders of v1 and v2, Q31 of a step.
    pub left: [i32; 2],
    /// Multiplier -m, Q31.
    pub less_m: i32,
    /// Multiplier p, Q31.
    pub p: i32,
    /// Multiplier -p, Q31.
    pub less_p: i32,
    /// Multiplier -n, Q31.
    pub less_n: i32,
    /// Multipliers p g and n g of the input, Q31. The gain g is 1 for the high-pass.
    pub input: [i32; 2],
    /// Multiplier k of the high-pass, Q30.
    pub k: i32,
}

/// Response of a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// Band-pass: v1.
    Band,
    /// Low-pass: v2.
    Low,
    /// High-pass: `x - k v1 - v2`.
    High,
}

/// Runs words through a section, in place. The words must be so small that neither the states nor
/// the output reach 2^31.
pub fn section(section: &mut Section, response: Response, words: &mut [i32]) {
    for word in words {
        let x = *word;
        let (v1, v2) = section.step(x);
        *word = match response {
            Response::Band => v1,
            Response::Low => v2,
            // The product k v1 is rounded to a multiple of four steps.
            Response::High => x.wrapping_sub(v2).wrapping_sub(smmulr(v1, section.k).wrapping_mul(4)),
        };
    }
}

impl Section {
    /// A section that is silent.
    pub const NONE: Self = Self { c: [0; 2], left: [0; 2], less_m: 0, p: 0, less_p: 0, less_n: 0, input: [0; 2], k: 0 };

    /// Computes v1 and v2 of a frame.
    #[inline(always)]
    fn step(&mut self, x: i32) -> (i32, i32) {
        let [c1, c2] = self.c;
        let [of_v1, of_v2] = [[self.input[0], self.less_p, self.less_m], [self.input[1], self.less_n, self.p]]
            .map(|by| by.iter().zip([x, c2, c1]).map(|(&by, word)| i64::from(by) * i64::from(word)).sum::<i64>());
        let (sum1, sum2) = (of_v1 + i64::from(self.left[0]), of_v2 + i64::from(self.left[1]));
        self.left = [sum1, sum2].map(|sum| (sum & 0x7fff_ffff) as i32);
        let (v1, v2) = (c1.wrapping_add((sum1 >> 31) as i32), c2.wrapping_add((sum2 >> 31) as i32));
        self.c = [v1.wrapping_mul(2).wrapping_sub(c1), v2.wrapping_mul(2).wrapping_sub(c2)];
        (v1, v2)
    }
}
