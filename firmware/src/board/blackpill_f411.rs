//! WeAct BlackPill STM32F411CE with a PCM5102A: 96 MHz, I2S2 without a master clock, one LED, a button.

use embassy_stm32::exti::{ExtiInput, TriggerEdge};
use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::rcc::{APBPrescaler, PllPDiv};
use embassy_stm32::{Peripherals, interrupt, pac, peripherals};

use super::Board;
use crate::audio::i2s::{I2s, Wiring};
use crate::clock::{AudioClock, ClockPlan};
use crate::input::Button;

/// What its engine has memory and time for.
pub use boards::BlackpillF411 as Memory;

/// 96 MHz (100 MHz divides neither to the ADC's 48 kHz nor to USB's 48 MHz); 76.8 MHz / 1600 = exactly 48 kHz.
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

/// The I2S output and its DMA stream (stream 4 and channel 0 serve SPI2's transmitter).
pub const I2S: Wiring =
    Wiring { spi: pac::SPI2, dma: pac::DMA1, stream: 4, channel: 0, interrupt: interrupt::DMA1_STREAM4 };

/// LEDs of this board.
pub const LEDS: usize = 1;

/// ADC1's inputs in the order of the piezos: PA1, PA2, PA3, PB1.
pub const PIEZO_CHANNELS: [u8; 4] = [1, 2, 3, 9];

/// The settings that ADCs share.
pub const ADC_COMMON: pac::adccommon::AdcCommon = pac::ADC1_COMMON;

/// Sets up the pins.
pub fn init(p: Peripherals) -> Board {
    let mut piezos = [Flex::new(p.PA1), Flex::new(p.PA2), Flex::new(p.PA3), Flex::new(p.PB1)];
    piezos.iter_mut().for_each(Flex::set_as_analog);

    // Alternate function 5 is SPI2/I2S2: WS, CK, SD.
    let mut pins = [Flex::new(p.PB12), Flex::new(p.PB13), Flex::new(p.PB15)];
    for pin in &mut pins {
        pin.set_as_af_unchecked(5, AfType::output(OutputType::PushPull, Speed::High));
    }
    core::mem::forget(pins);
    embassy_stm32::rcc::enable_and_reset::<peripherals::SPI2>();

    // XSMT: the PCM5102A is mute while it is low. It has no bus, so there is nothing that could fail to answer.
    core::mem::forget(Output::new(p.PB14, Level::High, Speed::Low));
    let mut i2s = I2s::set_up();
    i2s.start();
    Board {
        i2s,
        button: Button {
            pin: ExtiInput::new_blocking(p.PA0, p.EXTI0, Pull::Up, TriggerEdge::Falling),
            pressed_is_high: false,
        },
        leds: [Output::new(p.PC13, Level::High, Speed::Low)],
        leds_light_high: false,
        codec: Ok(()),
        piezos,
    }
}

/// Silence at once, from anywhere: XSMT low. The pin's registers are set whoever owns it.
pub fn mute() {
    pac::GPIOB.bsrr().write(|w| w.set_br(14, true));
}
