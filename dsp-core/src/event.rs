//! Events: who is struck when, how hard, where and with what.

use core::fmt;

/// A point in time: a frame counted from the engine's start and a fraction of the following one (2^-32 of a frame).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Time {
    /// Whole frames.
    pub frame: u64,
    /// Fraction of a frame, 1.0 = 2^32.
    pub fraction: u32,
}

impl Time {
    /// The beginning of a frame.
    pub const fn at_frame(frame: u64) -> Self {
        Self { frame, fraction: 0 }
    }

    /// The first frame at or after this time: where an event takes effect.
    pub const fn first_frame(self) -> u64 {
        if self.fraction == 0 { self.frame } else { self.frame.saturating_add(1) }
    }

    /// How much of a frame lies between this time and [`first_frame`](Self::first_frame), 1.0 = 2^32.
    pub fn early(self) -> u32 {
        self.fraction.wrapping_neg()
    }
}

/// What happens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Action {
    /// A contact begins.
    #[default]
    Strike,
    /// A hand is laid on: from the first tick behind the event on, decays rise to the pad's choke T60, until a release.
    Choke,
    /// The hand lets go: from the first tick behind the event on, decays are the object's own again.
    Release,
    /// Time is short: the so many quietest register groups of all pads are left out, until their pad is struck again. An engine with a
    /// budget decides this itself and tells it; played back, the same decision gives the same bits. The event's pad does not matter.
    Shed(u16),
}

/// One event on one pad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Event {
    /// When.
    pub time: Time,
    /// Which pad, counted from 0.
    pub pad: u8,
    /// Velocity, 0 to 1. A strike of velocity 0 does nothing.
    pub velocity: f32,
    /// Where along the object, 0 to 1.
    pub position: f32,
    /// Which of the pad's strikers, counted from 0.
    pub striker: u8,
    /// What.
    pub action: Action,
}

impl Event {
    /// A strike of velocity 0 on pad 0 at the start: nothing.
    pub const NOTHING: Self = Self {
        time: Time { frame: 0, fraction: 0 },
        pad: 0,
        velocity: 0.0,
        position: 0.0,
        striker: 0,
        action: Action::Strike,
    };

    /// True for a choke or a release. Both act on a tick, so that no run of frames ends at them.
    pub const fn is_choke_or_release(&self) -> bool {
        matches!(self.action, Action::Choke | Action::Release)
    }
}

/// Why an engine refuses the events of a block. Nothing of the block has been rendered then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventError {
    /// The event is earlier than the one before it, or than the block.
    OutOfOrder {
        /// Which event of the slice.
        index: usize,
        /// Where it takes effect.
        frame: u64,
        /// The earliest frame that it may have.
        earliest: u64,
    },
    /// The event lies behind the block's end.
    BehindBlock {
        /// Which event of the slice.
        index: usize,
        /// Where it takes effect.
        frame: u64,
        /// The first frame behind the block.
        end: u64,
    },
    /// The kit has no such pad.
    UnknownPad {
        /// Which event of the slice.
        index: usize,
        /// The pad that it names.
        pad: u8,
        /// How many there are.
        pads: usize,
    },
    /// The pad has no such striker.
    UnknownStriker {
        /// Which event of the slice.
        index: usize,
        /// The striker that it names.
        striker: u8,
        /// How many the pad has.
        strikers: usize,
    },
    /// The velocity is not in 0 to 1.
    Velocity {
        /// Which event of the slice.
        index: usize,
        /// Its velocity.
        value: f32,
    },
    /// The position is not in 0 to 1.
    Position {
        /// Which event of the slice.
        index: usize,
        /// Its position.
        value: f32,
    },
    /// The direct force is for a pad that the kit does not have, or not as long as the block.
    Direct {
        /// The pad that it names.
        pad: u8,
        /// Its length in frames.
        frames: usize,
        /// The block's length in frames.
        block: usize,
    },
}

impl fmt::Display for EventError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OutOfOrder { index, frame, earliest } => {
                write!(f, "event {index}: frame {frame} is before {earliest}; sort events by time")
            }
            Self::BehindBlock { index, frame, end } => {
                write!(f, "event {index}: frame {frame} is behind the block, which ends at {end}")
            }
            Self::UnknownPad { index, pad, pads } => {
                write!(f, "event {index}: pad {pad}: the kit has {pads} (counted from 0)")
            }
            Self::UnknownStriker { index, striker, strikers } => {
                write!(f, "event {index}: striker {striker}: the pad has {strikers} (counted from 0)")
            }
            Self::Velocity { index, value } => write!(f, "event {index}: velocity = {value}: must be from 0 to 1"),
            Self::Position { index, value } => write!(f, "event {index}: position = {value}: must be from 0 to 1"),
            Self::Direct { pad, frames, block } => {
                write!(
                    f,
                    "direct force for pad {pad}, {frames} frames: the block has {block} frames, and the pad must exist"
                )
            }
        }
    }
}

impl core::error::Error for EventError {}
