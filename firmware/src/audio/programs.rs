//! Program changes of MIDI: which kit is asked for.

use core::sync::atomic::{AtomicU8, Ordering};

use crate::board::SLOTS;
use crate::counters;

/// Program of the built-in kit.
const BUILT_IN: u8 = 127;
/// Mark of no program.
const NONE: u8 = u8::MAX;

/// Program that was asked for last and has not been taken.
static ASKED: AtomicU8 = AtomicU8::new(NONE);

/// Notes a program. One that has no kit here is counted as unknown.
pub(super) fn ask(program: u8) {
    match program < SLOTS || program == BUILT_IN {
        true => ASKED.store(program, Ordering::Relaxed),
        false => counters::MIDI_UNKNOWN.add(1),
    }
}

/// Takes the program that was asked for last. Returns the slot of its kit, or `None` within it for
/// the built-in kit.
pub fn take_program() -> Option<Option<u8>> {
    if ASKED.load(Ordering::Relaxed) == NONE {
        return None;
    }
    Some(Some(ASKED.swap(NONE, Ordering::Relaxed)).filter(|&program| program != BUILT_IN))
}
