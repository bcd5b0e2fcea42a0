//! Why a dynamic filter is refused.

use core::fmt;

use super::limits::{MAX_GAIN, MAX_POLE, MAX_TIME_S, MIN_POLE, MIN_REAL_POLE};
use crate::SampleRate;
use crate::biquad::butterworth::{BandError, Exciter};
use crate::waveguide::LoopError;

/// Why breakpoints are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PathError {
    /// None, or more than fit.
    Count {
        /// Breakpoints given.
        given: usize,
        /// Breakpoints that fit.
        room: usize,
    },
    /// The first is not at 0, or one is not behind the one before it, or beyond an hour.
    Order {
        /// The breakpoint, counted from 0.
        breakpoint: usize,
        /// Its time in seconds.
        time_s: f64,
    },
    /// A pole on or outside the unit circle (eq. 21), or so near that the state would not fit.
    Unstable {
        /// The breakpoint, counted from 0.
        breakpoint: usize,
        /// The pole's magnitude, with its sign where it is real.
        pole: f64,
    },
    /// A coefficient of e is not finite, or the gain summed over the impulse response above the
    /// largest one possible.
    Gain {
        /// The breakpoint, counted from 0.
        breakpoint: usize,
        /// That gain.
        gain: f64,
    },
    /// A level of the noise that is not between 0 and 1.
    Noise {
        /// The breakpoint, counted from 0.
        breakpoint: usize,
        /// That level.
        noise: f64,
    },
    /// A second-order filter whose poles are conjugate at some breakpoints and real at others.
    PolesMeet {
        /// The first breakpoint that is unlike the one before.
        breakpoint: usize,
    },
    /// The filter's order is neither 1 nor 2.
    FilterOrder {
        /// Given value.
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
                "breakpoint {breakpoint}: a pole at {pole} does not decay: keep poles between {MIN_POLE} and {MAX_POLE} (first order: -a1), real ones of the second order above {MIN_REAL_POLE}"
            ),
            Self::Gain { breakpoint, gain } => write!(
                f,
                "breakpoint {breakpoint}: a gain of {gain}: lower its b to at most {MAX_GAIN}, or move poles apart that are nearly the same"
            ),
            Self::Noise { breakpoint, noise } => {
                write!(f, "breakpoint {breakpoint}: a level of the noise of {noise}: give 0 to 1")
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

/// Why a dynamic filter is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DynamicFilterError {
    /// Its path.
    Path(PathError),
    /// Its loops.
    Loop(LoopError),
    /// Its exciter's band.
    Exciter(BandError),
    /// The exponent by which its exciter follows strikes.
    Exponent {
        /// Given value.
        exponent: f64,
    },
    /// The rate that its coefficients are for is none.
    Rate {
        /// That rate in Hz.
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
