//! The samples of a room's delay lines, and the kernels that work on them.

use super::kernel;
use super::lines::NetworkTick;
use super::storage::Stored;

/// A sample of a room's delay lines: `i16` or `i32`.
pub trait Sample: Stored + sealed::Sealed {
    /// Lets a tick pass through a network. If the tick is `busy`, true if a watched value is beyond
    /// the bits that raise the level; otherwise true if a stored value is beyond those up to which
    /// it may be lowered.
    fn network(tick: NetworkTick<'_, Self>) -> bool;

    /// Doubles all, saturated, or halves all as often as `rise` is below 0.
    fn scale(words: &mut [[Self; 2]], rise: i32);
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for i16 {}
    impl Sealed for i32 {}
}

impl Sample for i16 {
    fn network(tick: NetworkTick<'_, i16>) -> bool {
        kernel::network(tick)
    }

    fn scale(words: &mut [[i16; 2]], rise: i32) {
        kernel::scale(words, rise);
    }
}

impl Sample for i32 {
    fn network(tick: NetworkTick<'_, i32>) -> bool {
        kernel::portable::network(tick)
    }

    fn scale(words: &mut [[i32; 2]], rise: i32) {
        kernel::portable::scale(words, rise);
    }
}
