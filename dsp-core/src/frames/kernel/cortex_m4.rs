//! The kernels for a Cortex-M4F: `cortex_m4.s` and `head.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this folder

use core::mem::offset_of;

use super::super::mode::{FrameMode, Line};
use super::super::numbers::WINDOW;
use super::super::{BLOCK_FRAMES, LINES, PADDED_LINES, POINTS, WIDTH};
use super::{Convolution, OUTPUTS, SAMPLES};
use crate::fourier::Complex;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));
core::arch::global_asm!(include_str!("head.s"), options(raw));

// The offsets that cortex_m4.s uses.
const _: () = {
    assert!(size_of::<FrameMode>() == 84 && size_of::<Line>() == 4);
    assert!(OUTPUTS == 3 && SAMPLES == 4 && size_of::<HeadRun>() == 44);
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
    fn malleus_frames_synthesize(
        modes: *mut FrameMode,
        lines: *const Line,
        count: usize,
        spectrum: *mut Complex,
        end: *const FrameMode,
    );
    fn malleus_frames_gather(
        modes: *mut FrameMode,
        lines: *const Line,
        count: usize,
        spectrum: *const Complex,
        end: *const FrameMode,
    );
    fn malleus_frames_convolve(run: *const HeadRun);
    fn malleus_frames_unwindow(lines: *const Complex, out: *mut Complex, count: usize, numbers: *const f32);
}

/// Adds modes to a spectrum as [`super::portable::synthesize`] does.
///
/// Cost, counted from the code: 102 cycles a mode, 34 to 47 a line with ringing modes. Whole banks:
/// `cargo test -p host-tests --test on_chip frames -- --nocapture`.
pub fn synthesize(modes: &mut [FrameMode], lines: &[Line], first: usize, spectrum: &mut [Complex; PADDED_LINES]) {
    if first + lines.len() > LINES {
        return;
    }
    let Some(from) = spectrum.get_mut(first..) else { return };
    let modes = modes.as_mut_ptr_range();
    // SAFETY: it ends at a line whose modes are not all there, or of which more ring; each line has
    // seven places from its own on.
    unsafe { malleus_frames_synthesize(modes.start, lines.as_ptr(), lines.len(), from.as_mut_ptr(), modes.end) }
}

/// Adds a force to the states of modes as [`super::portable::gather`] does.
///
/// Cost, counted from the code: 94 cycles a mode, 29 a line.
pub fn gather(modes: &mut [FrameMode], lines: &[Line], first: usize, spectrum: &[Complex; PADDED_LINES]) {
    if first + lines.len() > LINES {
        return;
    }
    let Some(from) = spectrum.get(first..) else { return };
    let modes = modes.as_mut_ptr_range();
    // SAFETY: as for `synthesize`.
    unsafe { malleus_frames_gather(modes.start, lines.as_ptr(), lines.len(), from.as_ptr(), modes.end) }
}

/// A run of a head, as head.s takes it.
#[repr(C)]
struct HeadRun {
    force: *const i32,
    /// Tap of the last frame before the run, for sample 0 of the force.
    taps: *const i32,
    ranges: *const [u16; 2],
    ranges_end: *const [u16; 2],
    frame: usize,
    out: *mut i32,
    count: usize,
    right_shift: u32,
    doublings: u32,
    half: [u32; 2],
}

/// Adds a head's outputs as [`super::portable::convolve`] does.
///
/// Cost, counted from the code: 1.8 cycles for each product of a sample and a tap; 11 a frame for
/// each range and 24 beside them.
#[inline(always)]
pub fn convolve(head: &Convolution<'_>, frame: usize, out: &mut [i32]) {
    let is_whole = |&[first, end]: &[u16; 2]| {
        usize::from(end) <= POINTS && (usize::from(first) | usize::from(end)).is_multiple_of(SAMPLES)
    };
    if out.is_empty() || frame + out.len() > POINTS || head.ranges.is_empty() || !head.ranges.iter().all(is_whole) {
        return;
    }
    let half = head.half() as u64;
    let ranges = head.ranges.as_ptr_range();
    let run = HeadRun {
        force: head.force.as_ptr(),
        taps: head.taps.as_ptr().wrapping_add(POINTS - 1),
        ranges: ranges.start,
        ranges_end: ranges.end,
        frame,
        out: out.as_mut_ptr(),
        count: out.len(),
        right_shift: head.exponent.max(0) as u32,
        doublings: (-head.exponent).clamp(0, 31) as u32,
        half: [half as u32, (half >> 32) as u32],
    };
    // SAFETY: the ranges lie in the force; the zeros around the taps reach as far as three outputs
    // and whole steps of force take them; there is a place for each output.
    unsafe { malleus_frames_convolve(&run) }
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
