//! Reasons to refuse a dynamic filter.

use core::fmt;

use super::limits::{MAX_GAIN, MAX_POLE, MAX_TIME_S, MIN_POLE, MIN_REAL_POLE};
use crate::SampleRate;
use crate::biquad::butterworth::{BandError, Exciter};
use crate::waveguide::LoopError;

/// Reason to refuse the breakpoints of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PathError {
    /// No breakpoint is given, or more than fit.
    Count {
        /// Number of breakpoints given.
        given: usize,
        /// Number of breakpoints that fit.
        room: usize,
    },
    /// A breakpoint's time is invalid: the first must be at 0 s, each other one later than the one
    /// before it, and none later than an hour.
    Order {
        /// Index of the breakpoint, counted from 0.
        breakpoint: usize,
        /// Time of the breakpoint in seconds.
        time_s: f64,
    },
    /// A pole is on or outside the unit circle (eq. 21), or so near that the state would not fit.
    Unstable {
        /// Index of the breakpoint, counted from 0.
        breakpoint: usize,
        /// Magnitude of a conjugate pole, or a real pole with its sign.
        pole: f64,
    },
    /// A coefficient of e is not finite, or the gain summed over the impulse response is above the
    /// largest one allowed.
    Gain {
        /// Index of the breakpoint, counted from 0.
        breakpoint: usize,
        /// Gain summed over the impulse response.
        gain: f64,
    },
    /// A level of the noise is not between 0 and 1.
    Noise {
        /// Index of the breakpoint, counted from 0.
        breakpoint: usize,
        /// Level of the noise.
        noise: f64,
    },
    /// The poles of a second-order filter are conjugate at some breakpoints and real at others.
    PolesMeet {
        /// Index of the first breakpoint whose poles differ in this from the one before.
        breakpoint: usize,
    },
    /// The filter's order is neither 1 nor 2.
    FilterOrder {
        /// Order that was given.
        order: u8,
    },
}

impl fmt::Display for PathError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Count { given, room } => write!(f, "{given} breakpoints: give 1 to {room}"),
            Self::Order { breakpoint, time_s } => write!(
                f,
                "breakpoint {breakpoint} at {time_s} s: begin at 0 and give each time after the one before, up to {MAX_TIME_S} s"
            ),
            Self::Unstable { breakpoint, pole } => write!(
                f,
                "breakpoint {breakpoint}: a pole at {pole} is outside the unit circle or too near to it: keep poles between {MIN_POLE} and {MAX_POLE} (first order: -a1), real ones of the second order above {MIN_REAL_POLE}"
            ),
            Self::Gain { breakpoint, gain } => write!(
                f,
                "breakpoint {breakpoint}: a gain of {gain}, summed over the impulse response: lower its b until the sum is at most {MAX_GAIN}, or move poles apart that are nearly the same"
            ),
            Self::Noise { breakpoint, noise } => {
                write!(f, "breakpoint {breakpoint}: a noise level of {noise}: give 0 to 1")
            }
            Self::PolesMeet { breakpoint } => write!(
                f,
                "breakpoint {breakpoint}: poles become real or conjugate here: keep a1² - 4 a2 below 0 in all breakpoints or in none"
            ),
            Self::FilterOrder { order } => write!(f, "a filter of order {order}: give 1 or 2"),
        }
    }
}

impl core::error::Error for PathError {}

/// Reason to refuse a dynamic filter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DynamicFilterError {
    /// The path is invalid.
    Path(PathError),
    /// The loops are invalid.
    Loop(LoopError),
    /// The exciter's band is invalid.
    Exciter(BandError),
    /// The exponent by which the exciter's band follows a strike's level is out of range.
    Exponent {
        /// Exponent that was given.
        exponent: f64,
    },
    /// The rate that the coefficients are for is out of range.
    Rate {
        /// Rate that was given, in Hz.
        rate_hz: f64,
    },
}

impl fmt::Display for DynamicFilterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Path(error) => error.fmt(f),
            Self::Loop(error) => error.fmt(f),
            Self::Exciter(error) => write!(f, "exciter: {error}"),
            Self::Exponent { exponent } => {
                write!(f, "exciter: an exponent of {exponent}: give {0} to -{0}", Exciter::LARGEST_EXPONENT)
            }
            Self::Rate { rate_hz } => write!(
                f,
                "coefficients for a rate of {rate_hz} Hz: give {} to {} Hz",
                SampleRate::MIN_HZ,
                SampleRate::MAX_HZ
            ),
        }
    }
}

impl core::error::Error for DynamicFilterError {}

impl From<PathError> for DynamicFilterError {
    fn from(error: PathError) -> Self {
        Self::Path(error)
    }
}

impl From<LoopError> for DynamicFilterError {
    fn from(error: LoopError) -> Self {
        Self::Loop(error)
    }
}

impl From<BandError> for DynamicFilterError {
    fn from(error: BandError) -> Self {
        Self::Exciter(error)
    }
}
