//! Bootloader of the chip's ROM, which takes an image over USB (AN2606).
//!
//! The bootloader wants the chip as a reset leaves it. So the program leaves a word in memory that
//! no start clears, and restarts; the next start finds the word and goes to the bootloader.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use cortex_m::peripheral::SCB;

use crate::{audio, board};

/// First word of the ROM: its stack, then its entry.
const ROM: u32 = 0x1FFF_0000;
/// Word by which a start knows that the bootloader is asked for.
const ASKED: u32 = 0x6466_7521;

struct Place(UnsafeCell<MaybeUninit<u32>>);

// SAFETY: `enter` writes the word before a restart, `go_if_asked` reads it once at the start.
unsafe impl Sync for Place {}

#[unsafe(link_section = ".uninit.dfu")]
static PLACE: Place = Place(UnsafeCell::new(MaybeUninit::uninit()));

/// Restarts the board in the bootloader of its ROM, muted.
pub fn enter() -> ! {
    cortex_m::interrupt::disable();
    board::mute();
    audio::i2s::silence_now();
    // SAFETY: interrupts are disabled, and only the next start reads the word.
    unsafe { PLACE.0.get().cast::<u32>().write_volatile(ASKED) };
    SCB::sys_reset()
}

/// Goes to the bootloader if the last run asked for it. It must be called first of all.
pub fn go_if_asked() {
    let place = PLACE.0.get().cast::<u32>();
    // SAFETY: all bits are a valid word; the read is volatile since a run before this one wrote it.
    if unsafe { place.read_volatile() } == ASKED {
        // SAFETY: the word belongs to this module. The ROM begins with a stack and an entry, and
        // nothing of this program runs any more.
        unsafe {
            place.write_volatile(0);
            cortex_m::asm::bootload(core::ptr::with_exposed_provenance(ROM as usize))
        }
    }
}
