//! Pins of the WeAct BlackPill STM32F411CE and its PCM5102A.

use embassy_stm32::exti::{ExtiInput, TriggerEdge};
use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::{Peripherals, peripherals};
use embassy_time::{Duration, block_for};

use super::devices::Devices;
use crate::audio::i2s::I2s;
use crate::input::button::Button;
use crate::usb;

/// Time from the first clock of the I2S until the converter is unmuted: more than the 1024 frames
/// in which its own PLL locks.
const CLOCKS_SETTLE: Duration = Duration::from_millis(30);

/// Sets up the pins and starts the I2S output, silent.
pub fn init(p: Peripherals) -> Devices {
    let mut piezos = [Flex::new(p.PA1), Flex::new(p.PA2), Flex::new(p.PA3), Flex::new(p.PB1)];
    piezos.iter_mut().for_each(Flex::set_as_analog);

    // Alternate function 5 is SPI2/I2S2: WS, CK, SD.
    let mut pins = [Flex::new(p.PB12), Flex::new(p.PB13), Flex::new(p.PB15)];
    for pin in &mut pins {
        pin.set_as_af_unchecked(5, AfType::output(OutputType::PushPull, Speed::High));
    }
    core::mem::forget(pins);
    embassy_stm32::rcc::enable_and_reset::<peripherals::SPI2>();

    // PB14 is XSMT, which mutes the PCM5102A while it is low: until its clocks have run for a
    // while, or it pops.
    let mut unmute = Output::new(p.PB14, Level::Low, Speed::Low);
    let mut i2s = I2s::take_over();
    i2s.start();
    block_for(CLOCKS_SETTLE);
    unmute.set_high();
    core::mem::forget(unmute);
    Devices {
        i2s,
        button: Button {
            pin: ExtiInput::new_blocking(p.PA0, p.EXTI0, Pull::Up, TriggerEdge::Falling),
            pressed_is_high: false,
        },
        leds: [Output::new(p.PC13, Level::High, Speed::Low)],
        leds_light_high: false,
        // The PCM5102A has no bus on which it could fail to answer.
        codec: Ok(None),
        piezos,
        usb: usb::Port { peripheral: p.USB_OTG_FS, dp: p.PA12, dm: p.PA11 },
    }
}
