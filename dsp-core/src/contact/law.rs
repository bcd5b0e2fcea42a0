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
    /// Length of the pulse at velocity 1, in samples.
    length_samples: f32,
    contact_exponent: f32,
    /// The range of a pulse's length, in samples.
    length_range_samples: (f32, f32),
}

/// A strike as the contact stage plays it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The shape.
    pub pulse: Pulse,
    /// Peak force, Q4.27 of the force bus.
    pub peak: i32,
    /// Length of the pulse in samples.
    pub length_samples: f32,
}

/// The longest contact, in seconds: a law that asks for more (b < 0 at the softest velocities) is held here.
pub const MAX_CONTACT_TIME_S: f64 = 0.25;
/// The shortest contact, in seconds.
pub const MIN_CONTACT_TIME_S: f64 = 1e-5;

impl StrikerLaw {
    /// No law: nothing it strikes moves.
    pub const NONE: Self = Self {
        pulse: Pulse::HertzHalfSine,
        peak: 0.0,
        peak_exponent: 0.0,
        length_samples: 0.0,
        contact_exponent: 0.0,
        length_range_samples: (0.0, 0.0),
    };

    /// The law of a striker of a table, for an object whose force bus has 1.0 = `reference_force`.
    pub fn new(striker: &table::Striker<'_>, reference_force: f32, rate: SampleRate) -> Self {
        let pulse = if striker.is_gaussian() { Pulse::Gaussian } else { Pulse::HertzHalfSine };
        let samples = |contact_time_s: f64| (contact_time_s * pulse.length() * rate.hz()) as f32;
        Self {
            pulse,
            peak: striker.peak_force() / reference_force,
            peak_exponent: striker.peak_exponent(),
            length_samples: samples(f64::from(striker.contact_time_s())),
            contact_exponent: striker.contact_exponent(),
            length_range_samples: (samples(MIN_CONTACT_TIME_S), samples(MAX_CONTACT_TIME_S)),
        }
    }

    /// The impact of a velocity in 0 to 1. `None` where it is too weak to move the force bus (peak below half a step), velocity 0 among them.
    ///
    /// Powers as `exp(a ln v)` in single precision: within 5e-7 of the law. One `logf` and two `expf` a strike.
    pub fn impact(&self, velocity: f32) -> Option<Impact> {
        if velocity.is_nan() || velocity <= 0.0 {
            return None;
        }
        let logarithm = libm::logf(velocity);
        let power = |exponent: f32| libm::expf(exponent * logarithm);
        // A power of two times an f32 is exact; `as` saturates.
        let peak = libm::rintf(self.peak * power(self.peak_exponent) * fixed::ONE_Q27 as f32) as i32;
        let (shortest, longest) = self.length_range_samples;
        let length_samples = (self.length_samples * power(self.contact_exponent)).clamp(shortest, longest);
        (peak > 0).then_some(Impact { pulse: self.pulse, peak, length_samples })
    }
}

/// Impulse in force units times seconds, and contact time in seconds, of a middling strike (velocity 0.5).
pub fn typical_contact(striker: &table::Striker<'_>, reference_force: f32) -> (f32, f32) {
    let pulse = if striker.is_gaussian() { Pulse::Gaussian } else { Pulse::HertzHalfSine };
    let contact_time_s = striker.contact_time_s() * libm::powf(0.5, striker.contact_exponent());
    let peak = striker.peak_force() / reference_force * libm::powf(0.5, striker.peak_exponent());
    (peak * contact_time_s * pulse.area() as f32, contact_time_s)
}
