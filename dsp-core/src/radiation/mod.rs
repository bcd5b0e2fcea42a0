//! Radiation: what sounds beside the modes.
//!
//! [`Acceleration`] is the click of the striker's deceleration, α times the force (diffimpact eq. 1 and §3.2).

use crate::fixed::{self, Scale};

/// Acceleration sound: `y += α F`.
///
/// Exact to half a bus step; costs nothing without α or without force.
#[derive(Clone, Copy, Debug)]
pub struct Acceleration {
    gain: Scale,
}

impl Acceleration {
    /// No such stage.
    pub const NONE: Self = Self { gain: Scale::ZERO };

    /// `alpha` is output (1.0 = full scale) per newton, `reference_force` the newtons of 1.0 on the force bus.
    pub fn new(alpha: f32, reference_force: f32) -> Self {
        Self { gain: Scale::new(f64::from(alpha) * f64::from(reference_force)) }
    }

    /// Whether the table has this stage at all.
    pub fn is_built(&self) -> bool {
        !self.gain.is_zero()
    }

    /// Adds the sound of a run of force to `out`.
    pub fn render(&self, force: &[i32], out: &mut [i32]) {
        for (out, &force) in out.iter_mut().zip(force) {
            *out = fixed::qadd(*out, self.gain.apply(force));
        }
    }
}
