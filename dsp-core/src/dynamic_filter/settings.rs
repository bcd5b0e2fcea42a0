//! Settings of a dynamic filter, as a table gives them.

pub use crate::biquad::butterworth::Exciter;
pub use crate::waveguide::Loop;

/// Coefficients at a time after the strike.
///
/// First order: `s(n) = b0 e(n) + b1 e(n-1) - a1 s(n-1)`. The second order has a2 and b2 too.
/// Between breakpoints the first order's coefficients are interpolated linearly. The second order's
/// poles and gains are interpolated instead ([`super::path`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// Time after the strike in seconds; 0 at the first breakpoint.
    pub time_s: f64,
    /// Coefficient of -s(n-1).
    pub a1: f64,
    /// Coefficient of -s(n-2), in the second order only.
    pub a2: f64,
    /// Coefficient of e(n).
    pub b0: f64,
    /// Coefficient of e(n-1); eq. 17 has b1 = b0.
    pub b1: f64,
    /// Coefficient of e(n-2), in the second order only.
    pub b2: f64,
    /// Level of the noise from 0 to 1, which multiplies the strike's level. It scales the noise
    /// that goes into the filter, never the filter.
    pub noise: f64,
}

impl Default for Breakpoint {
    /// Gives a breakpoint at 0 s with all coefficients 0 and noise at the strike's level.
    fn default() -> Self {
        Self { time_s: 0.0, a1: 0.0, a2: 0.0, b0: 0.0, b1: 0.0, b2: 0.0, noise: 1.0 }
    }
}

/// Settings of an object's dynamic filter.
///
/// `P` and `L` are iterators that are cloned and run several times, such as
/// `slice.iter().copied()`.
#[derive(Clone, Copy, Debug)]
pub struct Settings<P, L> {
    /// Seed of the noise. The number of its stream is given to [`super::DynamicFilter::load`].
    pub seed: u32,
    /// Rate in Hz that the path's coefficients are for, 8000 to 192 000.
    ///
    /// At another rate the bilinear transformation carries the coefficients over. The noise is then
    /// multiplied by `sqrt(rate/rate_hz)`, so that its density stays.
    pub rate_hz: f64,
    /// Order of the filter, 1 or 2. Only order 2 uses a2 and b2.
    pub order: u8,
    /// True if the object's modes go through the filter; false if they are heard beside it.
    pub modes_through: bool,
    /// Band of the noise; `None` if the noise is white.
    pub exciter: Option<Exciter>,
    /// Breakpoints ([`Breakpoint`]) in order of time, the first at 0 s.
    pub path: P,
    /// Banded waveguides round the filter ([`Loop`]).
    pub loops: L,
}
