//! Parameters of a run, and its outcome.

use crate::fixed::rounding_shift_right;

/// Largest sum of the sizes of a tick's inputs, as words.
pub const ALLOWANCE: u32 = 1 << 30;

/// Scales of a run's input and of its mix, and the bounds that the input must keep.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Exponent of the bound of each input, 0 to 31: a run with an input of 2^bits or more is
    /// refused.
    pub bits: u32,
    /// Words left of [`ALLOWANCE`]: a run whose inputs add up to more is refused.
    pub allowance: u32,
    /// Number of bits by which inputs are shifted left to become words.
    pub left: u32,
    /// Number of bits by which they are then shifted right, rounding to nearest.
    ///
    /// Rounding down would add an offset of half a word to each input. Two equal poles near 1 sum
    /// it up over thousands of frames.
    pub right: u32,
    /// Multiplier of the shifted input into the mix, Q32.
    pub direct: i32,
    /// Number of bits by which the mix is shifted left to the bus, saturating.
    pub room: u32,
    /// True if the first frame is an odd one.
    pub odd: bool,
}

impl Run {
    /// Word of an input of Q4.27: `input 2^left / 2^right`, rounded to nearest.
    #[inline(always)]
    pub fn word(&self, input: i32) -> i32 {
        rounding_shift_right(input << self.left, self.right)
    }
}

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Sum of the sizes of all inputs, as words; an input below 0 counts 1 less.
    pub used: u32,
    /// True if a pair asks to be settled.
    pub asks: bool,
    /// True if an input was too large; nothing has been done then.
    pub refused: bool,
}
