//! Events: strikes, chokes, releases, motions and shed decisions with their times.

use core::fmt;

#[cfg(feature = "scrapes")]
use crate::scrape::Motion;
use crate::scrape::MotionError;

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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// Register groups are left out until their pad is struck again.
    ///
    /// An engine with a budget decides this itself when time is short, and reports the decision.
    /// Played back, the decision gives the same bits. The event's pad does not matter.
    Shed(Shedding),
    /// The whole sound goes to a level, a gain of 0 to 1 that stands in the event's velocity, on a
    /// ramp of 20 ms. The event's pad does not matter.
    Level,
    /// All sound ends within 5 ms, with all contacts that go on. The event's pad does not matter.
    Silence,
    /// The striker touches the pad's surface, if the engine plays contacts that go on, at rest at
    /// the event's position, from the tick on that begins at the event or next. It scrapes or rolls
    /// as [`Action::Move`] says, until a [`Action::Lift`].
    #[cfg(feature = "scrapes")]
    Touch {
        /// True if it rolls, false if it scrapes.
        rolls: bool,
        /// Least and largest normal force in newtons, for which the striker's largest and least
        /// limits α stand (scraping-rolling eq. 7). Equal ones give the mean of both limits. A
        /// rolling ball weighs the mean.
        normal_n: [f32; 2],
    },
    /// The striker that touches the pad moves, and the event's position is its place along the
    /// object: over the tick that begins at the event or next, speed and limit go in straight lines
    /// to these, and the place follows. They stay there until they are told anew.
    #[cfg(feature = "scrapes")]
    Move(Motion),
    /// The striker leaves the pad's surface, from the tick on that begins at the event or next.
    #[cfg(feature = "scrapes")]
    Lift,
}

/// Register groups that a decision leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shedding {
    /// The given number of quietest groups that sound.
    Quietest(u16),
    /// All that sound but the first group of each pad's object: up to six modes at low frequencies,
    /// those that a strike keeps audible longest. This choice takes less time than that of the
    /// quietest groups.
    AllButFirst,
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

    /// True for a choke or a release.
    pub const fn is_choke_or_release(&self) -> bool {
        matches!(self.action, Action::Choke | Action::Release)
    }

    /// True if the event tells of a contact that goes on.
    #[cfg(feature = "scrapes")]
    pub const fn is_motion(&self) -> bool {
        matches!(self.action, Action::Touch { .. } | Action::Move(_) | Action::Lift)
    }

    /// True if the event tells of a contact that goes on: in this build none does, and events take
    /// a third less memory.
    #[cfg(not(feature = "scrapes"))]
    pub const fn is_motion(&self) -> bool {
        false
    }

    /// True if the event tells how a contact that goes on moves.
    #[cfg(feature = "scrapes")]
    pub const fn is_move(&self) -> bool {
        matches!(self.action, Action::Move(_))
    }

    /// True if the event tells how a contact that goes on moves: in this build none does.
    #[cfg(not(feature = "scrapes"))]
    pub const fn is_move(&self) -> bool {
        false
    }

    /// True if the event acts on a tick, so that no run of frames ends at it.
    pub const fn acts_on_tick(&self) -> bool {
        self.is_choke_or_release() || self.is_motion()
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
    /// The motion is refused.
    Motion {
        /// Index of the event in the slice.
        index: usize,
        /// Reason.
        error: MotionError,
    },
    /// The pad's object has no surface, or the striker does not scrape or roll.
    NoSurface {
        /// Index of the event in the slice.
        index: usize,
        /// Pad that is touched.
        pad: u8,
        /// Striker that touches it.
        striker: u8,
        /// True if it is to roll.
        rolls: bool,
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
            Self::Motion { index, error } => write!(f, "event {index}: {error}"),
            Self::NoSurface { index, pad, striker, rolls } => {
                let does = if rolls { "roll" } else { "scrape" };
                write!(
                    f,
                    "event {index}: striker {striker} cannot {does} on pad {pad}: the object needs a surface, and the striker its table [striker.{does}]"
                )
            }
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
