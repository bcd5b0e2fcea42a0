//! The kernels for a Cortex-M4F: `cortex_m4.s`, bit for bit what [`super::portable`] does.
#![allow(unsafe_code)] // assembly

use core::mem::offset_of;

use super::super::crossover::{Split, SplitState};
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
const _: () = assert!(size_of::<Split>() == 20 && size_of::<SplitState>() == 52);

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
    fn malleus_room_radiate(
        output: *const [i16; 2],
        out: *mut [i32; 2],
        count: usize,
        gain: i32,
        loss: i32,
        add: bool,
    ) -> u32;
    fn malleus_room_split(split: &Split, state: &mut SplitState, low: *mut i32, high: *mut i32, count: usize) -> u32;
    fn malleus_room_double(
        a: &[i32; 2],
        state: &mut [i32; 3],
        slow: *const i32,
        fast: *mut i32,
        count: usize,
        add: bool,
    );
    fn malleus_room_exchange(out: *mut [i32; 2], wet: *const [i32; 2], input: *mut i32, count: usize) -> u32;
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
pub(in crate::room) fn radiate(output: &[[i16; 2]], [gain, loss]: [i32; 2], out: &mut [[i32; 2]], add: bool) -> bool {
    let count = output.len().min(out.len());
    if count == 0 {
        return false;
    }
    // SAFETY: both slices hold `count` elements.
    unsafe { malleus_room_radiate(output.as_ptr(), out.as_mut_ptr(), count, gain, loss, add) != 0 }
}

/// As [`super::portable::split`].
pub(in crate::room) fn split(split: &Split, state: &mut SplitState, low: &mut [i32], high: &mut [i32]) -> u32 {
    let count = low.len().min(high.len());
    // SAFETY: both slices hold `count` elements.
    unsafe { malleus_room_split(split, state, low.as_mut_ptr(), high.as_mut_ptr(), count) }
}

/// As [`super::portable::double`].
pub(in crate::room) fn double(
    a: &[i32; 2],
    sides: &mut [[i32; 3]; 2],
    slow: &[[i32; 2]],
    fast: &mut [[i32; 2]],
    add: bool,
) {
    let count = slow.len().min(fast.len() / 2);
    let (slow, fast) = (slow.as_ptr().cast::<i32>(), fast.as_mut_ptr().cast::<i32>());
    for (side, state) in sides.iter_mut().enumerate() {
        if count > 0 {
            // SAFETY: there are `count` pairs of `slow` and twice as many of `fast`; a side is the words of each pair at 0, or at 1.
            unsafe { malleus_room_double(a, state, slow.add(side), fast.add(side), count, add) }
        }
    }
}

/// As [`super::portable::exchange`].
pub(in crate::room) fn exchange(out: &mut [[i32; 2]], wet: &[[i32; 2]], input: &mut [i32]) -> u32 {
    let count = out.len().min(wet.len()).min(input.len());
    // SAFETY: all slices hold `count` elements.
    unsafe { malleus_room_exchange(out.as_mut_ptr(), wet.as_ptr(), input.as_mut_ptr(), count) }
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
