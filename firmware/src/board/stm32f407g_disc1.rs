//! STM32F407G-DISC1: 168 MHz, CS43L22 codec on I2S3 and I2C1, four LEDs, a button.

use embassy_stm32::rcc::{APBPrescaler, PllPDiv};
use embassy_stm32::{interrupt, pac};

use super::sector::Sector;
use super::wiring::Wiring;
use crate::clock::{AudioClock, ClockPlan};

/// Memory and time that the board gives its engine.
pub use boards::Stm32f407gDisc1 as Memory;

/// Clocks of the board: the core at 168 MHz, and a sample rate of 86 MHz / 1792 = 47 991.07 Hz.
///
/// This rate is the nearest to 48 kHz that has a master clock for the codec.
pub const CLOCKS: ClockPlan = ClockPlan {
    crystal_hz: 8_000_000,
    divider: 8,
    multiplier: 336,
    core_divider: PllPDiv::DIV2,
    usb_divider: 7,
    apb1: APBPrescaler::DIV4,
    apb2: APBPrescaler::DIV2,
    audio: AudioClock { divider: 8, multiplier: 258, output_divider: 3, prescaler: 7, master_clock: true },
};

/// Peripherals of the I2S output. Stream 5 and channel 0 of DMA1 serve the transmitter of SPI3.
pub const I2S: Wiring =
    Wiring { spi: pac::SPI3, reset_bit: 15, dma: pac::DMA1, stream: 5, channel: 0, interrupt: interrupt::DMA1_STREAM5 };

/// Maximum number of strikes that begin in a half. Those of the half before are taken off, as far
/// as half of the number is left.
/// A strike at a frame of its own, or one that moves its pad, counts as several (`audio::waiting`).
/// A struck pad takes up to 12 000 cycles beside its modes, and modes alone can be shed.
pub const STRIKES_PER_TICK: usize = 10;

/// Number of the board in its MIDI identity.
pub const MIDI_NUMBER: u8 = 1;

/// Number of slots for kits.
pub const SLOTS: u8 = 2;

/// Sectors of the flash that hold kits, those of the slots first. The linker script leaves them
/// out.
///
/// The third sector takes an upload, so that its slot keeps the old kit until the new one is whole.
pub const KIT_SECTORS: [Sector; 3] = [
    Sector { number: 11, address: 0x080E_0000, bytes: 128 << 10 },
    Sector { number: 10, address: 0x080C_0000, bytes: 128 << 10 },
    Sector { number: 9, address: 0x080A_0000, bytes: 128 << 10 },
];

/// Sectors of the flash that hold the settings. The linker script leaves them out.
pub const SETTINGS_SECTORS: [Sector; 2] = [
    Sector { number: 1, address: 0x0800_4000, bytes: 16 << 10 },
    Sector { number: 2, address: 0x0800_8000, bytes: 16 << 10 },
];

/// True if the converter is a codec that has a volume.
pub const HAS_CODEC: bool = true;

/// Number of LEDs of the board.
pub const LEDS: usize = 4;

/// Channels of ADC1 in the order of the piezos: PA1, PA2, PA3, PB1.
pub const PIEZO_CHANNELS: [u8; 4] = [1, 2, 3, 9];

/// Registers that all ADCs of the chip share.
pub const ADC_COMMON: pac::adccommon::AdcCommon = pac::ADC123_COMMON;

/// Mutes the output at once by the codec's reset pin low. It may be called from anywhere, whoever
/// owns the pin.
pub fn mute() {
    pac::GPIOD.bsrr().write(|w| w.set_br(4, true));
}
