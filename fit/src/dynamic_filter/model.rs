//! Model of a sound: the path of the filter, the modes beside it and the loops round it.

use crate::modes::DampedSine;

/// Sample rate in Hz for which coefficients are estimated.
pub const RATE_HZ: f64 = 48_000.0;

/// Maximum number of modes or loops of a model, as in the paper's soundboard.
pub const MOST_MODES: usize = 10;

/// Form of the filter: the coefficients that a search may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// First order with a zero at half the rate, `b0 (1 + z^-1)/(1 + a1 z^-1)` (eq. 17).
    FirstOrder,
    /// General first order of eq. 5, `(b0 + b1 z^-1)/(1 + a1 z^-1)`.
    OnePoleOneZero,
    /// Second order of eq. 5, `(b0 + b1 z^-1 + b2 z^-2)/(1 + a1 z^-1 + a2 z^-2)`.
    SecondOrder,
}

/// Coefficients of `F` (eq. 5) at 48 kHz, with poles inside the unit circle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficients {
    /// Denominator coefficients a1, a2.
    pub a: [f64; 2],
    /// Numerator coefficients b0, b1, b2.
    pub b: [f64; 3],
}

impl Coefficients {
    /// Coefficients a part (0 to 1) of the way to others, on a straight line.
    ///
    /// Between stable filters they are stable, because the stable a1, a2 fill a triangle.
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
    /// Time in seconds after the strike.
    pub time_s: f64,
    /// Coefficients at that time.
    pub coefficients: Coefficients,
    /// Level of the noise, 0 to 1.
    pub noise: f64,
}

/// Motion of the coefficients, linear between breakpoints; there is no noise after the last one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    /// Breakpoints in order of time, the first at 0.
    pub points: Vec<Breakpoint>,
}

impl Path {
    /// Coefficients at a time in seconds; after the last breakpoint, those of the last one.
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

    /// Level of the noise at a time in seconds; 0 after the last breakpoint.
    pub fn noise_at(&self, time_s: f64) -> f64 {
        let above = self.points.partition_point(|point| point.time_s <= time_s);
        match (above.checked_sub(1).and_then(|below| self.points.get(below)), self.points.get(above)) {
            (Some(from), Some(to)) => {
                from.noise + (time_s - from.time_s) / (to.time_s - from.time_s) * (to.noise - from.noise)
            }
            _ => 0.0,
        }
    }

    /// Time in seconds of the last breakpoint, after which there is no noise.
    pub fn end_s(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.time_s)
    }
}

/// A banded waveguide round the filter (eq. 8 to 13).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// Centre f_c of the band-pass in Hz.
    pub frequency_hz: f64,
    /// Width Δf of the band-pass at -3 dB in Hz.
    pub bandwidth_hz: f64,
    /// Gain γ_s of the band-pass at its centre.
    pub gain: f64,
    /// Delay d_s in seconds.
    pub delay_s: f64,
}

/// A sound made by the dynamic filter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Motion of the filter and level of its noise.
    pub path: Path,
    /// Modes beside the filter, with amplitudes and phases at the strike.
    pub modes: Vec<DampedSine>,
    /// Loops round the filter.
    pub loops: Vec<Loop>,
}
