//! The kernels for a Cortex-M4F: the assembly beside this file, with the bits of
//! [`super::portable`].
#![allow(unsafe_code)] // assembly

use core::mem::offset_of;

use super::super::chain::{CHAINS, Chain, ChainState};
use super::super::dimensions::{BLOCK_FRAMES, LINES};
use super::super::lines::{FIRST_OF_SECOND, NetworkTick, Place, Sound};
use super::super::split::{MOST_SECTIONS, SHAPED_FIRST, Split, SplitState};

core::arch::global_asm!(include_str!("network.s"), options(raw));
core::arch::global_asm!(include_str!("levels.s"), options(raw));
core::arch::global_asm!(include_str!("split.s"), options(raw));
core::arch::global_asm!(include_str!("double.s"), options(raw));
core::arch::global_asm!(include_str!("exchange.s"), options(raw));

/// Arguments of a network's tick.
#[repr(C)]
struct Call<'a> {
    memory: *mut [i16; 2],
    lines: &'a [Place; LINES],
    places: &'a mut [Place; LINES],
    /// Input; output lies 512 bytes behind.
    sound: *mut Sound<i16>,
    frames: usize,
    /// Each for a number of frames.
    turns: *const [i16; 2],
    fixed: [i16; 2],
    busy: u32,
    input: *const i32,
    input_shift: u32,
    input_gain: [i32; 2],
    out: *mut [i32; 2],
    output_gain: [i32; 2],
    /// A [`Radiation`](super::super::lines::Radiation).
    radiation: u32,
    /// Base-2 logarithm of the bytes of input for an angle.
    turn_bits: u32,
}

// Sizes and places that the assembly counts on.
const _: () = assert!(BLOCK_FRAMES == 128 && LINES == 4 && offset_of!(Sound<i16>, output) == 512);
const _: () = assert!(align_of::<Sound<i16>>() == 64 && offset_of!(Sound<i16>, input) == 0);
const _: () = assert!(size_of::<Place>() == 4 && offset_of!(Place, left) == 2 && size_of::<Call<'_>>() == 68);
const _: () = assert!(
    offset_of!(Split, sections) == 4
        && offset_of!(Split, second) == 8
        && offset_of!(SplitState, second) == 12
        && SHAPED_FIRST == 0x6800_0000
);

const _: () = assert!(FIRST_OF_SECOND == 15_280);
const _: () = assert!(size_of::<Chain>() == 12 && size_of::<ChainState>() == 16 && offset_of!(ChainState, second) == 8);

unsafe extern "C" {
    fn malleus_room_network(call: &mut Call<'_>) -> u32;
    fn malleus_room_scale(words: *mut [i16; 2], count: usize, rise: i32);
    fn malleus_room_split(
        split: &Split,
        state: &mut SplitState,
        low: *mut i32,
        high: *mut i32,
        count: usize,
        thin: bool,
    ) -> u32;
    fn malleus_room_double(
        a: &[i32; 2],
        sides: *mut [i32; 3],
        slow: *const i32,
        fast: *mut i32,
        count: usize,
        add: bool,
    );
    fn malleus_room_exchange(
        out: *mut [i32; 2],
        wet: *const [i32; 2],
        input: *mut i32,
        count: usize,
        chains: &[Chain; 2],
        states: &mut [ChainState; 2],
    ) -> u32;
}

/// Splits as [`super::portable::split`] does.
pub(in crate::room) fn split(
    split: &Split,
    state: &mut SplitState,
    low: &mut [i32],
    high: &mut [i32],
    thin: bool,
) -> u32 {
    let count = low.len().min(high.len());
    if !(1..=MOST_SECTIONS as u32).contains(&split.sections) {
        return 0;
    }
    // SAFETY: both slices hold `count` elements; there are as many sections and states as it says.
    unsafe { malleus_room_split(split, state, low.as_mut_ptr(), high.as_mut_ptr(), count, thin) }
}

/// Doubles the rate as [`super::portable::double`] does.
pub(in crate::room) fn double(
    a: &[i32; 2],
    sides: &mut [[i32; 3]; 2],
    slow: &[[i32; 2]],
    fast: &mut [[i32; 2]],
    add: bool,
) {
    let count = slow.len().min(fast.len() / 2);
    if count > 0 {
        // SAFETY: there are `count` pairs of `slow` and twice as many of `fast`; sides lie behind
        // one another.
        unsafe {
            malleus_room_double(a, sides.as_mut_ptr(), slow.as_ptr().cast(), fast.as_mut_ptr().cast(), count, add);
        }
    }
}

/// Exchanges with the bus as [`super::portable::exchange`] does.
pub(in crate::room) fn exchange(
    out: &mut [[i32; 2]],
    wet: &[[i32; 2]],
    input: &mut [i32],
    states: &mut [ChainState; 2],
) -> u32 {
    let count = out.len().min(wet.len()).min(input.len());
    // SAFETY: all slices hold `count` elements.
    unsafe { malleus_room_exchange(out.as_mut_ptr(), wet.as_ptr(), input.as_mut_ptr(), count, &CHAINS, states) }
}

/// Lets a tick pass through a network as [`super::portable::network`] does.
#[inline(always)]
pub(in crate::room) fn network(tick: NetworkTick<'_, i16>) -> bool {
    let NetworkTick { memory, lines, places, sound, turns: (turns, turn_frames, fixed), .. } = tick;
    let frames = tick.input.len();
    let [.., Place { at, left }] = *lines;
    let pairs = usize::from(at) + usize::from(left);
    if frames == 0
        || frames > tick.out.len().min(BLOCK_FRAMES)
        || pairs > memory.len()
        || !turn_frames.is_power_of_two()
        || turn_frames > 16
        || turns.len() * turn_frames < frames
    {
        return false;
    }
    let mut call = Call {
        memory: memory.as_mut_ptr(),
        lines,
        places,
        sound,
        frames,
        turns: turns.as_ptr(),
        fixed,
        busy: u32::from(tick.busy),
        input: tick.input.as_ptr(),
        input_shift: tick.input_shift,
        input_gain: tick.input_gain,
        out: tick.out.as_mut_ptr(),
        output_gain: tick.output_gain,
        radiation: tick.radiation as u32,
        turn_bits: (4 * turn_frames).trailing_zeros(),
    };
    // SAFETY: the lines lie within the memory, places within the lines (they begin there and only a
    // block moves them, back to there at a line's end; a line is at least a block long); there are
    // an input, an output and a frame of `out` a frame, and an angle for each `turn_frames`, which
    // are at most the 64 bytes on which sound lies.
    unsafe { malleus_room_network(&mut call) != 0 }
}

/// Doubles or halves all as [`super::portable::scale`] does.
pub(in crate::room) fn scale(words: &mut [[i16; 2]], rise: i32) {
    if !words.is_empty() {
        // SAFETY: there are as many words as it says.
        unsafe { malleus_room_scale(words.as_mut_ptr(), words.len(), rise) }
    }
}
