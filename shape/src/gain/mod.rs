//! Gains: what is heard of a mode after a strike of unit impulse.
//!
//! With shapes φ of unit modal mass, the velocity of a point is
//! Σ φ(strike) φ(heard) e^(-d t) (cos ωt - d/ω sin ωt), m/s for 1 N s.

mod pressure;

pub use pressure::{SPEED_OF_SOUND_M_PER_S, Surface, pressure};

/// Gains of a mode for one place of a strike, output/(N s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gain {
    /// Part of e^(-d t) sin ωt.
    pub sine: f64,
    /// Part of e^(-d t) cos ωt.
    pub cosine: f64,
}

/// Gain of a point's velocity, from the shape at the strike and at the point; ω in rad/s, d in 1/s.
pub fn velocity(at_strike: f64, at_point: f64, omega: f64, decay_per_s: f64) -> Gain {
    let cosine = at_strike * at_point;
    Gain { sine: -cosine * decay_per_s / omega, cosine }
}

/// Gain that is the same for each mode of the same shape at the strike: |φ| (diffmodal §2.4).
pub fn even(at_strike: f64) -> Gain {
    Gain { sine: 0.0, cosine: at_strike.abs() }
}
