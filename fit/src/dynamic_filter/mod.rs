//! From a strike to the dynamic filter that brings it back: noise through a low-order filter whose coefficients move, and at most ten modes
//! (*Analysis-Synthesis of Impact Sounds by Real-Time Dynamic Filtering*, §IV).
//!
//! ```text
//! strike ─► damping law α(f), Λ(f) ─┬► three bands, first order (eq. 19 to 21) ─┐
//!           (crate::bark)           └► all bands, first or second order ────────┴► breakpoints
//!        ─► modes ─► at most ten ─┬► beside the filter, damped (additive) ────────► levels that are left to noise
//!                                 └► loops round it: d_s, γ_s (eq. 22 to 24) ─────► banded waveguides
//! ```

pub mod study;
pub mod table;

mod additive;
mod closed_loop;
mod damping;
mod guide;
mod heard;
mod joint;
mod lattice;
mod levels;
mod path;
mod response;
mod ringing;
mod sound;
mod stability;
mod thin;
mod three_bands;
mod waveguide;

pub use additive::{MOST_MODES, additive};
pub use damping::{Comparison, compare, counted, mean_law};
pub use path::{Criterion, noise_alone};
pub use response::response;
pub use sound::render;
pub use stability::{MOST_LOOP_GAIN, loop_gain};
pub use thin::{MOST_BREAKPOINTS, THINNED_WITHIN_DB};
pub use waveguide::{SHORTEST_DELAY, USUAL_BANDWIDTH_HZ, average, by_average_filter, waveguide};

use crate::modes::DampedSine;

/// Rate in Hz that coefficients are estimated for.
pub const RATE_HZ: f64 = 48_000.0;

/// Which coefficients a search may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `b0 (1 + z^-1)/(1 + a1 z^-1)` (eq. 17).
    FirstOrder,
    /// `(b0 + b1 z^-1)/(1 + a1 z^-1)`: the general first order of eq. 5.
    OnePoleOneZero,
    /// `(b0 + b1 z^-1 + b2 z^-2)/(1 + a1 z^-1 + a2 z^-2)`: the second order of eq. 5.
    SecondOrder,
}

/// Coefficients of `F` (eq. 5) at 48 kHz, poles inside the unit circle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficients {
    /// a1, a2.
    pub a: [f64; 2],
    /// b0, b1, b2.
    pub b: [f64; 3],
}

impl Coefficients {
    /// Part of the way (0 to 1) in a straight line to others: stable between stable ones, for the stable a1, a2 fill a triangle.
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let between = |from: f64, to: f64| from + part * (to - from);
        Self {
            a: std::array::from_fn(|i| between(self.a[i], other.a[i])),
            b: std::array::from_fn(|i| between(self.b[i], other.b[i])),
        }
    }
}

/// Coefficients at a time after the strike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// Seconds after the strike.
    pub time_s: f64,
    /// The coefficients.
    pub coefficients: Coefficients,
    /// Level of the noise, 0 to 1.
    pub noise: f64,
}

/// How the coefficients move: linear between breakpoints; no noise after the last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    /// Breakpoints in order of time, the first at 0.
    pub points: Vec<Breakpoint>,
}

impl Path {
    /// Coefficients at a time in seconds; after the last breakpoint, its own.
    pub fn at(&self, time_s: f64) -> Coefficients {
        let above = self.points.partition_point(|point| point.time_s <= time_s);
        match (above.checked_sub(1).and_then(|below| self.points.get(below)), self.points.get(above)) {
            (Some(from), Some(to)) => {
                let part = (time_s - from.time_s) / (to.time_s - from.time_s);
                from.coefficients.towards(&to.coefficients, part)
            }
            (Some(only), None) | (None, Some(only)) => only.coefficients,
            (None, None) => Coefficients::default(),
        }
    }

    /// The noise's level at a time in seconds; after the last breakpoint there is none.
    pub fn noise_at(&self, time_s: f64) -> f64 {
        let above = self.points.partition_point(|point| point.time_s <= time_s);
        match (above.checked_sub(1).and_then(|below| self.points.get(below)), self.points.get(above)) {
            (Some(from), Some(to)) => {
                from.noise + (time_s - from.time_s) / (to.time_s - from.time_s) * (to.noise - from.noise)
            }
            _ => 0.0,
        }
    }

    /// Time in seconds after which there is no noise.
    pub fn end_s(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.time_s)
    }
}

/// A banded waveguide round the filter (eq. 8 to 13).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// f_c: centre of the band-pass in Hz.
    pub frequency_hz: f64,
    /// Δf: its width at -3 dB in Hz.
    pub bandwidth_hz: f64,
    /// γ_s: its gain at the centre.
    pub gain: f64,
    /// d_s in seconds.
    pub delay_s: f64,
}

/// A sound by the dynamic filter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// The filter of the noise.
    pub path: Path,
    /// Modes beside the filter, amplitudes and phases at the strike.
    pub modes: Vec<DampedSine>,
    /// Loops round the filter.
    pub loops: Vec<Loop>,
}
