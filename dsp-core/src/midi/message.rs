//! Messages of MIDI 1.0.

/// Message of MIDI 1.0. Channels count from 0, all values are 0 to 127.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message {
    /// A key goes up.
    NoteOff {
        /// Channel.
        channel: u8,
        /// Number of the key.
        note: u8,
        /// Velocity of the release.
        velocity: u8,
    },
    /// A key goes down; with velocity 0 it goes up.
    NoteOn {
        /// Channel.
        channel: u8,
        /// Number of the key.
        note: u8,
        /// Velocity of the key.
        velocity: u8,
    },
    /// Pressure on one key.
    PolyPressure {
        /// Channel.
        channel: u8,
        /// Number of the key.
        note: u8,
        /// Pressure.
        pressure: u8,
    },
    /// A controller moves.
    ControlChange {
        /// Channel.
        channel: u8,
        /// Number of the controller.
        controller: u8,
        /// Value of the controller.
        value: u8,
    },
    /// Another program is chosen.
    ProgramChange {
        /// Channel.
        channel: u8,
        /// Number of the program.
        program: u8,
    },
    /// Pressure on all keys of a channel.
    ChannelPressure {
        /// Channel.
        channel: u8,
        /// Pressure.
        pressure: u8,
    },
    /// The pitch wheel moves.
    PitchBend {
        /// Channel.
        channel: u8,
        /// Low and high seven bits of the place of the wheel.
        bend: [u8; 2],
    },
    /// A system message other than SysEx: common (0xF1 to 0xF6) or real-time (0xF8 to 0xFF).
    System {
        /// Status byte.
        status: u8,
        /// Data bytes, 0 where the message has none.
        data: [u8; 2],
    },
}

/// Returns the number of data bytes behind a status byte; 0 for SysEx and for undefined ones.
pub(super) const fn data_bytes(status: u8) -> u8 {
    match status {
        0xC0..=0xDF | 0xF1 | 0xF3 => 1,
        0x80..=0xEF | 0xF2 => 2,
        _ => 0,
    }
}

impl Message {
    /// Makes the message of a status byte and its data bytes.
    pub(super) const fn new(status: u8, data: [u8; 2]) -> Self {
        let (channel, [first, second]) = (status & 0xF, data);
        match status >> 4 {
            0x8 => Self::NoteOff { channel, note: first, velocity: second },
            0x9 => Self::NoteOn { channel, note: first, velocity: second },
            0xA => Self::PolyPressure { channel, note: first, pressure: second },
            0xB => Self::ControlChange { channel, controller: first, value: second },
            0xC => Self::ProgramChange { channel, program: first },
            0xD => Self::ChannelPressure { channel, pressure: first },
            0xE => Self::PitchBend { channel, bend: data },
            _ => Self::System { status, data },
        }
    }

    /// Channel of the message, counted from 0; `None` for a system message.
    pub const fn channel(self) -> Option<u8> {
        match self {
            Self::NoteOff { channel, .. }
            | Self::NoteOn { channel, .. }
            | Self::PolyPressure { channel, .. }
            | Self::ControlChange { channel, .. }
            | Self::ProgramChange { channel, .. }
            | Self::ChannelPressure { channel, .. }
            | Self::PitchBend { channel, .. } => Some(channel),
            Self::System { .. } => None,
        }
    }

    /// Status byte and data bytes of the message, 0 where it has none.
    pub const fn bytes(self) -> [u8; 3] {
        match self {
            Self::NoteOff { channel, note, velocity } => [0x80 | channel, note, velocity],
            Self::NoteOn { channel, note, velocity } => [0x90 | channel, note, velocity],
            Self::PolyPressure { channel, note, pressure } => [0xA0 | channel, note, pressure],
            Self::ControlChange { channel, controller, value } => [0xB0 | channel, controller, value],
            Self::ProgramChange { channel, program } => [0xC0 | channel, program, 0],
            Self::ChannelPressure { channel, pressure } => [0xD0 | channel, pressure, 0],
            Self::PitchBend { channel, bend: [low, high] } => [0xE0 | channel, low, high],
            Self::System { status, data: [first, second] } => [status, first, second],
        }
    }
}
