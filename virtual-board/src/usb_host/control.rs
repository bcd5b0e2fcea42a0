//! Control transfers, and the requests that enumerate the board (USB 2.0, chapter 9).

use super::report::UsbReport;

/// Descriptor types.
const DEVICE: u8 = 1;
const CONFIGURATION: u8 = 2;
const STRING: u8 = 3;
/// Address that the host gives the board.
pub(super) const ADDRESS: u8 = 5;
/// Language of the strings: English, United States.
const ENGLISH: u16 = 0x0409;

/// Stage of a control transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    Setup,
    /// The board sends data.
    Data,
    /// The host acknowledges data, or the board acknowledges a request without data.
    Status,
}

/// Control transfer without data of the host.
#[derive(Debug, Clone)]
pub(super) struct Control {
    pub(super) setup: [u8; 8],
    pub(super) stage: Stage,
    /// Data that have come so far.
    pub(super) data: Vec<u8>,
    /// True if the next packet is DATA1.
    pub(super) odd: bool,
    /// Number of packets in a row that were not answered.
    pub(super) unanswered: u32,
}

impl Control {
    fn new(setup: [u8; 8]) -> Control {
        Control { setup, stage: Stage::Setup, data: Vec::new(), odd: true, unanswered: 0 }
    }

    /// Asks for a descriptor.
    pub(super) fn get_descriptor(kind: u8, index: u8, length: u16) -> Control {
        let language = if kind == STRING && index != 0 { ENGLISH } else { 0 };
        let ([low, high], [language, country]) = (length.to_le_bytes(), language.to_le_bytes());
        Control::new([0x80, 6, index, kind, language, country, low, high])
    }

    fn set(request: u8, value: u8) -> Control {
        Control::new([0, request, value, 0, 0, 0, 0, 0])
    }

    /// Returns the number of bytes that the host asks for.
    pub(super) fn wanted(&self) -> usize {
        usize::from(u16::from_le_bytes([self.setup[6], self.setup[7]]))
    }
}

/// Place in the list of requests that enumerate the board.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Enumeration {
    /// The first 8 bytes of the device descriptor, which tell the size of packets.
    #[default]
    Size,
    Address,
    Device,
    ConfigurationLength,
    Configuration,
    Languages,
    /// String of this place among those of the device descriptor.
    String(u8),
    Configure,
}

impl Enumeration {
    pub(super) fn first() -> Option<Control> {
        Some(Control::get_descriptor(DEVICE, 0, 8))
    }

    /// Takes the answer to a request. Returns the next place and its request, `None` at the end.
    pub(super) fn next(self, data: &[u8], configures: bool, report: &mut UsbReport) -> Option<(Enumeration, Control)> {
        let string = |place: u8, report: &UsbReport| {
            let index = report.device_descriptor.get(14 + usize::from(place)).copied().unwrap_or(0);
            (Enumeration::String(place), Control::get_descriptor(STRING, index, 255))
        };
        let configure = configures.then(|| (Enumeration::Configure, Control::set(9, 1)));
        match self {
            Enumeration::Size => Some((Enumeration::Address, Control::set(5, ADDRESS))),
            Enumeration::Address => Some((Enumeration::Device, Control::get_descriptor(DEVICE, 0, 18))),
            Enumeration::Device => {
                report.device_descriptor = data.to_vec();
                report.strings.clear();
                Some((Enumeration::ConfigurationLength, Control::get_descriptor(CONFIGURATION, 0, 9)))
            }
            Enumeration::ConfigurationLength => {
                let length = data.get(2..4).map_or(9, |length| u16::from_le_bytes([length[0], length[1]]));
                Some((Enumeration::Configuration, Control::get_descriptor(CONFIGURATION, 0, length)))
            }
            Enumeration::Configuration => {
                report.configuration_descriptor = data.to_vec();
                Some((Enumeration::Languages, Control::get_descriptor(STRING, 0, 255)))
            }
            Enumeration::Languages => Some(string(0, report)),
            Enumeration::String(place) => {
                let characters = data.get(2..).unwrap_or_default().chunks_exact(2);
                let units: Vec<u16> = characters.map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
                report.strings.push(String::from_utf16_lossy(&units));
                if place < 2 { Some(string(place + 1, report)) } else { configure }
            }
            Enumeration::Configure => None,
        }
    }
}
