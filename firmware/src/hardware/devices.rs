//! Devices of the board that the application uses.

use embassy_stm32::gpio::{Flex, Output};

use crate::audio::i2s::I2s;
use crate::board::{LEDS, PIEZO_CHANNELS};
use crate::codec::{self, Codec};
use crate::input::button::Button;
use crate::usb;

/// Devices of the board, set up.
pub struct Devices {
    /// I2S output, which runs and is silent.
    pub i2s: I2s,
    /// Button of the board.
    pub button: Button,
    /// LEDs of the level meter, from soft to loud.
    pub leds: [Output<'static>; LEDS],
    /// True if a high level lights a LED.
    pub leds_light_high: bool,
    /// Codec, or the reason for which it does not play; `None` if the converter has no bus.
    pub codec: Result<Option<Codec>, codec::Error>,
    /// Analog pins of the piezos, held so that nothing else takes them.
    pub piezos: [Flex<'static>; PIEZO_CHANNELS.len()],
    /// USB, which is not started yet.
    pub usb: usb::Port,
}
