//! The hot loops of the dynamic filter.
//!
//! The first order has four: noise and filter at once, noise alone, a filter of a buffer, and a
//! filter of sums of noise and loops. The second order and the exciter's section have one each.
//!
//! [`portable`], [`mod@two_poles`] and [`mod@section`] define the bits. A Cortex-M4F runs assembly
//! instead (`cortex_m4*.s`). A test on the virtual core compares the two bit for bit
//! (`cargo test -p host-tests --test on_chip filters`).

pub mod portable;
pub mod section;
pub mod two_poles;

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub use cortex_m4::{from_buffer, from_noise, from_sums, noise, section, two_poles};
#[cfg(not(cortex_m4f))]
pub use portable::{from_buffer, from_noise, from_sums, noise};
#[cfg(not(cortex_m4f))]
pub use section::section;
#[cfg(not(cortex_m4f))]
pub use two_poles::two_poles;

use super::path::PARAMETERS;
use super::walk::Line;
use crate::noise::White;
use crate::waveguide::COARSE_BITS;

/// Variant of [`from_sums`], which is chosen on load.
#[derive(Clone, Copy, Debug)]
pub struct SumsKind(u8);

impl SumsKind {
    /// Chooses the variant for a filter. `equal` is true if b1 = b0, `coarse` if a sum's steps are
    /// large ([`COARSE_BITS`]).
    pub const fn new(filter: &OnePole, equal: bool, coarse: bool) -> Self {
        let distance = (filter.shift < 0) as u8 + filter.is_far() as u8;
        Self(distance + 3 * coarse as u8 + 6 * !equal as u8 + 12 * filter.whole as u8)
    }

    const fn is_equal(self) -> bool {
        self.0 % 12 < 6
    }

    /// True if a sum's steps are large ([`COARSE_BITS`]).
    #[inline(always)]
    pub const fn is_coarse(self) -> bool {
        self.0 % 6 >= 3
    }
}

/// A first-order filter at work, with all that changes in each frame. The assembly reads the fields
/// in this order.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct OnePole {
    /// State S: 2^(59 + h) times s, plus half a step of the word that damping multiplies
    /// ([`rest`](Self::rest)), so that this word is rounded to nearest. The state's high word is
    /// larger than the bus by 2^h.
    pub state: i64,
    /// Input e of the frame before, Q(27 - q).
    pub last: i32,
    /// Generator of the noise.
    pub noise: White,
    /// Level of the noise, of which 2^(28 - q) is 1.0. The noise e is Q(27 - q).
    pub level: i32,
    /// Scale h of the state.
    pub shift: i32,
    /// Parameters: -(1 + a1) as Q30, b0 and b1 as Q(32 + h + q). The others serve the second order.
    pub lines: [Line; PARAMETERS],
    /// Largest change of the state's high word by the input in a frame.
    pub growth: u32,
    /// True if damping multiplies all bits of the state, because rounding errors would grow too
    /// much with a pole near -1.
    pub whole: bool,
}

impl OnePole {
    /// True if a step of the state's high word is 8 steps of the bus or more. Damping then
    /// multiplies two bits below that word too, which costs a cycle a frame.
    #[inline(always)]
    pub const fn is_far(&self) -> bool {
        self.shift <= -3
    }

    /// State at rest: half a step for rounding, or 0 if damping multiplies all bits.
    pub const fn rest(&self) -> i64 {
        match (self.whole, self.is_far()) {
            (true, _) => 0,
            (false, true) => 1 << 29,
            (false, false) => 1 << 31,
        }
    }

    /// A filter at rest.
    pub const REST: Self = Self {
        state: 1 << 31,
        last: 0,
        noise: White::new(0, 0),
        level: 0,
        shift: 0,
        lines: [Line { value: 0, step: 0 }; PARAMETERS],
        growth: 0,
        whole: false,
    };
}
