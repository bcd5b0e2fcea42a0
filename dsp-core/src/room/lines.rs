//! Lines of a network as the kernels meet them.

use super::dimensions::{BLOCK_FRAMES, LINES};
use super::storage::Stored;

/// Share of the input that each of a line's values takes, in the mean of their squares.
pub(super) const INPUT_GAIN: f64 = 0.25;
/// Input of a pair's first value over that of the second, in 15 bits: tan 25°.
pub(super) const FIRST_OF_SECOND: i32 = 15_280;
/// Input of the second value over `INPUT_GAIN`, so that both keep their energy: `√2 cos 25°`.
pub(super) const SECOND_GAIN: f64 = 1.281_720_7;
/// Bits of a stored value, sign included, beyond which the level is raised, and up to which it is
/// lowered.
pub(super) const LOUD_BITS: u32 = 15;
pub(super) const QUIET_BITS: u32 = 14;

/// Place in the network's memory at which a line begins, or is read and written next, and the
/// number of pairs to its end.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(4))]
pub(super) struct Place {
    pub(super) at: u16,
    pub(super) left: u16,
}

impl Place {
    /// Place `pairs` further, at most a line's length, from the line's end back to its beginning.
    pub(super) fn after(self, pairs: u16, line: &Place) -> Self {
        match self.left.checked_sub(pairs) {
            Some(left @ 1..) => Self { at: self.at + pairs, left },
            _ => Self { at: line.at + (pairs - self.left), left: line.left - (pairs - self.left) },
        }
    }
}

/// Input and output of a network's block.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Sound<T> {
    /// In the network's units; the first of a pair is [`FIRST_OF_SECOND`] of the second.
    pub(super) input: [[T; 2]; BLOCK_FRAMES],
    /// Half the outputs, in the network's units.
    pub(super) output: [[T; 2]; BLOCK_FRAMES],
}

/// Everything that a block of a network reads and writes.
#[derive(Debug)]
pub struct NetworkTick<'a, T: Stored> {
    /// The lines, one behind another.
    pub(super) memory: &'a mut [[T; 2]],
    pub(super) lines: &'a [Place; LINES],
    pub(super) places: &'a mut [Place; LINES],
    pub(super) sound: &'a mut Sound<T>,
    /// Moving angles, the number of frames for each (a power of two, at most 16), and the fixed
    /// angle.
    pub(super) turns: (&'a [T::Turn], usize, T::Turn),
    /// True if loud values are watched for ([`Stored::watched`]); if false, values that keep the
    /// level from being lowered.
    pub(super) busy: bool,
    pub(super) input: &'a [i32],
    /// Factor `2^shift · gain / 2^32` of the input, in 2^-16 steps; the gain grows by a part of
    /// itself (Q32) a sample.
    pub(super) input_shift: u32,
    pub(super) input_gain: [i32; 2],
    pub(super) out: &'a mut [[i32; 2]],
    /// Gain of the outputs for [`Stored::times`], which loses a part of itself (Q32) a sample.
    pub(super) output_gain: [i32; 2],
    pub(super) radiation: Radiation,
}

/// Treatment of the outputs.
#[derive(Clone, Copy, Debug)]
#[repr(u32)]
pub(super) enum Radiation {
    Put = 0,
    Add = 1,
    Nothing = 2,
}
