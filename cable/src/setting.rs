//! Settings of a board, which override those of its kit and outlive it.

/// Version of the settings on the wire.
pub const SETTINGS_VERSION: u8 = 1;

/// Name of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Key {
    /// Softest peak of a piezo that is a strike, of half the ADC's range: the kit's `threshold`.
    Threshold {
        /// Piezo, counted from 0.
        piezo: u8,
    },
    /// Exponent of a piezo's velocity curve: the kit's `velocity_exponent`.
    Curve {
        /// Piezo, counted from 0.
        piezo: u8,
    },
    /// MIDI channel that the board plays and sends on.
    Channel,
    /// Level of the whole board in dB.
    Level,
    /// Slot whose kit plays after a start.
    StartSlot,
}

/// Value of a setting, in range for its [`Key`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Value {
    /// Number of a setting that is measured, such as [`Key::Level`].
    Number(f32),
    /// Number of a setting that is counted, such as [`Key::Channel`].
    Count(u8),
}

/// Range of a setting's values, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ValueRange {
    /// Range of a setting that is measured.
    Number(f32, f32),
    /// Range of a setting that is counted.
    Count(u8, u8),
}

impl Key {
    /// Number of the setting on the wire, and the piezo that it is of; 0 for a setting without
    /// piezo.
    pub const fn parts(self) -> (u8, u8) {
        match self {
            Self::Threshold { piezo } => (1, piezo),
            Self::Curve { piezo } => (2, piezo),
            Self::Channel => (3, 0),
            Self::Level => (4, 0),
            Self::StartSlot => (5, 0),
        }
    }

    /// Setting of a number and a piezo; `None` for a number that this side does not know.
    pub const fn from_parts(number: u8, piezo: u8) -> Option<Self> {
        Some(match number {
            1 => Self::Threshold { piezo },
            2 => Self::Curve { piezo },
            3 => Self::Channel,
            4 => Self::Level,
            5 => Self::StartSlot,
            _ => return None,
        })
    }

    /// Values that the setting may have.
    pub const fn range(self) -> ValueRange {
        match self {
            Self::Threshold { .. } => ValueRange::Number(0.001, 0.5),
            Self::Curve { .. } => ValueRange::Number(0.1, 8.0),
            Self::Channel => ValueRange::Count(1, 16),
            Self::Level => ValueRange::Number(-60.0, 0.0),
            Self::StartSlot => ValueRange::Count(0, u8::MAX),
        }
    }

    /// Value of four bytes on the wire, a float or a whole number; `None` if it is outside the
    /// setting's range.
    pub fn value(self, bits: u32) -> Option<Value> {
        match self.range() {
            ValueRange::Number(min, max) => {
                let number = f32::from_bits(bits);
                (min..=max).contains(&number).then_some(Value::Number(number))
            }
            ValueRange::Count(min, max) => {
                let count = u8::try_from(bits).ok()?;
                (min..=max).contains(&count).then_some(Value::Count(count))
            }
        }
    }
}

impl Value {
    /// Four bytes of the value on the wire.
    pub const fn bits(self) -> u32 {
        match self {
            Self::Number(number) => number.to_bits(),
            Self::Count(count) => count as u32,
        }
    }
}
