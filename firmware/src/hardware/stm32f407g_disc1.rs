//! Pins of the STM32F407G-DISC1 and its CS43L22 codec.

use embassy_stm32::exti::{ExtiInput, TriggerEdge};
use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::i2c::{self, I2c};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Peripherals, peripherals};
use embassy_time::Duration;

use super::devices::Devices;
use crate::audio::i2s::I2s;
use crate::codec;
use crate::input::button::Button;
use crate::usb;

/// Sets up the pins, and starts the I2S output, silent, and the codec.
pub fn init(p: Peripherals) -> Devices {
    let mut piezos = [Flex::new(p.PA1), Flex::new(p.PA2), Flex::new(p.PA3), Flex::new(p.PB1)];
    piezos.iter_mut().for_each(Flex::set_as_analog);

    // Alternate function 6 is SPI3/I2S3: MCK, CK, SD, WS.
    let mut pins = [Flex::new(p.PC7), Flex::new(p.PC10), Flex::new(p.PC12), Flex::new(p.PA4)];
    for pin in &mut pins {
        pin.set_as_af_unchecked(6, AfType::output(OutputType::PushPull, Speed::High));
    }
    core::mem::forget(pins);
    embassy_stm32::rcc::enable_and_reset::<peripherals::SPI3>();
    // The codec needs its master clock before it is started.
    let mut i2s = I2s::take_over();
    i2s.start();

    let mut config = i2c::Config::default();
    config.frequency = Hertz(100_000);
    config.timeout = Duration::from_millis(5);
    let bus = I2c::new_blocking(p.I2C1, p.PB6, p.PB9, config);
    let reset = Output::new(p.PD4, Level::Low, Speed::Low);
    Devices {
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
        codec: codec::start(bus, reset).map(Some),
        piezos,
        usb: usb::Port { peripheral: p.USB_OTG_FS, dp: p.PA12, dm: p.PA11 },
    }
}
