//! What a table says of a dynamic filter.

pub use crate::biquad::butterworth::Exciter;
pub use crate::waveguide::Loop;

/// The coefficients at a time after the strike; between breakpoints they are interpolated linearly.
///
/// First order: `s(n) = b0 e(n) + b1 e(n-1) - a1 s(n-1)`. Second order: a2 and b2 too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// Seconds after the strike; the first one's is 0.
    pub time_s: f64,
    /// Coefficient of -s(n-1).
    pub a1: f64,
    /// Coefficient of -s(n-2): second order only.
    pub a2: f64,
    /// Coefficient of e(n).
    pub b0: f64,
    /// Coefficient of e(n-1); eq. 17 has b1 = b0.
    pub b1: f64,
    /// Coefficient of e(n-2): second order only.
    pub b2: f64,
    /// Level of the noise, 0 to 1, times the strike's; it scales what goes into the filter, never
    /// the filter.
    pub noise: f64,
}

impl Default for Breakpoint {
    /// At 0 s, all coefficients 0, noise at the strike's level.
    fn default() -> Self {
        Self { time_s: 0.0, a1: 0.0, a2: 0.0, b0: 0.0, b1: 0.0, b2: 0.0, noise: 1.0 }
    }
}

/// All of an object's dynamic filter. `P` and `L` are iterators that may be run several times, such
/// as `slice.iter().copied()`.
#[derive(Clone, Copy, Debug)]
pub struct Settings<P, L> {
    /// Seed of the noise; the stream is given to [`super::DynamicFilter::load`].
    pub seed: u32,
    /// The rate in Hz that the path's coefficients are for, 8000 to 192 000. At another rate the
    /// bilinear transformation carries them over, and noise grows by `sqrt(rate/rate_hz)`, so that
    /// its density stays.
    pub rate_hz: f64,
    /// 1, or 2: then a2 and b2 count.
    pub order: u8,
    /// True if the object's modes go into the filter, rather than beside it.
    pub modes_through: bool,
    /// The band of the noise, if it has any.
    pub exciter: Option<Exciter>,
    /// Breakpoints ([`Breakpoint`]), first at 0 s.
    pub path: P,
    /// Banded waveguides ([`Loop`]).
    pub loops: L,
}
