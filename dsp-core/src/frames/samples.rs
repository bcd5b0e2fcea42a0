//! Samples of a block, from the transform of its spectrum.

use super::POINTS;
use super::numbers::{HALF, window_at};
use crate::fourier::{self, Complex};

/// Place of a frame of a block in the transform of both sides.
#[inline(always)]
pub(super) fn place(frame: usize) -> usize {
    fourier::place((frame + POINTS - HALF) as u32, POINTS.trailing_zeros())
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
