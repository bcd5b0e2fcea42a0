//! The loops for a Cortex-M4F, in `cortex_m4.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this folder

use core::mem::offset_of;

use super::{Frames, PIECES, POWERS, Pressing, Sinking, Turning};
use crate::time::TICK_FRAMES;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// Numbers that cortex_m4.s uses.
const _: () = {
    assert!(TICK_FRAMES == 32 && PIECES == 64 && size_of_val(&POWERS) == 16 * 64);
    assert!(offset_of!(Frames, depths) == 0 && offset_of!(Frames, factors) == 128 && offset_of!(Frames, slopes) == 256);
    assert!(size_of::<Turning>() == 40 && offset_of!(Turning, half) == 8 && offset_of!(Turning, whole) == 16);
    assert!(offset_of!(Turning, rest) == 24 && offset_of!(Turning, offset) == 28 && offset_of!(Turning, rate) == 32);
    assert!(offset_of!(Sinking, rise) == 8 && offset_of!(Sinking, less) == 16 && offset_of!(Sinking, rate) == 20);
    assert!(offset_of!(Sinking, one) == 28 && offset_of!(Pressing, stiffness) == 8);
    assert!(offset_of!(Pressing, share) == 12 && offset_of!(Pressing, right) == 16);
};

unsafe extern "C" {
    fn malleus_scrape_turn(frames: *mut Frames, turning: *const Turning);
    fn malleus_scrape_sink(frames: *mut Frames, sinking: *mut Sinking);
    fn malleus_scrape_press(frames: *const Frames, force: *mut i32, pressing: *mut Pressing, powers: *const [i32; 4]);
}

/// Turns the ball as [`super::portable::turn`] does, but leaves the turn as it was.
///
/// Cost, counted from the code: 13 cycles a frame.
pub(in super::super::super) fn turn(turning: &mut Turning, frames: &mut Frames) {
    // SAFETY: all frames of a tick are there.
    unsafe { malleus_scrape_turn(frames, turning) }
}

/// Adds height and slope as [`super::portable::sink`] does.
///
/// Cost, counted from the code: 18 cycles a frame.
pub(in super::super::super) fn sink(sinking: &mut Sinking, frames: &mut Frames) {
    // SAFETY: all frames of a tick are there.
    unsafe { malleus_scrape_sink(frames, sinking) }
}

/// Adds the force as [`super::portable::press`] does.
///
/// Cost, counted from the code: 35 cycles a frame.
pub(in super::super::super) fn press(pressing: &mut Pressing, frames: &Frames, force: &mut [i32; TICK_FRAMES]) {
    // SAFETY: all frames of a tick are there, and a piece for any six bits.
    unsafe { malleus_scrape_press(frames, force.as_mut_ptr(), pressing, POWERS.as_ptr()) }
}
