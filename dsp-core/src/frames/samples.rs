//! Samples of a block, from the transform of its spectrum.

use super::numbers::{HALF, window_at};
use super::{BLOCK_FRAMES, POINTS};
use crate::fourier::{self, Complex};

/// Place of a frame of a block in the transform of both sides.
#[inline(always)]
pub(super) fn place(frame: usize) -> usize {
    fourier::place((frame + POINTS - HALF) as u32, POINTS.trailing_zeros())
}

/// Place of an even frame and the odd one behind it in the transform of one bank's block.
#[inline(always)]
pub(super) fn place_of_pair(frame: usize) -> usize {
    let pair = (frame + POINTS - HALF) / 2 % BLOCK_FRAMES;
    fourier::place(pair as u32, BLOCK_FRAMES.trailing_zeros())
}

/// Both sides at a frame of a block, from the transform of their spectrum.
#[inline(always)]
pub(super) fn sample(stereo: &[Complex; POINTS], frame: usize) -> Complex {
    let window = window_at(frame);
    stereo.get(place(frame)).map_or([0.0; 2], |side| side.map(|x| x * window))
}

/// Nearest whole number, saturating.
#[inline(always)]
pub(super) fn rounded(x: f32) -> i32 {
    // `as` alone rounds to 0.
    (x + 0.5f32.copysign(x)) as i32
}
