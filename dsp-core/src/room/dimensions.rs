//! Dimensions that the whole room shares.

use crate::table::range;
use crate::time::TICK_FRAMES;

/// Maximum number of bands of a room.
pub const MAX_BANDS: usize = range::ROOM_BANDS;
/// Number of lines of a network; each holds pairs.
pub(super) const LINES: usize = 4;
/// Longest delay of a line, in blocks.
pub(super) const MAX_BLOCKS: usize = 47;
/// Largest division of the rate.
pub(super) const SLOWEST: usize = 32;
/// Ticks of a block.
pub(super) const TICKS: usize = 4;
/// Frames that are worked on together, a part of the work at each tick: a quarter of the beginnings
/// and ends of loops.
pub(super) const BLOCK_FRAMES: usize = TICKS * TICK_FRAMES;
/// Number of rates: 1, 1/2 ... 1/32.
pub(super) const RATES: usize = SLOWEST.ilog2() as usize + 1;
