//! WeAct BlackPill STM32F411CE with a PCM5102A: 96 MHz, I2S2 without a master clock, one LED, a
//! button.

use embassy_stm32::rcc::{APBPrescaler, PllPDiv};
use embassy_stm32::{interrupt, pac};

use super::sector::Sector;
use super::wiring::Wiring;
use crate::clock::{AudioClock, ClockPlan};

/// Memory and time that the board gives its engine.
pub use boards::BlackpillF411 as Memory;

/// Clocks of the board: the core at 96 MHz, and a sample rate of exactly 48 kHz, 76.8 MHz / 1600.
///
/// A core clock of 100 MHz could be divided neither to the 48 kHz of the ADC nor to the 48 MHz of
/// USB.
pub const CLOCKS: ClockPlan = ClockPlan {
    crystal_hz: 25_000_000,
    divider: 25,
    multiplier: 384,
    core_divider: PllPDiv::DIV4,
    usb_divider: 8,
    apb1: APBPrescaler::DIV2,
    apb2: APBPrescaler::DIV1,
    audio: AudioClock { divider: 25, multiplier: 384, output_divider: 5, prescaler: 25, master_clock: false },
};

/// Peripherals of the I2S output. Stream 4 and channel 0 of DMA1 serve the transmitter of SPI2.
pub const I2S: Wiring =
    Wiring { spi: pac::SPI2, reset_bit: 14, dma: pac::DMA1, stream: 4, channel: 0, interrupt: interrupt::DMA1_STREAM4 };

/// Maximum number of strikes that begin in a half. Those of the half before are taken off, as far
/// as half of the number is left.
/// A strike at a frame of its own, or one that moves its pad, counts as several (`audio::waiting`).
/// A struck pad takes up to 12 000 cycles beside its modes, and modes alone can be shed.
pub const STRIKES_PER_TICK: usize = 3;

/// Number of the board in its MIDI identity.
pub const MIDI_NUMBER: u8 = 2;

/// Number of slots for kits.
pub const SLOTS: u8 = 1;

/// Sectors of the flash that hold kits, those of the slots first. The linker script leaves them
/// out.
///
/// An upload overwrites the kit of the only slot.
pub const KIT_SECTORS: [Sector; 1] = [Sector { number: 7, address: 0x0806_0000, bytes: 128 << 10 }];

/// Sectors of the flash that hold the settings. The linker script leaves them out.
pub const SETTINGS_SECTORS: [Sector; 2] = [
    Sector { number: 1, address: 0x0800_4000, bytes: 16 << 10 },
    Sector { number: 2, address: 0x0800_8000, bytes: 16 << 10 },
];

/// True if the converter is a codec that has a volume.
pub const HAS_CODEC: bool = false;

/// Number of LEDs of the board.
pub const LEDS: usize = 1;

/// Channels of ADC1 in the order of the piezos: PA1, PA2, PA3, PB1.
pub const PIEZO_CHANNELS: [u8; 4] = [1, 2, 3, 9];

/// Registers that all ADCs of the chip share.
pub const ADC_COMMON: pac::adccommon::AdcCommon = pac::ADC1_COMMON;

/// Mutes the output at once by XSMT low. It may be called from anywhere, whoever owns the pin.
pub fn mute() {
    pac::GPIOB.bsrr().write(|w| w.set_br(14, true));
}
