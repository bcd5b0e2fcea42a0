//! STM32F407G-DISC1: 168 MHz, CS43L22 codec on I2S3 and I2C1, four LEDs, a button.

use embassy_stm32::exti::{ExtiInput, TriggerEdge};
use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::i2c::{self, I2c};
use embassy_stm32::rcc::{APBPrescaler, PllPDiv};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Peripherals, interrupt, pac, peripherals};
use embassy_time::Duration;

use super::Board;
use crate::audio::i2s::{I2s, Wiring};
use crate::clock::{AudioClock, ClockPlan};
use crate::codec;
use crate::input::Button;

/// What its engine has memory and time for.
pub use boards::Stm32f407gDisc1 as Memory;

/// 168 MHz; 86 MHz / 1792 = 47 991.07 Hz, the nearest to 48 kHz with a master clock for the codec.
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

/// The I2S output and its DMA stream (stream 5 and channel 0 serve SPI3's transmitter).
pub const I2S: Wiring =
    Wiring { spi: pac::SPI3, dma: pac::DMA1, stream: 5, channel: 0, interrupt: interrupt::DMA1_STREAM5 };

/// LEDs of this board.
pub const LEDS: usize = 4;

/// ADC1's inputs in the order of the piezos: PA1, PA2, PA3, PB1.
pub const PIEZO_CHANNELS: [u8; 4] = [1, 2, 3, 9];

/// Shared by all ADCs of the chip.
pub const ADC_COMMON: pac::adccommon::AdcCommon = pac::ADC123_COMMON;

/// Sets up the pins and starts the codec.
pub fn init(p: Peripherals) -> Board {
    let mut piezos = [Flex::new(p.PA1), Flex::new(p.PA2), Flex::new(p.PA3), Flex::new(p.PB1)];
    piezos.iter_mut().for_each(Flex::set_as_analog);

    // Alternate function 6 is SPI3/I2S3: MCK, CK, SD, WS.
    let mut pins = [Flex::new(p.PC7), Flex::new(p.PC10), Flex::new(p.PC12), Flex::new(p.PA4)];
    for pin in &mut pins {
        pin.set_as_af_unchecked(6, AfType::output(OutputType::PushPull, Speed::High));
    }
    core::mem::forget(pins);
    embassy_stm32::rcc::enable_and_reset::<peripherals::SPI3>();
    // The codec wants its master clock before it is started.
    let mut i2s = I2s::set_up();
    i2s.start();

    let mut config = i2c::Config::default();
    config.frequency = Hertz(100_000);
    config.timeout = Duration::from_millis(5);
    let bus = I2c::new_blocking(p.I2C1, p.PB6, p.PB9, config);
    let reset = Output::new(p.PD4, Level::Low, Speed::Low);
    Board {
        i2s,
        button: Button {
            pin: ExtiInput::new_blocking(p.PA0, p.EXTI0, Pull::Down, TriggerEdge::Rising),
            pressed_is_high: true,
        },
        // Green, orange, red, blue.
        leds: [
            Output::new(p.PD12, Level::Low, Speed::Low),
            Output::new(p.PD13, Level::Low, Speed::Low),
            Output::new(p.PD14, Level::Low, Speed::Low),
            Output::new(p.PD15, Level::Low, Speed::Low),
        ],
        leds_light_high: true,
        codec: codec::start(bus, reset),
        piezos,
    }
}

/// Silence at once, from anywhere: the codec's reset pin low. The pin's registers are set whoever owns it.
pub fn mute() {
    pac::GPIOD.bsrr().write(|w| w.set_br(4, true));
}
