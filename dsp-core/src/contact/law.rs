//! The striker's law: what a velocity does.

use super::pulse::{Pulse, WHOLE};
use crate::fixed::{self, Log2};
use crate::table::ContactTable;
use crate::{SampleRate, exponential};

/// Peak force `m = m1 v^a` and contact time `τ = τ1 v^b` of a striker (diffimpact §3.2; Hertz's law has a = 6/5, b = -1/5).
#[derive(Clone, Copy, Debug)]
pub struct StrikerLaw {
    pulse: Pulse,
    /// m1, Q4.27 of the force bus.
    peak: u64,
    /// Fraction of the pulse in a sample at velocity 1, 1.0 = [`WHOLE`].
    step: u64,
    /// a and -b, Q27.
    peak_exponent_q27: i32,
    step_exponent_q27: i32,
    /// The steps of the longest and of the shortest contact.
    step_range: (u64, u64),
}

/// A strike as the contact stage plays it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The shape.
    pub pulse: Pulse,
    /// Peak force, Q4.27 of the force bus.
    pub peak: i32,
    /// Fraction of the pulse in a sample, 1.0 = [`WHOLE`]; more than that where it is shorter.
    pub step: u64,
}

impl Impact {
    /// Bound of the sum of its force, bus steps.
    pub fn sum(&self) -> u64 {
        // A sample more than its length on either side: the first and the last are filled in part.
        // The upper words are as good as all 64 bits.
        let samples = (WHOLE >> 32) as u32 / ((self.step >> 32) as u32).max(1);
        u64::from(self.peak.unsigned_abs()) * (u64::from(samples) + 2)
    }
}

/// The longest contact, in seconds: a law that asks for more (b < 0 at the softest velocities) is held here.
pub const MAX_CONTACT_TIME_S: f64 = 0.25;
/// The shortest contact, in seconds: a law that asks for less (b > 0 at the softest velocities) is
/// held here. At 8 kHz it is a 12th of a sample.
pub const MIN_CONTACT_TIME_S: f64 = 1e-5;

impl StrikerLaw {
    /// The law of a table, for an object whose force bus has 1.0 = `reference_force`. Derived anew for each strike, from a table that is read in
    /// place: in `f32`, within 2^-21 of the exact one (0.000004 dB), which a Cortex-M4F does in about 150 cycles.
    pub fn new(contact: &ContactTable<'_>, reference_force: f32, rate: SampleRate) -> Self {
        let pulse = pulse_of(contact);
        let samples_a_second = pulse.length() as f32 * rate.hz_f32();
        // `as` saturates; at 8 kHz and [`MIN_CONTACT_TIME_S`] the step is 12.5 times the whole.
        let step = |contact_time_s: f32| (WHOLE as f32 / (contact_time_s * samples_a_second)) as u64;
        // Scaled by a power of two: exact but for the fraction.
        let q27 = |exponent: f32| (exponent * fixed::ONE_Q27 as f32) as i32;
        Self {
            pulse,
            peak: (contact.peak_force() / reference_force * fixed::ONE_Q27 as f32) as u64,
            step: step(contact.contact_time_s()),
            peak_exponent_q27: q27(contact.peak_exponent()),
            step_exponent_q27: q27(-contact.contact_exponent()),
            step_range: (step(MAX_CONTACT_TIME_S as f32).max(1), step(MIN_CONTACT_TIME_S as f32)),
        }
    }

    /// The impact of a velocity in 0 to 1. `None` where it is too weak to move the force bus, velocity 0 among them.
    ///
    /// In integers, within 2e-8 of the law ([`Log2`]), once a strike.
    pub fn impact(&self, velocity: f32) -> Option<Impact> {
        if velocity.is_nan() || velocity <= 0.0 {
            return None;
        }
        let logarithm = Log2::new(velocity);
        let peak = logarithm.power(self.peak_exponent_q27).of(self.peak).min(i32::MAX as u64) as i32;
        let (slowest, fastest) = self.step_range;
        // Not `clamp`, which panics on a range the wrong way round: nothing here can.
        let step = logarithm.power(self.step_exponent_q27).of(self.step).max(slowest).min(fastest);
        (peak > 0).then_some(Impact { pulse: self.pulse, peak, step })
    }
}

fn pulse_of(contact: &ContactTable<'_>) -> Pulse {
    if contact.is_gaussian() { Pulse::Gaussian } else { Pulse::hertz(contact.restitution()) }
}

fn half_to_the(exponent: f32) -> f32 {
    exponential::power_of_two(f64::from(-exponent)) as f32
}

/// Impulse in force units times seconds, and contact time in seconds, of a middling strike (velocity 0.5).
pub fn typical_contact(contact: &ContactTable<'_>, reference_force: f32) -> (f32, f32) {
    let pulse = pulse_of(contact);
    let contact_time_s = contact.contact_time_s() * half_to_the(contact.contact_exponent());
    let peak = contact.peak_force() / reference_force * half_to_the(contact.peak_exponent());
    (peak * contact_time_s * pulse.area(), contact_time_s)
}
