//! What a trigger has to say.

use core::fmt;

use crate::event::{Action, Event, Time};

/// A strike, a choke or a release that was found in the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// The ADC frame at which it was decided, counted from the trigger's start: the strike's onset plus the pad's scan time, whatever
    /// the block size; for buttons the frame at which the edge was seen.
    pub frame: u64,
    /// Which pad, counted from 0.
    pub pad: u8,
    /// Which of the pad's strikers, counted from 0.
    pub striker: u8,
    /// Velocity, 0 to 1; 0 for a choke and a release.
    pub velocity: f32,
    /// What.
    pub action: Action,
}

impl Detection {
    /// The event that plays it at the output frame `frame`.
    pub const fn event(&self, frame: u64) -> Event {
        Event {
            time: Time::at_frame(frame),
            pad: self.pad,
            velocity: self.velocity,
            position: 0.0,
            striker: self.striker,
            action: self.action,
        }
    }
}

/// What is wrong with a piezo's channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It has been at the lower rail for [`STUCK_S`](super::STUCK_S): short to ground, or no bias.
    StuckLow,
    /// It has been at the upper rail for [`STUCK_S`](super::STUCK_S): short to the supply, or the bias is open.
    StuckHigh,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::StuckLow => "stuck at the lower rail: look for a short to ground or a missing bias",
            Self::StuckHigh => "stuck at the upper rail: look for a short to the supply or an open bias",
        })
    }
}

/// One report of a trigger, in the order of the ADC's frames for each channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Report<'a> {
    /// A pad is struck.
    Strike(Detection),
    /// The next samples of a direct pad's force, Q4.27, one an ADC frame without gaps; all zero while the gate is shut. To be pushed
    /// into the pad's [`Resampler`](super::Resampler).
    Force {
        /// Which pad, counted from 0.
        pad: u8,
        /// Up to 32 samples.
        samples: &'a [i32],
    },
    /// A channel fails; it is not listened to until it recovers. Said once.
    Fault {
        /// The ADC frame at which it was found out.
        frame: u64,
        /// Which channel, counted from 0.
        channel: u8,
        /// What is wrong.
        fault: Fault,
    },
    /// A channel that failed is well again.
    Recovered {
        /// The ADC frame at which it was found out.
        frame: u64,
        /// Which channel, counted from 0.
        channel: u8,
    },
}
