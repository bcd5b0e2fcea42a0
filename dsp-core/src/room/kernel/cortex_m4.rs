//! The kernels for a Cortex-M4F: `cortex_m4.s`, bit for bit what [`super::portable`] does.
#![allow(unsafe_code)] // assembly

use core::mem::offset_of;

use super::super::network::{LINES, Lines, Sound, Turns};
use super::super::turn::TURN_SAMPLES;
use crate::resonator::TICK_FRAMES;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

/// What a pass is told.
#[repr(C)]
struct Call {
    lines: [*mut [i16; 2]; LINES],
    /// The first frame's input; its output lies 128 bytes behind.
    sound: *mut [i16; 2],
    frames: usize,
    /// Angles: the moving ones from the first frame's on, or one a line.
    turns: *const [i16; 2],
    fixed: [i16; 2],
}

// What cortex_m4.s counts on.
const _: () = assert!(TICK_FRAMES == 32 && TURN_SAMPLES == 8 && LINES == 4 && offset_of!(Sound<i16>, output) == 128);
const _: () = assert!(offset_of!(Call, sound) == 16 && offset_of!(Call, fixed) == 28);

unsafe extern "C" {
    fn malleus_room_prepare(
        input: *const i32,
        prepared: *mut [i16; 2],
        count: usize,
        shift: u32,
        gain: i32,
        growth: i32,
    );
    fn malleus_room_pass(call: &Call, first: usize) -> u32;
    fn malleus_room_pass_between(call: &Call, double: bool) -> u32;
    fn malleus_room_radiate(output: *const [i16; 2], out: *mut [i32; 2], count: usize, gain: i32, loss: i32) -> u32;
}

/// As [`super::portable::prepare`].
pub(in crate::room) fn prepare(input: &[i32], prepared: &mut [[i16; 2]], shift: u32, [gain, growth]: [i32; 2]) {
    let count = input.len().min(prepared.len());
    if count > 0 {
        // SAFETY: both slices hold `count` elements.
        unsafe { malleus_room_prepare(input.as_ptr(), prepared.as_mut_ptr(), count, shift, gain, growth) }
    }
}

/// As [`super::portable::radiate`].
pub(in crate::room) fn radiate(output: &[[i16; 2]], [gain, loss]: [i32; 2], out: &mut [[i32; 2]]) -> bool {
    let count = output.len().min(out.len());
    if count == 0 {
        return false;
    }
    // SAFETY: both slices hold `count` elements.
    unsafe { malleus_room_radiate(output.as_ptr(), out.as_mut_ptr(), count, gain, loss) != 0 }
}

/// As [`super::portable::pass`].
pub(in crate::room) fn pass(lines: Lines<'_, i16>, sound: &mut Sound<i16>, turns: &Turns<i16>, from: usize) -> bool {
    let Some(moving) = turns.moving.get(from / TURN_SAMPLES..) else { return false };
    let Some(call) = call(lines, sound, from, moving.as_ptr(), turns.fixed) else { return false };
    // SAFETY: as `call` says; frames up to 32 take no more angles than there are from the first one's on.
    unsafe { malleus_room_pass(&call, TURN_SAMPLES - from % TURN_SAMPLES) != 0 }
}

/// As [`super::portable::pass_between`].
pub(in crate::room) fn pass_between(
    lines: Lines<'_, i16>,
    sound: &mut Sound<i16>,
    turns: &[[i16; 2]; LINES],
    from: usize,
    double: bool,
) -> bool {
    let Some(call) = call(lines, sound, from, turns.as_ptr(), [0; 2]) else { return false };
    // SAFETY: as `call` says; there is an angle a line.
    unsafe { malleus_room_pass_between(&call, double) != 0 }
}

/// Lines and sound hold as many frames as it says; none where there are no frames.
fn call(
    lines: Lines<'_, i16>,
    sound: &mut Sound<i16>,
    from: usize,
    turns: *const [i16; 2],
    fixed: [i16; 2],
) -> Option<Call> {
    let frames = lines.iter().fold(TICK_FRAMES.saturating_sub(from), |frames, line| frames.min(line.len()));
    if frames == 0 {
        return None;
    }
    let sound = (&raw mut *sound).cast::<[i16; 2]>();
    // SAFETY: `from` is below the frames of the input.
    Some(Call { lines: lines.map(|line| line.as_mut_ptr()), sound: unsafe { sound.add(from) }, frames, turns, fixed })
}
