//! Parts of a kit that take memory or time.

use core::fmt;

use super::cost::{CYCLES, Part};
use crate::time::TICK_FRAMES;

/// A part of a kit that takes memory or time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stage {
    /// The contacts, and what the engine itself keeps.
    Engine,
    /// The modes of a pad, its strikers' included.
    Modes(u8),
    /// The residual of a pad's object.
    Residual(u8),
    /// The background.
    Background,
    /// The dynamic filter of a pad's object, with its loops.
    DynamicFilter(u8),
    /// The biquads of a pad's object.
    Biquads(u8),
    /// The room.
    Room,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Engine => write!(f, "the engine"),
            Self::Modes(pad) => write!(f, "pad {pad}, modes"),
            Self::Residual(pad) => write!(f, "pad {pad}, residual of its object"),
            Self::Background => write!(f, "background"),
            Self::DynamicFilter(pad) => write!(f, "pad {pad}, dynamic filter of its object"),
            Self::Biquads(pad) => write!(f, "pad {pad}, biquads of its object"),
            Self::Room => write!(f, "the room"),
        }
    }
}

impl Stage {
    /// Worst cycles of the stage in a tick with a strike, where `cycles` are its own nominal ones: with what its pad does for it, the cycle
    /// model's worst case and the waits of flash, by measurements on the virtual boards (`cargo test -p virtual-board --test boards stages`).
    pub(super) fn worst_cycles(self, cycles: u32) -> u32 {
        let frames = TICK_FRAMES as u32;
        let (beside, percent) = match self {
            Self::Residual(_) | Self::Background => (of(Part::ResidualStrike) + of(Part::ResidualRun), 150),
            Self::DynamicFilter(_) => (2 * of(Part::BusPad) + frames * of(Part::BusFrame), 200),
            Self::Biquads(_) => {
                (of(Part::BusDrivenPad) + frames * (of(Part::DrivenFrame) + of(Part::ContactFrame)), 175)
            }
            Self::Room => (0, 115),
            Self::Engine | Self::Modes(_) => (0, 100),
        };
        (cycles + beside) * percent / 100
    }
}

fn of(part: Part) -> u32 {
    CYCLES.get(part as usize).copied().unwrap_or(0)
}
