//! Flash of the chip: erase of a sector, program of words (RM0090 section 3.6, RM0383 section 3.6).
//!
//! The driver of the hardware library is not used. It erases 8 bits at a time, which takes twice as
//! long (4 s for 128 KB), and leaves old words in the data cache.

use core::sync::atomic::{Ordering, compiler_fence};

use embassy_stm32::pac::FLASH;
use embassy_stm32::pac::flash::vals::Psize;

use crate::audio;
use crate::board::sector::Sector;

/// Words that unlock the control register.
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
/// Number of frames that must be left to the next interrupt of the sound when a word is programmed:
/// 100 us by the data sheet, and 25 us for an interrupt of USB that comes first.
const GAP_FRAMES: usize = 6;
/// Width of an operation, for supplies of 2.7 V and more.
const WIDTH: Psize = Psize::PSIZE32;

/// Operation that failed: the flash reports an error, or reads back otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub struct FlashError {
    /// Address of the word or of the sector.
    pub address: u32,
}

/// Controller of the flash. There is one.
pub struct Flash(());

/// Controller that is unlocked, until it is dropped.
struct Unlocked;

impl Unlocked {
    fn new() -> Self {
        if FLASH.cr().read().lock() {
            KEYS.into_iter().for_each(|key| FLASH.keyr().write_value(key));
        }
        // Errors of before stay until each is written as 1.
        FLASH.sr().modify(|_| {});
        Self
    }
}

impl Drop for Unlocked {
    fn drop(&mut self) {
        FLASH.cr().write(|w| w.set_lock(true));
        forget_read_words();
    }
}

impl Flash {
    /// Takes the controller.
    ///
    /// # Safety
    /// This is called once.
    pub unsafe fn take_over() -> Self {
        Self(())
    }

    /// Erases a sector and looks whether all of it is erased. The core stands still meanwhile: 0.25
    /// to 0.5 s for 16 KB, 1 to 2 s for 128 KB by the data sheets.
    ///
    /// # Errors
    /// [`FlashError`] with the address of the sector.
    pub fn erase(&mut self, sector: Sector) -> Result<(), FlashError> {
        {
            let _unlocked = Unlocked::new();
            FLASH.cr().write(|w| {
                w.set_ser(true);
                w.set_snb(sector.number);
                w.set_psize(WIDTH);
            });
            FLASH.cr().modify(|w| w.set_strt(true));
            while FLASH.sr().read().bsy() {}
        }
        let words = sector.address..sector.address + sector.bytes;
        match words.step_by(4).all(|address| read(address) == u32::MAX) {
            true => Ok(()),
            false => Err(FlashError { address: sector.address }),
        }
    }

    /// Programs the words of `bytes` from a multiple of 4 on, and compares what it then reads. Ones
    /// fill the last word.
    ///
    /// Each word waits for a gap between two interrupts of the sound.
    ///
    /// # Errors
    /// [`FlashError`] with the address of the first word that is not as it should be.
    pub fn program(&mut self, address: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let words = || (address..).step_by(4).zip(bytes.chunks(4).map(word));
        {
            let _unlocked = Unlocked::new();
            FLASH.cr().write(|w| {
                w.set_pg(true);
                w.set_psize(WIDTH);
            });
            for (address, word) in words() {
                audio::wait_for_gap(GAP_FRAMES);
                // SAFETY: callers name words of the boards' sectors for kits and settings, of which
                // nobody holds a reference.
                unsafe { core::ptr::with_exposed_provenance_mut::<u32>(address as usize).write_volatile(word) };
                while FLASH.sr().read().bsy() {}
            }
        }
        match words().find(|&(address, word)| read(address) != word) {
            Some((address, _)) => Err(FlashError { address }),
            None => Ok(()),
        }
    }
}

/// Returns up to four bytes as a word; ones fill it.
fn word(bytes: &[u8]) -> u32 {
    let mut word = [0xFF; 4];
    for (to, &from) in word.iter_mut().zip(bytes) {
        *to = from;
    }
    u32::from_le_bytes(word)
}

/// Reads a word of the flash.
fn read(address: u32) -> u32 {
    // SAFETY: callers name words of the flash.
    unsafe { core::ptr::with_exposed_provenance::<u32>(address as usize).read_volatile() }
}

/// Empties the data cache, which may hold words as they were before they were written.
fn forget_read_words() {
    let was_on = FLASH.acr().read().dcen();
    FLASH.acr().modify(|w| w.set_dcen(false));
    FLASH.acr().modify(|w| w.set_dcrst(true));
    FLASH.acr().modify(|w| w.set_dcrst(false));
    FLASH.acr().modify(|w| w.set_dcen(was_on));
    compiler_fence(Ordering::SeqCst);
}
