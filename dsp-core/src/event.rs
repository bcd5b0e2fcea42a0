//! Events: strikes, chokes, releases and shed decisions with their times.

use core::fmt;

/// Point in time: a frame counted from the engine's start, and a fraction of that frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Time {
    /// Whole frames.
    pub frame: u64,
    /// Fraction of a frame, 1.0 = 2^32.
    pub fraction: u32,
}

impl Time {
    /// Time at the beginning of a frame.
    pub const fn at_frame(frame: u64) -> Self {
        Self { frame, fraction: 0 }
    }

    /// First frame at or after this time, at which an event takes effect.
    pub const fn first_frame(self) -> u64 {
        if self.fraction == 0 { self.frame } else { self.frame.saturating_add(1) }
    }

    /// Fraction of a frame from this time to [`first_frame`](Self::first_frame), 1.0 = 2^32.
    pub fn early(self) -> u32 {
        self.fraction.wrapping_neg()
    }
}

/// Action of an event.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Action {
    /// A contact begins.
    #[default]
    Strike,
    /// A hand is laid on the pad until a release.
    ///
    /// From the first tick after the event, the pad decays at least as fast as its choke T60.
    Choke,
    /// The hand lets go: from the first tick after the event, decays are the object's own again.
    Release,
    /// The given number of quietest register groups is left out until their pad is struck again.
    ///
    /// An engine with a budget decides this itself when time is short, and reports the decision.
    /// Played back, the decision gives the same bits. The event's pad does not matter.
    Shed(u16),
    /// The whole sound goes to a level, a gain of 0 to 1 that stands in the event's velocity, on a
    /// ramp of 20 ms. The event's pad does not matter.
    Level,
    /// All sound ends within 5 ms. The event's pad does not matter.
    Silence,
}

/// One event on one pad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Event {
    /// Time of the event.
    pub time: Time,
    /// Number of the pad, counted from 0.
    pub pad: u8,
    /// Velocity, 0 to 1. A strike of velocity 0 does nothing.
    pub velocity: f32,
    /// Position along the object, 0 to 1.
    pub position: f32,
    /// Number of the pad's striker, counted from 0.
    pub striker: u8,
    /// Action at that time.
    pub action: Action,
}

impl Event {
    /// A strike of velocity 0 on pad 0 at the start, which does nothing.
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

/// Reason to refuse the events of a block, of which nothing has been rendered then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventError {
    /// The event is earlier than the one before it, or than the block.
    OutOfOrder {
        /// Index of the event in the slice.
        index: usize,
        /// Frame at which the event takes effect.
        frame: u64,
        /// Earliest frame that is allowed.
        earliest: u64,
    },
    /// The event takes effect after the block's end.
    BehindBlock {
        /// Index of the event in the slice.
        index: usize,
        /// Frame at which the event takes effect.
        frame: u64,
        /// First frame after the block.
        end: u64,
    },
    /// The kit has no such pad.
    UnknownPad {
        /// Index of the event in the slice.
        index: usize,
        /// Pad that the event names.
        pad: u8,
        /// Number of pads of the kit.
        pads: usize,
    },
    /// The pad has no such striker.
    UnknownStriker {
        /// Index of the event in the slice.
        index: usize,
        /// Striker that the event names.
        striker: u8,
        /// Number of strikers of the pad.
        strikers: usize,
    },
    /// The velocity is not in 0 to 1.
    Velocity {
        /// Index of the event in the slice.
        index: usize,
        /// Velocity of the event.
        value: f32,
    },
    /// The position is not in 0 to 1.
    Position {
        /// Index of the event in the slice.
        index: usize,
        /// Position of the event.
        value: f32,
    },
    /// The direct force names a pad that the kit does not have, or is not as long as the block.
    Direct {
        /// Pad of the direct force.
        pad: u8,
        /// Length of the direct force in frames.
        frames: usize,
        /// Length of the block in frames.
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
