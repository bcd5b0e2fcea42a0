//! Dimensions that the whole room shares.

use crate::table::range;
use crate::time::TICK_FRAMES;

/// Bands that a room may have.
pub const MAX_BANDS: usize = range::ROOM_BANDS;
/// Lines of a network; each holds pairs.
pub(super) const LINES: usize = 4;
/// Longest delay of a line, in blocks.
pub(super) const MAX_BLOCKS: usize = 47;

/// Of more bands none is slower than this.
pub(super) const SLOWEST: usize = 32;
/// Frames that are worked on together, a part of the work at each of its ticks: a quarter of the beginnings and ends.
pub(super) const BLOCK_FRAMES: usize = TICKS * TICK_FRAMES;
pub(super) const TICKS: usize = 4;
/// Rates: 1, 1/2 ... 1/32.
pub(super) const RATES: usize = SLOWEST.ilog2() as usize + 1;
