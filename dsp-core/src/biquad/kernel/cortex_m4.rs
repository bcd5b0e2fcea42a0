//! The kernel for a Cortex-M4F: `cortex_m4.s`, with the same bits as the portable kernel.
#![allow(unsafe_code)] // assembly

use core::mem::offset_of;

use super::super::pair::{Cell, Pair};
use super::parameters::{Outcome, Run};
use crate::time::TICK_FRAMES;

core::arch::global_asm!(".equ BQ_PAIR, {pair}", pair = const size_of::<Pair>());
core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

/// Arguments of the assembly, which writes its result to `used`.
#[repr(C)]
struct Call {
    pairs: *mut Pair,
    end: *mut Pair,
    frames: u32,
    input: *const i32,
    left: u32,
    right: u32,
    bits: u32,
    direct: i32,
    out: *mut i32,
    room: u32,
    odd: u32,
    used: u32,
    allowance: u32,
}

// The offsets that cortex_m4.s uses.
const _: () = {
    assert!(size_of::<Cell>() == 24 && offset_of!(Cell, v) == 4 && offset_of!(Cell, turn) == 8);
    assert!(offset_of!(Cell, damp) == 12 && offset_of!(Cell, gain_u) == 16 && offset_of!(Cell, gain_v) == 20);
    assert!(offset_of!(Pair, cells) == 0 && offset_of!(Pair, scales) == 48 && offset_of!(Pair, couple) == 56);
    assert!(offset_of!(Pair, chain) == 60 && offset_of!(Pair, low) == 64 && offset_of!(Pair, span) == 68);
    assert!(offset_of!(Pair, kind) == 72 && offset_of!(Pair, shift) == 73 && offset_of!(Pair, asks) == 74);
    assert!(offset_of!(Call, frames) == 8 && offset_of!(Call, bits) == 24 && offset_of!(Call, used) == 44);
    assert!(TICK_FRAMES == 32);
};

unsafe extern "C" {
    fn malleus_biquads(call: *mut Call) -> u32;
}

/// Runs all pairs over `out`, with the same bits as `run` of the portable kernel.
pub fn run(pairs: &mut [Pair], run: Run, input: Option<&[i32]>, out: &mut [i32]) -> Outcome {
    let frames = out.len();
    if frames == 0 || frames > TICK_FRAMES || input.is_some_and(|input| input.len() != frames) {
        return Outcome { used: 0, asks: false, refused: false };
    }
    let ends = pairs.as_mut_ptr_range();
    let mut call = Call {
        pairs: ends.start,
        end: ends.end,
        frames: frames as u32,
        input: input.map_or(core::ptr::null(), <[i32]>::as_ptr),
        left: run.left.min(31),
        right: run.right.min(31),
        bits: run.bits.min(31),
        direct: run.direct,
        out: out.as_mut_ptr(),
        room: run.room.min(31),
        odd: u32::from(run.odd),
        used: 0,
        allowance: run.allowance,
    };
    // SAFETY: the pairs and `out` are borrowed mutably for the call. The input is borrowed and as
    // long as `out`. Frames are 1 to 32, so that the assembly stays within its buffers. The
    // assembly keeps the procedure call standard and uses 500 bytes of stack.
    let answer = unsafe { malleus_biquads(&raw mut call) };
    Outcome { used: call.used, asks: answer == 1, refused: answer == 2 }
}
