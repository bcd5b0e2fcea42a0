//! A trapezoidal state-variable section (Zavalishin), what the exciter's band is made of, in plain
//! Rust: the definition of the bits.
//!
//! ```text
//! v1 = c1 - m c1 + p (g x - c2);  v2 = c2 + p c1 + n (g x - c2);  c1 = 2 v1 - c1;  c2 = 2 v2 - c2
//! ```
//!
//! What rounding down leaves of v1 and v2 is given to the next frame.

use crate::fixed::smmulr;

/// A section at work: what changes with each frame, and its multipliers. The assembly reads it in
/// this order.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Section {
    /// c1 and c2.
    pub c: [i32; 2],
    /// Remainders of v1 and v2, Q31 of a step.
    pub left: [i32; 2],
    /// -m, Q31.
    pub less_m: i32,
    /// p, Q31.
    pub p: i32,
    /// -p, Q31.
    pub less_p: i32,
    /// -n, Q31.
    pub less_n: i32,
    /// p g and n g, Q31; g is 1 where the high-pass is wanted.
    pub input: [i32; 2],
    /// k of the high-pass, Q30.
    pub k: i32,
}

/// Which of a section's responses is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// v1.
    Band,
    /// v2.
    Low,
    /// `x - k v1 - v2`.
    High,
}

/// Words through a section, in place. They are to be so small that neither a state nor what comes
/// out reaches 2^31.
pub fn section(section: &mut Section, response: Response, words: &mut [i32]) {
    for word in words {
        let x = *word;
        let (v1, v2) = section.step(x);
        *word = match response {
            Response::Band => v1,
            Response::Low => v2,
            // To every fourth step.
            Response::High => x.wrapping_sub(v2).wrapping_sub(smmulr(v1, section.k).wrapping_mul(4)),
        };
    }
}

impl Section {
    /// One that gives nothing.
    pub const NONE: Self = Self { c: [0; 2], left: [0; 2], less_m: 0, p: 0, less_p: 0, less_n: 0, input: [0; 2], k: 0 };

    /// v1 and v2.
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
