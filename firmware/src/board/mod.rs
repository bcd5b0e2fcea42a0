//! The boards: clocks, pins, codec. One is chosen by a feature; the rest of the firmware knows only what stands in this module.

use embassy_stm32::gpio::{Flex, Output};
use embassy_stm32::{Config, Peripherals, pac};

use crate::audio::i2s::I2s;
use crate::codec;
use crate::input::Button;

#[cfg(feature = "blackpill-f411")]
mod blackpill_f411;
#[cfg(feature = "blackpill-f411")]
pub use blackpill_f411::*;

#[cfg(not(feature = "blackpill-f411"))]
mod stm32f407g_disc1;
#[cfg(not(feature = "blackpill-f411"))]
pub use stm32f407g_disc1::*;

/// As the project calls it.
pub const NAME: &str = <Memory as boards::Board>::NAME;

// What the PC plays as this board (`malleus play --board`) is at this rate.
const _: () = {
    let ((a, b), (c, d)) = (CLOCKS.sample_rate_ratio(), <Memory as boards::Board>::RATE);
    assert!(a as u64 * d as u64 == c as u64 * b as u64, "boards/src and CLOCKS name different rates");
    assert!(CLOCKS.core_hz() == <Memory as boards::Board>::CORE_HZ, "boards/src and CLOCKS name different clocks");
};

/// What the application is given of the board.
pub struct Board {
    /// Running, silent.
    pub i2s: I2s,
    /// The board's button.
    pub button: Button,
    /// The meter, from soft to loud.
    pub leds: [Output<'static>; LEDS],
    /// Whether a high level lights a LED.
    pub leds_light_high: bool,
    /// Whether the codec answers; `Ok` where it has no bus.
    pub codec: Result<(), codec::Error>,
    /// The piezos' pins, analog: held so that nobody else takes them.
    pub piezos: [Flex<'static>; PIEZO_CHANNELS.len()],
}

/// Clocks and flash accelerator: from here on the core runs at its full speed. [`init`] must follow: pins, stream and codec.
pub fn start_clocks() -> Peripherals {
    let mut config = Config::default();
    config.rcc = CLOCKS.rcc();
    let peripherals = embassy_stm32::init(config);
    switch_flash_accelerator_on();
    peripherals
}

/// The hardware library sets the wait states and leaves prefetch and caches off: without them every jump waits for the flash. Caches may be reset
/// only while they are off.
fn switch_flash_accelerator_on() {
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
        w.set_prften(true);
        w.set_icen(true);
        w.set_dcen(true);
    });
}
