//! The hot loops: of the first order, noise and filter at once, noise alone, or a filter of what
//! lies in a buffer or of a sum of noise and loops; the second order; and the exciter's sections.
//!
//! [`portable`], [`mod@two_poles`] and [`mod@section`] are the definition of the bits; on a
//! Cortex-M4F the same is done by assembly (`cortex_m4*.s`), compared bit for bit on the virtual
//! core (`cargo test -p host-tests --test on_chip filters`).

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

/// Variant of [`from_sums`], chosen on load.
#[derive(Clone, Copy, Debug)]
pub struct SumsKind(u8);

impl SumsKind {
    /// For a filter: `equal` where b1 = b0, `coarse` where a sum's steps are large.
    pub const fn new(filter: &OnePole, equal: bool, coarse: bool) -> Self {
        let distance = (filter.shift < 0) as u8 + filter.is_far() as u8;
        Self(distance + 3 * coarse as u8 + 6 * !equal as u8 + 12 * filter.whole as u8)
    }

    const fn is_equal(self) -> bool {
        self.0 % 12 < 6
    }

    /// True if a sum's steps are large.
    #[inline(always)]
    pub const fn is_coarse(self) -> bool {
        self.0 % 6 >= 3
    }
}

/// A first-order filter at work: what changes with each frame. The assembly reads it in this order.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct OnePole {
    /// S, 2^(59 + h) times s, and half a step of what damping takes of it ([`rest`](Self::rest)),
    /// so that taking it rounds to nearest. Its high word is larger than the bus by 2^h.
    pub state: i64,
    /// e of the frame before, Q(27 - q).
    pub last: i32,
    /// Generator of the noise.
    pub noise: White,
    /// Its level: e is Q(27 - q), and 2^(28 - q) is 1.0.
    pub level: i32,
    /// h.
    pub shift: i32,
    /// -(1 + a1) as Q30, b0 and b1 as Q(32 + h + q); the others serve the second order.
    pub lines: [Line; PARAMETERS],
    /// The most by which an input changes the state's high word in a frame.
    pub growth: u32,
    /// True if damping takes all bits of the state: what rounding leaves would grow too much near
    /// -1.
    pub whole: bool,
}

impl OnePole {
    /// True if a step of the state's high word would be 8 steps of the bus or more: then two bits
    /// below it count too, for a cycle a frame.
    #[inline(always)]
    pub const fn is_far(&self) -> bool {
        self.shift <= -3
    }

    /// The state of nothing.
    pub const fn rest(&self) -> i64 {
        match (self.whole, self.is_far()) {
            (true, _) => 0,
            (false, true) => 1 << 29,
            (false, false) => 1 << 31,
        }
    }

    /// At rest.
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
