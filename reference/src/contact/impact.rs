//! A single contact at its exact time.

use super::pulse::Pulse;
use crate::rate::SampleRate;

/// One term of eq. 3: the force `m_i C(t - t_i; τ_i)` of a single contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Start `t_i` of the force, in samples with a fraction.
    pub onset_samples: f64,
    /// Shape of the force.
    pub pulse: Pulse,
    /// Peak force `m_i` in newtons.
    pub peak_force: f64,
    /// Contact time `τ_i` in seconds, above 0.
    pub contact_time_s: f64,
}

impl Impact {
    /// Force in newtons of `sample`, at time `sample / fs` ([`Pulse::sample`]).
    pub fn force(&self, sample: u64, rate: SampleRate) -> f64 {
        self.peak_force * self.pulse.sample(self.since_onset_s(sample, rate), self.contact_time_s, rate)
    }

    /// Adds the force in newtons to `force`, whose first element is at `first_sample`.
    pub fn add_force(&self, first_sample: u64, rate: SampleRate, force: &mut [f64]) {
        for (sample, sum) in (first_sample..).zip(force) {
            *sum += self.force(sample, rate);
        }
    }

    /// True if no force is left from `sample` on.
    pub fn is_over(&self, sample: u64, rate: SampleRate) -> bool {
        self.since_onset_s(sample, rate) > self.pulse.sampled_duration_s(self.contact_time_s, rate)
    }

    fn since_onset_s(&self, sample: u64, rate: SampleRate) -> f64 {
        // Subtracted in samples, so that rounding in the division cannot move the onset.
        (sample as f64 - self.onset_samples) / rate.hz()
    }
}
