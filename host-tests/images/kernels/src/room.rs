//! The room alone.

use core::cell::UnsafeCell;

use dsp_core::SampleRate;
use dsp_core::room::Room;
use dsp_core::table::layout::RoomBandRecord;

use crate::wire::slice;

/// 48 KB.
const SAMPLES: usize = 24_576;

struct Global(UnsafeCell<Room<i16, SAMPLES>>);

// SAFETY: the virtual core has one thread and calls one function at a time.
unsafe impl Sync for Global {}

static ROOM: Global = Global(UnsafeCell::new(Room::new()));

fn room() -> &'static mut Room<i16, SAMPLES> {
    // SAFETY: as for `Sync`: the one reference of the call that runs.
    unsafe { &mut *ROOM.0.get() }
}

/// Loads bands at a rate in whole Hz. -1: they cannot be played.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn room_load(bands: *const RoomBandRecord, count: usize, rate_hz: u32) -> i32 {
    // SAFETY: the host's word.
    let bands = unsafe { slice(bands, count) };
    let Some(rate) = SampleRate::new(rate_hz, 1) else { return -1 };
    match room().load(bands, rate) {
        Ok(()) => 0,
        Err(_) => -1,
    }
}

/// Adds the room's answer to a run of the dry sum.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn room_render(out: *mut [i32; 2], frames: usize) -> i32 {
    // SAFETY: the host's word.
    let out = unsafe { core::slice::from_raw_parts_mut(out, frames) };
    room().render(out);
    0
}

/// Bytes of the whole room.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub extern "C" fn room_bytes() -> u32 {
    size_of::<Room<i16, SAMPLES>>() as u32
}
