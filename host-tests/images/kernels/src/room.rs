//! The room alone.

use core::cell::UnsafeCell;

use dsp_core::SampleRate;
use dsp_core::memory::{Memory, Word};
use dsp_core::room::Room;
use dsp_core::table::layout::RoomBandRecord;

use crate::wire::slice;

/// Number of samples in the delay lines: 48 KB.
const SAMPLES: usize = 24_576;

/// Number of words of the delay lines and of the room's state.
const WORDS: usize = SAMPLES / 4 + 1_500;

struct Global<T>(UnsafeCell<T>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl<T> Sync for Global<T> {}

static ROOM: Global<Room<'static, i16>> = Global(UnsafeCell::new(Room::none()));
static LENT: Global<[Word; WORDS]> = Global(UnsafeCell::new([Word::uninit(); WORDS]));
static USED: Global<usize> = Global(UnsafeCell::new(0));

fn room() -> &'static mut Room<'static, i16> {
    // SAFETY: see `Sync` for `Global`: this is the running call's only reference.
    unsafe { &mut *ROOM.0.get() }
}

/// Loads bands at a rate in whole Hz. -1: they cannot be played.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn room_load(bands: *const RoomBandRecord, count: usize, rate_hz: u32) -> i32 {
    // SAFETY: the host has written `count` bands there.
    let bands = unsafe { slice(bands, count) };
    let Some(rate) = SampleRate::new(rate_hz, 1) else { return -1 };
    // SAFETY: see `Sync` for `Global`; the room that had the words before is replaced.
    let (words, used) = unsafe { (&mut *LENT.0.get(), &mut *USED.0.get()) };
    let mut memory = Memory::new(words, &mut []);
    let Ok(size) = Room::<i16>::size(bands, rate, SAMPLES) else { return -1 };
    let Ok(taken) = Room::take(&mut memory, size) else { return -1 };
    *room() = taken;
    *used = memory.used().bytes();
    match room().load(bands, rate, SAMPLES) {
        Ok(()) => 0,
        Err(_) => -1,
    }
}

/// Adds the room's answer to a run of the dry sum.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn room_render(out: *mut [i32; 2], frames: usize) -> i32 {
    // SAFETY: the host has written `frames` frames there.
    let out = unsafe { core::slice::from_raw_parts_mut(out, frames) };
    room().render(out);
    0
}

/// Bytes of the room that was loaded last, its memory included.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn room_bytes() -> u32 {
    // SAFETY: see `Sync` for `Global`.
    (size_of::<Room<'static, i16>>() + unsafe { *USED.0.get() }) as u32
}
