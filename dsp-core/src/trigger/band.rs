//! The band of a channel at rest.

use super::units::{COUNT, LAST_COUNT};
use crate::time::TICK_FRAMES;

/// Number of frames of which the last is measured for the noise of a channel at rest; it divides a
/// tick.
pub(super) const TAP_FRAMES: u32 = 16;
/// Largest width of a band in counts; [`sums_inside`](super::rest) relies on it.
pub(super) const WIDEST: i32 = 1023;

/// Counts between which a channel rests, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Band {
    /// Lowest count, 0 to 4095.
    pub(super) low: i32,
    /// Highest count less the lowest, 0 to 1023.
    pub(super) width: i32,
}

impl Band {
    pub(super) const NONE: Self = Self { low: 0, width: 0 };

    /// Band of a tick whose baseline begins at `level` and moves by `slope` a frame, in signal
    /// units.
    ///
    /// From its middle the band reaches `noise` and the ramp of half a tick to both sides, at most
    /// `widest` counts.
    pub(super) fn of_tick(level: i32, slope: i32, noise: i32, widest: i32) -> Self {
        let ramp = slope.wrapping_mul(TICK_FRAMES as i32 / 2);
        let middle = level.wrapping_add(ramp).wrapping_add(COUNT / 2) >> 8;
        // Rounded up to whole counts, at least one.
        let half = noise.wrapping_add(ramp.wrapping_abs()).wrapping_add(COUNT - 1) >> 8;
        let half = half.min(widest).clamp(1, WIDEST / 2);
        let bound = |count: i32| count.clamp(0, LAST_COUNT.into());
        let low = bound(middle.wrapping_sub(half));
        Self { low, width: bound(middle.wrapping_add(half)) - low }
    }

    /// True if a sample lies in the band.
    pub(super) fn holds(self, raw: u16) -> bool {
        (self.low..=self.low + self.width).contains(&i32::from(raw))
    }
}
