//! The kernels for a Cortex-M4F: `cortex_m4.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this folder

use core::mem::offset_of;

use super::super::mode::{FrameMode, Line};
use super::super::numbers::WINDOW;
use super::super::{BLOCK_FRAMES, LINES, PADDED_LINES, POINTS, WIDTH};
use super::OUTPUTS;
use crate::fourier::Complex;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// The offsets that cortex_m4.s uses.
const _: () = {
    assert!(size_of::<FrameMode>() == 84 && size_of::<Line>() == 4 && OUTPUTS == 3);
    assert!(offset_of!(FrameMode, numbers) == 8 && offset_of!(FrameMode, step) == 64);
    assert!(offset_of!(FrameMode, step_rest) == 72 && offset_of!(FrameMode, gain) == 76);
    assert!(POINTS == 512 && WINDOW.len() == 129);
    assert!(offset_of!(Line, count) == 0 && offset_of!(Line, ringing) == 2);
};

unsafe extern "C" {
    fn malleus_frames_play(stereo: *const Complex, window: *const f32, first: usize, out: *mut [i32; 2], count: usize);
    fn malleus_frames_play_lone(
        block: *const Complex,
        window: *const f32,
        first: usize,
        out: *mut [i32; 2],
        count: usize,
        gains: *const f32,
    );
    fn malleus_frames_synthesize(modes: *mut FrameMode, lines: *const Line, count: usize, spectrum: *mut Complex);
    fn malleus_frames_gather(modes: *mut FrameMode, lines: *const Line, count: usize, spectrum: *const Complex);
    fn malleus_frames_convolve(force: *const i32, taps: *const i32, count: usize, sums: *mut i64);
    fn malleus_frames_unwindow(lines: *const Complex, out: *mut Complex, count: usize, numbers: *const f32);
}

/// True if the modes of the lines are all there, and the lines in the spectrum.
fn fits(modes: &[FrameMode], lines: &[Line], first: usize) -> bool {
    let (mut count, mut is_valid) = (0usize, true);
    for line in lines {
        count += usize::from(line.count);
        is_valid &= line.ringing <= line.count;
    }
    is_valid && count <= modes.len() && first + lines.len() <= LINES
}

/// Adds modes to a spectrum as [`super::portable::synthesize`] does.
///
/// Cost, counted from the code: 102 cycles a mode, 31 to 44 a line with ringing modes. Whole banks:
/// `cargo test -p host-tests --test on_chip frames -- --nocapture`.
pub fn synthesize(modes: &mut [FrameMode], lines: &[Line], first: usize, spectrum: &mut [Complex; PADDED_LINES]) {
    if !fits(modes, lines, first) {
        return;
    }
    let Some(from) = spectrum.get_mut(first..) else { return };
    // SAFETY: there are as many modes as the lines count, no more ring, and each line has seven
    // places from its own on: `fits`.
    unsafe { malleus_frames_synthesize(modes.as_mut_ptr(), lines.as_ptr(), lines.len(), from.as_mut_ptr()) }
}

/// Adds a force to the states of modes as [`super::portable::gather`] does.
///
/// Cost, counted from the code: 94 cycles a mode, 25 a line.
pub fn gather(modes: &mut [FrameMode], lines: &[Line], first: usize, spectrum: &[Complex; PADDED_LINES]) {
    if !fits(modes, lines, first) {
        return;
    }
    let Some(from) = spectrum.get(first..) else { return };
    // SAFETY: as for `synthesize`.
    unsafe { malleus_frames_gather(modes.as_mut_ptr(), lines.as_ptr(), lines.len(), from.as_ptr()) }
}

/// Adds to three outputs of a head as [`super::portable::convolve`] does.
///
/// Cost, counted from the code: 2.0 cycles for each product of a sample and a tap.
#[inline(always)]
pub fn convolve(force: &[i32], taps: &[i32], sums: &mut [i64; OUTPUTS]) {
    if taps.len() >= force.len() + OUTPUTS - 1 {
        // SAFETY: the taps are longer than the force by two; there is a place for each sum.
        unsafe { malleus_frames_convolve(force.as_ptr(), taps.as_ptr(), force.len(), sums.as_mut_ptr()) }
    }
}

/// Takes the window away from lines of a force as [`super::portable::unwindow`] does.
///
/// Cost, counted from the code: 28 cycles a line.
pub fn unwindow(lines: &[Complex], numbers: &[f32; WIDTH / 2 + 1], out: &mut [Complex]) {
    if !out.is_empty() && lines.len() >= out.len() + WIDTH - 1 {
        // SAFETY: each line that is made has seven from its own on; at least one is made.
        unsafe { malleus_frames_unwindow(lines.as_ptr(), out.as_mut_ptr(), out.len(), numbers.as_ptr()) }
    }
}

/// Adds frames of a block to the stereo bus as [`super::portable::play`] does.
///
/// Cost, counted from the code: 45 cycles a frame.
pub fn play(stereo: &[Complex; POINTS], first: usize, out: &mut [[i32; 2]]) {
    if out.is_empty() || first + out.len() > BLOCK_FRAMES {
        return;
    }
    // SAFETY: all frames lie in the block, and so within N/2 of its middle, where the window ends.
    unsafe { malleus_frames_play(stereo.as_ptr(), WINDOW.as_ptr(), first, out.as_mut_ptr(), out.len()) }
}

/// Adds frames of a block of one bank to the stereo bus as [`super::portable::play_lone`] does.
///
/// Cost, counted from the code: 48 cycles a frame.
pub fn play_lone(block: &[Complex; BLOCK_FRAMES], gains: &[f32; 2], first: usize, out: &mut [[i32; 2]]) {
    if out.is_empty() || first + out.len() > BLOCK_FRAMES {
        return;
    }
    let (block, gains) = (block.as_ptr(), gains.as_ptr());
    // SAFETY: all frames lie in the block, and so within N/2 of its middle, where the window ends;
    // there are two gains.
    unsafe { malleus_frames_play_lone(block, WINDOW.as_ptr(), first, out.as_mut_ptr(), out.len(), gains) }
}
