//! A damped sine, the sound of one mode.

use nalgebra::Complex;

use super::pole::{Pole, add_ringing};

/// A damped sine: `amplitude e^{-d t} cos(2πft + phase)`, t from the first sample of the recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedSine {
    /// Frequency f in Hz.
    pub frequency_hz: f64,
    /// Decay rate d in 1/s; T60 = ln(1000)/d.
    pub decay_per_s: f64,
    /// Amplitude at t = 0, full scale 1.
    pub amplitude: f64,
    /// Phase at t = 0 in radians.
    pub phase: f64,
}

impl DampedSine {
    /// T60 in seconds.
    pub fn t60_s(&self) -> f64 {
        1000f64.ln() / self.decay_per_s
    }

    pub(super) fn gain(&self) -> Complex<f64> {
        Complex::from_polar(self.amplitude, self.phase)
    }

    /// Adds the sine to `samples`, the first of which is at t = 0.
    pub fn add_to(&self, samples: &mut [f64], rate_hz: f64) {
        add_ringing(Pole::new(self.frequency_hz, self.decay_per_s, rate_hz), self.gain(), samples);
    }
}
