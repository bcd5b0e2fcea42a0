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
//!
//! A constant force F leads to `z = (gc - i gs) F/fs/(1-p)`. Where that is to be silent, the term subtracted is
//! `Re[(gc - i gs)/(1-p)] F/fs` instead.

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
    /// What the force is multiplied by before it is subtracted: `Re[w (gc - i gs)]/fs`.
    at_once: f64,
    /// w: 1/2, or `1/(1-p)` of the pole without a hand, where the mode is balanced.
    weight: Complex,
    /// `z`: both quadratures of the vibration, in full scale.
    state: Complex,
}

impl OnePole {
    /// A mode at rest that no force reaches until [`Self::set_gain`].
    pub(crate) fn new(frequency_hz: f64, decay_per_s: f64, rate: SampleRate) -> Self {
        Self {
            pole: pole(frequency_hz, decay_per_s, rate),
            input: Complex::ZERO,
            at_once: 0.0,
            weight: Complex { re: 0.5, im: 0.0 },
            state: Complex::ZERO,
        }
    }

    /// As [`OnePole::new`], for a mode whose static response is cancelled.
    pub(crate) fn balanced(frequency_hz: f64, decay_per_s: f64, rate: SampleRate) -> Self {
        let one_pole = Self::new(frequency_hz, decay_per_s, rate);
        // 1 - p without the difference of two numbers near 1: (1 - r cos θ) - i r sin θ.
        let (loss, half_angle) = (-(-decay_per_s / rate.hz()).exp_m1(), 0.5 * TAU * frequency_hz / rate.hz());
        let re = loss + 2.0 * (1.0 - loss) * half_angle.sin().powi(2);
        let im = -one_pole.pole.im;
        let squared = re * re + im * im;
        Self { weight: Complex { re: re / squared, im: -im / squared }, ..one_pole }
    }

    /// Changes how the force from now on drives the mode; what rings, rings on.
    pub(crate) fn set_gain(&mut self, gain: Gain, rate: SampleRate) {
        self.input = Complex { re: gain.cosine / rate.hz(), im: -gain.sine / rate.hz() };
        self.at_once = (self.weight * self.input).re;
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
            *y += z.re - self.at_once * force;
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
