//! The striker's law: peak force and contact time from a velocity.

use super::pulse::{Pulse, WHOLE};
use crate::fixed::{self, Log2};
use crate::table::ContactTable;
use crate::{SampleRate, exponential};

/// Peak force `m = m1 v^a` and contact time `τ = τ1 v^b` of a striker (diffimpact §3.2).
///
/// Hertz's law has a = 6/5, b = -1/5.
#[derive(Clone, Copy, Debug)]
pub struct StrikerLaw {
    pulse: Pulse,
    /// Peak force m1 at velocity 1, Q4.27 of the force bus.
    peak: u64,
    /// Fraction of the pulse in a sample at velocity 1, 1.0 = [`WHOLE`].
    step: u64,
    /// Exponent a of the peak, Q27.
    peak_exponent_q27: i32,
    /// Exponent -b of the step, Q27.
    step_exponent_q27: i32,
    /// Steps of the longest and of the shortest contact.
    step_range: (u64, u64),
}

/// A strike as the contact stage plays it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Shape of the force over time.
    pub pulse: Pulse,
    /// Peak force, Q4.27 of the force bus.
    pub peak: i32,
    /// Fraction of the pulse in a sample, 1.0 = [`WHOLE`]; above 1.0 if the pulse is shorter.
    pub step: u64,
}

impl Impact {
    /// Bound of the sum of the strike's force over all samples, in bus steps.
    pub fn sum(&self) -> u64 {
        // A sample more on either side, because the pulse fills the first and the last in part. The
        // upper words are precise enough.
        let samples = (WHOLE >> 32) as u32 / ((self.step >> 32) as u32).max(1);
        u64::from(self.peak.unsigned_abs()) * (u64::from(samples) + 2)
    }
}

/// Longest contact in seconds: longer ones (b < 0 at the softest velocities) are limited to it.
pub const MAX_CONTACT_TIME_S: f64 = 0.25;
/// Shortest contact in seconds: shorter ones (b > 0 at the softest velocities) are limited to it.
///
/// At 8 kHz it is a 12th of a sample.
pub const MIN_CONTACT_TIME_S: f64 = 1e-5;

impl StrikerLaw {
    /// Derives the law of a table for an object whose force bus has 1.0 = `reference_force`.
    ///
    /// Each strike derives it anew from a table that is read in place, but for the `pulse` of the
    /// table. It is computed in `f32`, within 2^-21 of the exact law (0.000004 dB), in about 150
    /// cycles of a Cortex-M4F.
    pub fn new(contact: &ContactTable<'_>, pulse: Pulse, reference_force: f32, rate: SampleRate) -> Self {
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

    /// Derives the impact of a velocity in 0 to 1, once a strike.
    ///
    /// Returns `None` for an impact too weak to move the force bus, and so for velocity 0. It is
    /// computed in integers, within 2e-8 of the law ([`Log2`]).
    pub fn impact(&self, velocity: f32) -> Option<Impact> {
        if velocity.is_nan() || velocity <= 0.0 {
            return None;
        }
        let logarithm = Log2::new(velocity);
        let peak = logarithm.power(self.peak_exponent_q27).of(self.peak).min(i32::MAX as u64) as i32;
        let (slowest, fastest) = self.step_range;
        // Not `clamp`, whose panic on a reversed range would be linked.
        let step = logarithm.power(self.step_exponent_q27).of(self.step).max(slowest).min(fastest);
        (peak > 0).then_some(Impact { pulse: self.pulse, peak, step })
    }
}

/// Hertz pulse of the striker that struck a pad last. The striker's next strike does not derive it
/// anew: that saves 400 cycles, and 800 with the waits of flash (docs/frames.md).
#[derive(Clone, Copy, Debug)]
pub struct LastPulse {
    /// Coefficient of restitution; 0 for none.
    restitution: f32,
    pulse: Pulse,
}

impl LastPulse {
    /// No striker.
    pub const NONE: Self = Self { restitution: 0.0, pulse: Pulse::Gaussian };

    /// Returns the pulse of a striker's contact.
    pub fn of(&mut self, contact: &ContactTable<'_>) -> Pulse {
        if contact.is_gaussian() {
            return Pulse::Gaussian;
        }
        let restitution = contact.restitution();
        if self.restitution != restitution {
            *self = Self { restitution, pulse: Pulse::hertz(restitution) };
        }
        self.pulse
    }
}

fn pulse_of(contact: &ContactTable<'_>) -> Pulse {
    if contact.is_gaussian() { Pulse::Gaussian } else { Pulse::hertz(contact.restitution()) }
}

fn half_to_the(exponent: f32) -> f32 {
    exponential::power_of_two(f64::from(-exponent)) as f32
}

/// Length of the pulse in seconds of a strike of velocity 1.
pub fn full_contact_s(contact: &ContactTable<'_>) -> f32 {
    let length = if contact.is_gaussian() { Pulse::Gaussian.length() as f32 } else { 1.0 };
    contact.contact_time_s() * length
}

/// Impulse in force units times seconds and contact time in seconds of a strike of velocity 0.5.
pub fn typical_contact(contact: &ContactTable<'_>, reference_force: f32) -> (f32, f32) {
    let pulse = pulse_of(contact);
    let contact_time_s = contact.contact_time_s() * half_to_the(contact.contact_exponent());
    let peak = contact.peak_force() / reference_force * half_to_the(contact.peak_exponent());
    (peak * contact_time_s * pulse.area(), contact_time_s)
}
