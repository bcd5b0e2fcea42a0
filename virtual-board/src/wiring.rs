//! The two boards: their chip, crystal and connections.

use std::str::FromStr;

use crate::chip::Chip;
use crate::devices::gpio::Pin;
use crate::error::BoardError;
use crate::frequency::Frequency;

/// Board that can be run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Board {
    /// ST's STM32F407G-DISC1: 8 MHz crystal, CS43L22 codec on I2S3 and I2C1, four LEDs, a button.
    Stm32f407gDisc1,
    /// WeAct's BlackPill with an STM32F411CE and a PCM5102A on I2S2: 25 MHz crystal, one LED, a
    /// button.
    BlackpillF411,
}

/// LED of a board.
#[derive(Debug, Clone, Copy)]
pub struct Led {
    /// Colour of the LED, which is its name in reports.
    pub colour: &'static str,
    /// Pin that drives the LED.
    pub pin: Pin,
    /// True if a high level lights the LED.
    pub lit_by_high: bool,
}

/// Pins of a codec that is set up over I2C1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CodecPins {
    pub(crate) clock: Pin,
    pub(crate) data: Pin,
    pub(crate) reset: Pin,
}

/// Chip of a board and its connections.
#[derive(Debug, Clone, Copy)]
pub struct Wiring {
    /// Chip of the board.
    pub chip: Chip,
    /// Frequency of the crystal.
    pub crystal: Frequency,
    /// LEDs of the board.
    pub leds: &'static [Led],
    /// Pin of the button.
    pub button: Pin,
    /// True if the button's pin is high while the button is pressed, and pulled low otherwise.
    pub pressed_is_high: bool,
    /// Channel of ADC1 and pin of each piezo.
    pub piezos: &'static [(u8, Pin)],
    /// Number of the SPI that makes the I2S: 2 or 3.
    pub i2s: u8,
    /// Name, pin and alternate function of each I2S signal.
    pub i2s_pins: &'static [(&'static str, Pin, u8)],
    /// Pins of USB: D- and D+.
    pub usb_pins: [Pin; 2],
    /// Pins of the codec, or `None` if the converter is not set up by a bus.
    pub(crate) codec: Option<CodecPins>,
    /// Pin that mutes the converter while it is low, if there is one.
    pub(crate) mute: Option<Pin>,
}

const PIEZOS: [(u8, Pin); 4] =
    [(1, Pin::new('A', 1)), (2, Pin::new('A', 2)), (3, Pin::new('A', 3)), (9, Pin::new('B', 1))];

const USB_PINS: [Pin; 2] = [Pin::new('A', 11), Pin::new('A', 12)];

const DISC1: Wiring = Wiring {
    chip: Chip::Stm32F407,
    crystal: Frequency::hz(8_000_000),
    leds: &[
        Led { colour: "green", pin: Pin::new('D', 12), lit_by_high: true },
        Led { colour: "orange", pin: Pin::new('D', 13), lit_by_high: true },
        Led { colour: "red", pin: Pin::new('D', 14), lit_by_high: true },
        Led { colour: "blue", pin: Pin::new('D', 15), lit_by_high: true },
    ],
    button: Pin::new('A', 0),
    pressed_is_high: true,
    piezos: &PIEZOS,
    i2s: 3,
    i2s_pins: &[
        ("MCK", Pin::new('C', 7), 6),
        ("CK", Pin::new('C', 10), 6),
        ("SD", Pin::new('C', 12), 6),
        ("WS", Pin::new('A', 4), 6),
    ],
    usb_pins: USB_PINS,
    codec: Some(CodecPins { clock: Pin::new('B', 6), data: Pin::new('B', 9), reset: Pin::new('D', 4) }),
    mute: None,
};

const BLACKPILL: Wiring = Wiring {
    chip: Chip::Stm32F411,
    crystal: Frequency::hz(25_000_000),
    leds: &[Led { colour: "blue", pin: Pin::new('C', 13), lit_by_high: false }],
    button: Pin::new('A', 0),
    pressed_is_high: false,
    piezos: &PIEZOS,
    i2s: 2,
    i2s_pins: &[("CK", Pin::new('B', 13), 5), ("SD", Pin::new('B', 15), 5), ("WS", Pin::new('B', 12), 5)],
    usb_pins: USB_PINS,
    codec: None,
    mute: Some(Pin::new('B', 14)),
};

impl Board {
    /// Boards that can be run.
    pub const ALL: [Board; 2] = [Board::Stm32f407gDisc1, Board::BlackpillF411];

    /// Returns the name of the board, which is that of the firmware's feature.
    pub fn name(self) -> &'static str {
        match self {
            Board::Stm32f407gDisc1 => "stm32f407g-disc1",
            Board::BlackpillF411 => "blackpill-f411",
        }
    }

    /// Returns the chip of the board and its connections.
    pub fn wiring(self) -> &'static Wiring {
        match self {
            Board::Stm32f407gDisc1 => &DISC1,
            Board::BlackpillF411 => &BLACKPILL,
        }
    }
}

impl FromStr for Board {
    type Err = BoardError;

    fn from_str(name: &str) -> Result<Board, BoardError> {
        let found = Board::ALL.into_iter().find(|board| board.name() == name);
        found.ok_or_else(|| BoardError::NoSuchBoard { name: name.to_owned() })
    }
}
