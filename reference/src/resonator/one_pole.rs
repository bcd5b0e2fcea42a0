//! One mode at one sample rate: a complex one-pole filter.
//!
//! ```text
//! z[n] = p z[n-1] + (gc - i gs) F[n]/fs,   p = e^((-d + i 2πf)/fs)
//! y[n] = Re z[n] - gc F[n]/(2 fs)
//! ```
//!
//! A force of F newtons at sample 0 alone leaves `z[n] = p^n (gc - i gs) F/fs`, whose real part is
//! `r^n (gs sin nθ + gc cos nθ) F/fs`: the impulse response. The term subtracted takes half of
//! `h[0] = gc` away again.

use std::f64::consts::TAU;

use crate::rate::SampleRate;
use crate::resonator::complex::Complex;
use crate::resonator::mode::Gain;

/// Below this amplitude (-3000 dBFS) a mode that nothing drives is at rest. Without it, the state
/// would end among the subnormal numbers, stay there for ever, and be slow to compute with.
const AT_REST: f64 = 1e-150;

/// The filter of one mode, and the mode's vibration `z`.
#[derive(Clone, Debug)]
pub(crate) struct OnePole {
    /// `p`.
    pole: Complex,
    /// `(gc - i gs)/fs`.
    input: Complex,
    /// `gc/(2 fs)`.
    half_of_h0: f64,
    /// `z`: both quadratures of the vibration, in full scale.
    state: Complex,
}

impl OnePole {
    /// A mode at rest that no force reaches until [`Self::set_gain`].
    pub(crate) fn new(frequency_hz: f64, decay_per_s: f64, rate: SampleRate) -> Self {
        Self {
            pole: pole(frequency_hz, decay_per_s, rate),
            input: Complex::ZERO,
            half_of_h0: 0.0,
            state: Complex::ZERO,
        }
    }

    /// Changes how the force from now on drives the mode; what rings, rings on.
    pub(crate) fn set_gain(&mut self, gain: Gain, rate: SampleRate) {
        self.input = Complex { re: gain.cosine / rate.hz(), im: -gain.sine / rate.hz() };
        self.half_of_h0 = gain.cosine / (2.0 * rate.hz());
    }

    /// Changes frequency and decay from the next step on; the state is continuous.
    pub(crate) fn set_pole(&mut self, frequency_hz: f64, decay_per_s: f64, rate: SampleRate) {
        self.pole = pole(frequency_hz, decay_per_s, rate);
    }

    /// Adds the mode's sound under `force` (newtons) to `sound` (full scale).
    pub(crate) fn drive(&mut self, force: &[f64], sound: &mut [f64]) {
        let mut z = self.state;
        for (force, y) in force.iter().zip(sound) {
            z = self.pole * z + self.input * *force;
            *y += z.re - self.half_of_h0 * force;
        }
        self.state = z;
    }

    /// Adds the mode's sound under no force: [`Self::drive`] without the input.
    pub(crate) fn ring(&mut self, sound: &mut [f64]) {
        let mut z = self.state;
        for y in sound {
            if z.re.abs().max(z.im.abs()) < AT_REST {
                z = Complex::ZERO;
                break;
            }
            z = self.pole * z;
            *y += z.re;
        }
        self.state = z;
    }

    /// `|z|`, the amplitude of the vibration in full scale.
    pub(crate) fn amplitude(&self) -> f64 {
        self.state.magnitude()
    }
}

/// `p = e^((-d + i 2πf)/fs)`.
fn pole(frequency_hz: f64, decay_per_s: f64, rate: SampleRate) -> Complex {
    Complex::exp(-decay_per_s / rate.hz(), TAU * frequency_hz / rate.hz())
}
