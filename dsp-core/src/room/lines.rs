//! A network's lines as the kernels meet them.

use super::dimensions::{BLOCK_FRAMES, LINES};
use super::storage::Stored;

/// What of the input each of a line's values takes, in the mean of their squares.
pub(super) const INPUT_GAIN: f64 = 0.25;
/// The first value of a pair takes this part of what the second takes, in 15 bits: tan 25°.
pub(super) const FIRST_OF_SECOND: i32 = 15_280;
/// The second takes this times `INPUT_GAIN`, so that both keep their energy: `√2 cos 25°`.
pub(super) const SECOND_GAIN: f64 = 1.281_720_7;
/// Bits of what is stored, sign included, beyond which the level is raised, and up to which it is lowered.
pub(super) const LOUD_BITS: u32 = 15;
pub(super) const QUIET_BITS: u32 = 14;

/// Where in the network's memory a line begins, or is read and written next, and how many pairs are left to its end.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(4))]
pub(super) struct Place {
    pub(super) at: u16,
    pub(super) left: u16,
}

impl Place {
    /// So many pairs (at most a line's length) further, from the line's end back to its beginning.
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

/// All that a block of a network reads and writes.
#[derive(Debug)]
pub struct NetworkTick<'a, T: Stored> {
    /// The lines, one behind another.
    pub(super) memory: &'a mut [[T; 2]],
    pub(super) lines: &'a [Place; LINES],
    pub(super) places: &'a mut [Place; LINES],
    pub(super) sound: &'a mut Sound<T>,
    /// The moving angles, how many frames each is for (a power of two, at most 16), and the fixed one.
    pub(super) turns: (&'a [T::Turn], usize, T::Turn),
    /// Whether it is watched for loud values ([`Stored::watched`]), or for values that keep the level from being lowered.
    pub(super) busy: bool,
    pub(super) input: &'a [i32],
    /// Input is taken times `2^shift · gain / 2^32`, in 2^-16 steps; the gain grows by a part of itself (Q32) a sample.
    pub(super) input_shift: u32,
    pub(super) input_gain: [i32; 2],
    pub(super) out: &'a mut [[i32; 2]],
    /// The gain of the outputs, as [`Stored::times`] has it, which loses a part of itself (Q32) a sample.
    pub(super) output_gain: [i32; 2],
    pub(super) radiation: Radiation,
}

/// What becomes of the outputs.
#[derive(Clone, Copy, Debug)]
#[repr(u32)]
pub(super) enum Radiation {
    Put = 0,
    Add = 1,
    Nothing = 2,
}
