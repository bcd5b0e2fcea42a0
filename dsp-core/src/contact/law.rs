//! The striker's law: what a velocity does.

use super::Pulse;
use crate::fixed;
use crate::{SampleRate, table};

/// Peak force `m = m1 v^a` and contact time `τ = τ1 v^b` of a striker (diffimpact §3.2; Hertz's law has a = 6/5, b = -1/5).
#[derive(Clone, Copy, Debug)]
pub struct StrikerLaw {
    pulse: Pulse,
    /// m1 in units of the force bus.
    peak: f32,
    peak_exponent: f32,
    contact_time_s: f32,
    contact_exponent: f32,
}

/// A strike as the contact stage plays it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The shape.
    pub pulse: Pulse,
    /// Peak force, Q4.27 of the force bus.
    pub peak: i32,
    /// Length of the pulse in samples.
    pub length_samples: f64,
}

/// The longest contact, in seconds: a law that asks for more (b < 0 at the softest velocities) is held here.
pub const MAX_CONTACT_TIME_S: f64 = 0.25;
/// The shortest contact, in seconds.
pub const MIN_CONTACT_TIME_S: f64 = 1e-5;

impl StrikerLaw {
    /// The law of a striker of a table, for an object whose force bus has 1.0 = `reference_force`.
    pub fn new(striker: &table::Striker<'_>, reference_force: f32) -> Self {
        Self {
            pulse: if striker.is_gaussian() { Pulse::Gaussian } else { Pulse::HertzHalfSine },
            peak: striker.peak_force() / reference_force,
            peak_exponent: striker.peak_exponent(),
            contact_time_s: striker.contact_time_s(),
            contact_exponent: striker.contact_exponent(),
        }
    }

    /// The impact of a velocity in 0 to 1. `None` where it is too weak to move the force bus (peak below half a step), velocity 0 among them.
    ///
    /// Two `pow` in software `f64`: some 10 000 cycles on a Cortex-M4, once a strike.
    pub fn impact(&self, velocity: f32, rate: SampleRate) -> Option<Impact> {
        if velocity.is_nan() || velocity <= 0.0 {
            return None;
        }
        let velocity = f64::from(velocity);
        let peak = fixed::q27_from(f64::from(self.peak) * libm::pow(velocity, f64::from(self.peak_exponent)));
        let contact_time_s = f64::from(self.contact_time_s) * libm::pow(velocity, f64::from(self.contact_exponent));
        let contact_time_s = contact_time_s.clamp(MIN_CONTACT_TIME_S, MAX_CONTACT_TIME_S);
        let length_samples = contact_time_s * self.pulse.length() * rate.hz();
        (peak > 0).then_some(Impact { pulse: self.pulse, peak, length_samples })
    }

    /// Impulse in force units times seconds, and contact time in seconds, of a middling strike (velocity 0.5).
    pub fn typical_contact(&self) -> (f32, f32) {
        let contact_time_s = self.contact_time_s * libm::powf(0.5, self.contact_exponent);
        let peak = self.peak * libm::powf(0.5, self.peak_exponent);
        (peak * contact_time_s * self.pulse.area() as f32, contact_time_s)
    }
}
