//! The reports of a trigger.

use core::fmt;

use crate::event::{Action, Event, Time};

/// Strike, choke or release that was found in the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// ADC frame of the decision, counted from the trigger's start. For a piezo's strike it is the
    /// onset plus the pad's scan time, for any block size; for a button it is the frame of the
    /// edge.
    pub frame: u64,
    /// Number of the pad, counted from 0.
    pub pad: u8,
    /// Number of the striker in the pad's list, counted from 0.
    pub striker: u8,
    /// Velocity, 0 to 1; 0 for a choke and a release.
    pub velocity: f32,
    /// Strike, choke or release.
    pub action: Action,
}

impl Detection {
    /// Event that plays the detection at the output frame `frame`.
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

/// Fault of a piezo's channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The channel has been at the lower rail for [`STUCK_S`](super::STUCK_S): short to ground, or
    /// no bias.
    StuckLow,
    /// The channel has been at the upper rail for [`STUCK_S`](super::STUCK_S): short to the supply,
    /// or open bias.
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

/// Report of a trigger. The reports of a channel come in the order of the ADC's frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Report<'a> {
    /// A pad is struck.
    Strike(Detection),
    /// The next samples of a direct pad's force, Q4.27, one for each ADC frame without gaps. They
    /// are zero while the gate is shut. Push them into the pad's [`Resampler`](super::Resampler).
    Force {
        /// Number of the pad, counted from 0.
        pad: u8,
        /// Samples of the force, up to 32.
        samples: &'a [i32],
    },
    /// A channel fails, and is not listened to until it recovers. Reported once for each failure.
    Fault {
        /// ADC frame at the end of the tick that decided it.
        frame: u64,
        /// Number of the channel, counted from 0.
        channel: u8,
        /// Fault of the channel.
        fault: Fault,
    },
    /// A channel that failed is well again.
    Recovered {
        /// ADC frame at the end of the tick that decided it.
        frame: u64,
        /// Number of the channel, counted from 0.
        channel: u8,
    },
}
