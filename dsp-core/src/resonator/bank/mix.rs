//! From a bank's mix to bus samples.

use crate::fixed;

/// Shift of a bank's mix to bus samples: a shift left, which undoes the mix exponent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MixShift {
    /// Number of bits.
    pub bits: u8,
    /// True if the sum of the modes' bounds exceeds half the bus (+18 dBFS), so that a sample, or
    /// its double, may have to be clipped.
    pub is_loud: bool,
}

impl MixShift {
    /// Sample of the mix on the bus.
    #[inline(always)]
    pub fn to_bus(self, sample: i32) -> i32 {
        match self.is_loud {
            true => fixed::saturating_shift_left(sample, u32::from(self.bits)),
            false => sample.wrapping_shl(u32::from(self.bits)),
        }
    }
}
