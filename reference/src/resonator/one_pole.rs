//! One mode at one sample rate: a complex one-pole filter.
//!
//! ```text
//! z[n] = p z[n-1] + (gc - i gs) F[n]/fs,   p = e^((-d + i 2πf)/fs)
//! y[n] = Re z[n] - gc F[n]/(2 fs)
//! ```
//!
//! A single force of F newtons at sample 0 leaves `z[n] = p^n (gc - i gs) F/fs`. Its real part is
//! the impulse response, `r^n (gs sin nθ + gc cos nθ) F/fs`. The term subtracted takes half of
//! `h[0] = gc` away again.
//!
//! A constant force F leads to `z = (gc - i gs) F/fs/(1-p)`. A balanced mode is to be silent then:
//! its term subtracted is `Re[(gc - i gs)/(1-p)] F/fs` instead.

use std::f64::consts::TAU;

use super::complex::Complex;
use super::mode::Gain;
use crate::rate::SampleRate;

/// Amplitude (-3000 dBFS) below which a mode that nothing drives is at rest.
///
/// Without this limit the state would end among the subnormal numbers, which are slow to compute
/// with, and stay there.
const AT_REST: f64 = 1e-150;

/// Filter of one mode, and the mode's vibration `z`.
#[derive(Clone, Debug)]
pub(crate) struct OnePole {
    /// Pole `p`.
    pole: Complex,
    frequency_hz: f64,
    /// Decay rate of the mode without a hand, in 1/s.
    own_decay_per_s: f64,
    /// Present decay rate of the mode in 1/s, a hand's included.
    decay_per_s: f64,
    /// Input `(gc - i gs)/fs` for the decay without a hand.
    own_input: Complex,
    /// Amount that a newton adds to `z` in a sample.
    input: Complex,
    /// Factor on the force that is subtracted from the output: `Re[w (gc - i gs)]/fs`.
    at_once: f64,
    /// Weight w: 1/2, or for a balanced mode `1/(1-p)` of the pole without a hand.
    weight: Complex,
    /// Vibration `z`: both quadratures, in full scale.
    state: Complex,
}

impl OnePole {
    /// Mode at rest that no force reaches until [`Self::set_gain`].
    pub(crate) fn new(frequency_hz: f64, decay_per_s: f64, rate: SampleRate) -> Self {
        Self {
            pole: pole(frequency_hz, decay_per_s, rate),
            frequency_hz,
            own_decay_per_s: decay_per_s,
            decay_per_s,
            own_input: Complex::ZERO,
            input: Complex::ZERO,
            at_once: 0.0,
            weight: Complex { re: 0.5, im: 0.0 },
            state: Complex::ZERO,
        }
    }

    /// Mode at rest whose static response is cancelled. No force reaches it until
    /// [`Self::set_gain`].
    pub(crate) fn balanced(frequency_hz: f64, decay_per_s: f64, rate: SampleRate) -> Self {
        let one_pole = Self::new(frequency_hz, decay_per_s, rate);
        // 1 - p without the difference of two numbers near 1: (1 - r cos θ) - i r sin θ.
        let (loss, half_angle) = (-(-decay_per_s / rate.hz()).exp_m1(), 0.5 * TAU * frequency_hz / rate.hz());
        let re = loss + 2.0 * (1.0 - loss) * half_angle.sin().powi(2);
        let im = -one_pole.pole.im;
        let squared = re * re + im * im;
        Self { weight: Complex { re: re / squared, im: -im / squared }, ..one_pole }
    }

    /// Changes the mode's response to the force from now on; its vibration goes on.
    pub(crate) fn set_gain(&mut self, gain: Gain, rate: SampleRate) {
        self.own_input = Complex { re: gain.cosine / rate.hz(), im: -gain.sine / rate.hz() };
        self.at_once = (self.weight * self.own_input).re;
        self.set_input(rate);
    }

    /// Changes the decay from the next sample on.
    ///
    /// Displacement and velocity of a body go on when a hand is laid on it. So the last two samples
    /// of the mode stay as they were, and a force adds two samples as it would without the hand.
    pub(crate) fn set_decay(&mut self, decay_per_s: f64, rate: SampleRate) {
        self.state = self.with_same_samples(self.state, self.decay_per_s, decay_per_s, rate);
        self.decay_per_s = decay_per_s;
        self.pole = pole(self.frequency_hz, decay_per_s, rate);
        self.set_input(rate);
    }

    fn set_input(&mut self, rate: SampleRate) {
        self.input = self.with_same_samples(self.own_input, self.own_decay_per_s, self.decay_per_s, rate);
    }

    /// Vibration with the decay `to_per_s` whose samples y[0] and y[-1] are those of `z` with
    /// `from_per_s`.
    ///
    /// With `z = C - i S`, `y[-1] = (C cos θ - S sin θ)/r`. So `S' = ρ S + (1 - ρ) C cot θ` with
    /// `ρ = r'/r`.
    fn with_same_samples(&self, z: Complex, from_per_s: f64, to_per_s: f64, rate: SampleRate) -> Complex {
        let (sine, cosine) = (TAU * self.frequency_hz / rate.hz()).sin_cos();
        if from_per_s == to_per_s || sine == 0.0 {
            return z;
        }
        let decays = (from_per_s - to_per_s) / rate.hz();
        // 1 - ρ without cancellation.
        let lost = -decays.exp_m1();
        Complex { re: z.re, im: decays.exp() * z.im - lost * z.re * cosine / sine }
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

    /// Effect of a newton with the present gain: the addition to `z`, and the amount subtracted
    /// from the output at once.
    pub(crate) fn input(&self) -> (Complex, f64) {
        (self.input, self.at_once)
    }

    /// Adds the mode's sound under several forces (newtons), each with an [`Self::input`] of its
    /// own.
    pub(crate) fn drive_at(&mut self, forces: &[((Complex, f64), &[f64])], sound: &mut [f64]) {
        for (n, y) in sound.iter_mut().enumerate() {
            self.state = self.pole * self.state;
            let mut subtracted = 0.0;
            for ((input, at_once), force) in forces {
                self.state = self.state + *input * force[n];
                subtracted += at_once * force[n];
            }
            *y += self.state.re - subtracted;
        }
    }

    /// Adds the mode's sound without force, as [`Self::drive`] would with a force of 0.
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

    /// Attenuates the vibration by a factor.
    pub(crate) fn attenuate(&mut self, factor: f64) {
        self.state = Complex { re: self.state.re * factor, im: self.state.im * factor };
    }

    /// Amplitude `|z|` of the vibration in full scale.
    pub(crate) fn amplitude(&self) -> f64 {
        self.state.magnitude()
    }
}

/// Pole `p = e^((-d + i 2πf)/fs)`.
fn pole(frequency_hz: f64, decay_per_s: f64, rate: SampleRate) -> Complex {
    Complex::exp(-decay_per_s / rate.hz(), TAU * frequency_hz / rate.hz())
}
