//! Start of the hardware: clocks first, then pins, I2S output and codec.

use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::{Config, Peripherals, pac};

use crate::board::CLOCKS;
use crate::faults::{self, Fault};

pub mod devices;

#[cfg(feature = "blackpill-f411")]
mod blackpill_f411;
#[cfg(feature = "blackpill-f411")]
pub use blackpill_f411::init;

#[cfg(not(feature = "blackpill-f411"))]
mod stm32f407g_disc1;
#[cfg(not(feature = "blackpill-f411"))]
pub use stm32f407g_disc1::init;

/// Starts the clocks and the flash accelerator, so that the core runs at its full speed.
///
/// [`init`] must follow.
pub fn start_clocks() -> Peripherals {
    let has_crystal = crystal_starts();
    if !has_crystal {
        faults::set(Fault::Crystal, true);
        defmt::error!("crystal: does not start; all rates are up to 1 % off, and USB may fail");
    }
    let mut config = Config::default();
    config.rcc = CLOCKS.rcc(has_crystal);
    let peripherals = embassy_stm32::init(config);
    // The library leaves its clock at the highest priority, where it would delay the sound.
    interrupt::TIM4.set_priority(Priority::P2);
    switch_flash_caches_on();
    if pac::FLASH.optcr().read().bor_lev() == BROWN_OUT_OFF {
        defmt::warn!("brown-out reset: off; set the option byte BOR_LEV, as docs/hardware.md says");
    }
    peripherals
}

/// Value of OPTCR.BOR_LEV in a new chip: it runs down to 1.8 V, at which its flash may be misread.
const BROWN_OUT_OFF: u8 = 3;

/// Switches the crystal on and returns true if it starts, which takes 2 ms.
///
/// The hardware library would wait for ever. This gives up after 0.1 s.
fn crystal_starts() -> bool {
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    (0..250).any(|_| {
        // At least 0.1 ms of the clock after a reset, and in fact 0.4 ms.
        cortex_m::asm::delay(1600);
        pac::RCC.cr().read().hserdy()
    })
}

/// Switches the caches of the flash on.
///
/// The hardware library sets the wait states alone: without the caches every jump waits for the
/// flash. Caches may be reset only while they are off. The prefetch stays off: by RM0090 section
/// 3.5.2 a line that was prefetched is not cached, so that loops of straight code would wait for
/// flash in each pass (`virtual_core::cycle::flash`).
fn switch_flash_caches_on() {
    pac::FLASH.acr().modify(|w| {
        w.set_icen(false);
        w.set_dcen(false);
    });
    pac::FLASH.acr().modify(|w| {
        w.set_icrst(true);
        w.set_dcrst(true);
    });
    pac::FLASH.acr().modify(|w| {
        w.set_icrst(false);
        w.set_dcrst(false);
    });
    pac::FLASH.acr().modify(|w| {
        w.set_icen(true);
        w.set_dcen(true);
    });
}
