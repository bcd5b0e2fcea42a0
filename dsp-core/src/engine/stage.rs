//! Stages of a kit, by name.

use core::fmt;

use super::cost::CostItem;

/// Stage of a kit that takes memory or time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stage {
    /// The engine's own state, with all contacts.
    Engine,
    /// Modes of a pad, its strikers' included.
    Modes(u8),
    /// Positions of the strikes on a pad: without them all fall on position 0.
    Positions(u8),
    /// Residual of a pad's object.
    Residual(u8),
    /// Background behind all pads.
    Background,
    /// Dynamic filter of a pad's object, with its loops.
    DynamicFilter(u8),
    /// Biquads of a pad's object.
    Biquads(u8),
    /// Room round all pads.
    Room,
    /// Contacts that go on: scraping and rolling.
    Scrapes,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Engine => write!(f, "the engine"),
            Self::Modes(pad) => write!(f, "pad {pad}, modes"),
            Self::Positions(pad) => write!(f, "pad {pad}, positions of its strikes"),
            Self::Residual(pad) => write!(f, "pad {pad}, residual of its object"),
            Self::Background => write!(f, "background"),
            Self::DynamicFilter(pad) => write!(f, "pad {pad}, dynamic filter of its object"),
            Self::Biquads(pad) => write!(f, "pad {pad}, biquads of its object"),
            Self::Room => write!(f, "the room"),
            Self::Scrapes => write!(f, "scraping and rolling"),
        }
    }
}

impl Stage {
    /// Worst cycles of the stage in a tick with a strike; `cycles` are its own nominal ones.
    ///
    /// They include the work of its pad for it, the cycle model's worst case and the waits of
    /// flash, by measurements on the virtual boards
    /// (`cargo test -p virtual-board --test boards stages`).
    pub(super) fn worst_cycles(self, cycles: u32) -> u32 {
        self.worst_at(
            cycles,
            match self {
                Self::Residual(_) | Self::Background => 150,
                Self::DynamicFilter(_) => 200,
                Self::Biquads(_) => 175,
                // The room's, which is straight code too: no board plays scrapes yet.
                Self::Scrapes => 115,
                Self::Room => 115,
                Self::Engine | Self::Modes(_) | Self::Positions(_) => 100,
            },
        )
    }

    /// Cycles of the stage in a tick with a strike, in percent of the nominal ones; `cycles` are
    /// its own nominal ones.
    pub(super) fn worst_at(self, cycles: u32, percent: u32) -> u32 {
        let beside = match self {
            Self::Residual(_) | Self::Background => CostItem::ResidualStrike.cycles() + CostItem::ResidualRun.cycles(),
            Self::DynamicFilter(_) => BESIDE_DYNAMIC_FILTER,
            Self::Biquads(_) => BESIDE_BIQUADS,
            Self::Scrapes => BESIDE_SCRAPES,
            Self::Room | Self::Engine | Self::Modes(_) | Self::Positions(_) => 0,
        };
        (cycles + beside) * percent / 100
    }
}

/// Nominal cycles of a tick for the bus and the force of a pad with a dynamic filter.
///
/// This number and the two below were measured with the percentages of [`Stage::worst_cycles`].
/// They stay when [`CYCLES`](super::cost::CYCLES) are fitted anew.
const BESIDE_DYNAMIC_FILTER: u32 = 4_092;
/// Nominal cycles of a tick for the bus and the force of a pad with biquads.
const BESIDE_BIQUADS: u32 = 7_178;
/// Nominal cycles of a tick for the bus of a pad that is scraped.
const BESIDE_SCRAPES: u32 = 544;
