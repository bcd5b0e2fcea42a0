//! Trials: their paths and the reasons for which they cannot be drawn.

use crate::motion::MOST_SPEED_M_PER_S;
use crate::motion::error::MotionFault;

/// Path of a trial. Lengths in metres, times in seconds, speeds in metres per second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Strokes along x there and back, `x = length/2 (1 - cos 2πt/period)`: one contact, which
    /// begins at the end near the hand.
    BackAndForth {
        /// Distance of the two ends: twice the amplitude L of eq. 8 and 9.
        length_m: f64,
        /// Time of two strokes, there and back.
        period_s: f64,
        /// Number of strokes.
        strokes: u32,
    },
    /// Strokes along x with the speeds of [`Shape::BackAndForth`], each on from the end of the one
    /// before, in one straight line. Each is a contact of its own.
    FourStrokes {
        /// Length of one stroke.
        length_m: f64,
        /// Time of two strokes.
        period_s: f64,
        /// Number of strokes.
        strokes: u32,
    },
    /// One turn at a constant speed with a smooth start and end, from the point that is nearest to
    /// the hand, counterclockwise.
    Circle {
        /// Circumference.
        length_m: f64,
        /// Speed between start and end.
        speed_m_per_s: f64,
    },
    /// Straight line along x with the speeds of [`Shape::Circle`].
    Line {
        /// Length of the line.
        length_m: f64,
        /// Speed between start and end.
        speed_m_per_s: f64,
    },
    /// Smooth random path with waves from 0.5 to 2.5 Hz, and a smooth start and end.
    Scribble {
        /// Length of the path.
        length_m: f64,
        /// Mean speed between start and end.
        speed_m_per_s: f64,
        /// Seed of the path.
        seed: u32,
    },
    /// Solid ball on an incline along x, `x = speed t - (5/14) g sin(incline) t²`, friction
    /// neglected. Uphill, a ball that stops before the end rolls back to where it began.
    Roll {
        /// Length of the incline.
        length_m: f64,
        /// Speed at the beginning, 0 or more.
        speed_m_per_s: f64,
        /// Angle in degrees: positive uphill, which slows the ball, negative downhill.
        incline_deg: f64,
    },
}

/// Trial: a path, and where and when it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Path of the tool.
    pub shape: Shape,
    /// Time of the first touch in seconds, from 0 to 3600.
    pub start_s: f64,
    /// Place of the first touch in metres, along x and y, each from -1000 to 1000.
    pub place_m: [f64; 2],
}

/// Reason for which a trial cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// A parameter is out of its range. The name is that of its option.
    #[error("--{name} {value}: {allowed}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Refused value.
        value: f64,
        /// Values that are allowed, in words.
        allowed: &'static str,
    },
    /// A ball without speed on a level or rising way does not roll.
    #[error("--speed 0: a ball at rest rolls downhill only; give a speed, or an --incline below 0")]
    AtRest,
    /// The motion takes too long for a file with a line a millisecond.
    #[error("the motion would take {seconds:.1} s, and at most {most_s} s are written; take less length or more speed")]
    TooLong {
        /// Time of the motion in seconds.
        seconds: f64,
        /// Longest time in seconds.
        most_s: f64,
    },
    /// The path is too fast, as one of short periods is, or a scribble whose mean is the limit.
    #[error(
        "{speed_m_per_s:.4} m/s at {time_s:.3} s of the motion, and no motion is faster than {MOST_SPEED_M_PER_S} m/s: take less --length or --speed, or more --period"
    )]
    TooFast {
        /// Time in seconds at which the motion is fastest.
        time_s: f64,
        /// Speed there in metres per second.
        speed_m_per_s: f64,
    },
    /// The path is no motion for another reason.
    #[error(transparent)]
    Path(MotionFault),
}

impl From<MotionFault> for TrialError {
    /// Leaves out the line, since no file was written.
    fn from(fault: MotionFault) -> Self {
        match fault {
            MotionFault::TooFast { time_s, speed_m_per_s, .. } => Self::TooFast { time_s, speed_m_per_s },
            fault => Self::Path(fault),
        }
    }
}
