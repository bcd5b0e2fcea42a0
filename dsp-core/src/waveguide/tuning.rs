//! One loop from physical parameters: its delay and its band-pass.

use core::f64::consts::TAU;

use super::error::LoopError;
use crate::SampleRate;

/// A loop: one resonance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loop {
    /// f_c in Hz.
    pub frequency_hz: f64,
    /// Δf at -3 dB in Hz, 1 to 5 in the paper.
    pub bandwidth_hz: f64,
    /// γ_s, the band-pass' gain at f_c: `γ |F(f_c)|` just below 1 rings long.
    pub gain: f64,
    /// d_s in seconds, at least a frame; from 32 frames on a loop costs least.
    pub delay_s: f64,
}

/// A loop at a rate: `z^-delay (a + c z⁻¹) / (1 - 2 real z⁻¹ + square z⁻²)`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tuned {
    pub(super) delay: usize,
    /// θ-independent pole: its real part and the square of its magnitude.
    pub(super) real: f64,
    pub(super) square: f64,
    pub(super) a: f64,
    pub(super) c: f64,
    /// ω of f_c, and the gain there, `γ e^{-iωφ}`.
    omega: f64,
    gain: (f64, f64),
}

impl Tuned {
    /// Poles as in eq. 9 to 11 with `τ = sin ω / 2Q`, `Q = f_c / Δf` (the paper prints the
    /// inverse), the whole frames of the delay, and the numerator that makes the gain at f_c `γ
    /// e^{-iωφ}`, φ being what is left of the delay: over a band of a few hertz that is the delay.
    pub(crate) fn new(of: &Loop, index: usize, room: usize, rate: SampleRate) -> Result<Self, LoopError> {
        let Loop { frequency_hz, bandwidth_hz, gain, delay_s } = *of;
        let delay = delay_s * rate.hz();
        // sin ω in the numerator's derivation: not within a thousandth of Nyquist.
        let good = 0.0 < bandwidth_hz && bandwidth_hz < frequency_hz && frequency_hz < 0.499 * rate.hz();
        // δ as Q32 would be off by 1 %.
        let good = good && frequency_hz >= 1e-4 * rate.hz() && bandwidth_hz >= 1e-7 * rate.hz();
        if !(good && gain.is_finite() && delay >= 1.0) {
            return Err(LoopError::Band { index });
        }
        if delay >= room as f64 {
            return Err(LoopError::Delay { index, frames: delay, room });
        }
        let omega = TAU * frequency_hz / rate.hz();
        let (cosine, sine) = (libm::cos(omega), libm::sin(omega));
        let tau = sine * bandwidth_hz / frequency_hz / 2.0;
        let (real, square) = (cosine / (1.0 + tau), (1.0 - tau) / (1.0 + tau));
        if square < 0.51 {
            return Err(LoopError::Band { index });
        }
        let whole = libm::floor(delay);
        let angle = omega * (delay - whole);
        let gain = (gain * libm::cos(angle), -gain * libm::sin(angle));
        let (delay, nothing) = (whole as usize, Self::default());
        Ok(Self { delay, omega, gain, ..nothing }.with_pole(real, square))
    }

    /// Numerator for an equal gain at f_c with another pole: `a + c w = γ e^{-iωφ} D(w)`, w =
    /// e^{-iω}.
    ///
    /// A loop of gain G close to 1 rings at f_c less (1 - G) times what its pole is off: so a pole
    /// that was rounded hardly matters.
    pub(super) fn with_pole(self, real: f64, square: f64) -> Self {
        let (cosine, sine) = (libm::cos(self.omega), libm::sin(self.omega));
        let (double_cosine, double_sine) = (cosine * cosine - sine * sine, 2.0 * sine * cosine);
        let below = (1.0 - 2.0 * real * cosine + square * double_cosine, 2.0 * real * sine - square * double_sine);
        let (re, im) = self.gain;
        let wanted = (re * below.0 - im * below.1, re * below.1 + im * below.0);
        let c = -wanted.1 / sine;
        Self { real, square, a: wanted.0 - c * cosine, c, ..self }
    }

    /// `|B|` at `w = cos - i sin`.
    pub(crate) fn magnitude(&self, (cosine, sine): (f64, f64)) -> f64 {
        let above = libm::hypot(self.a + self.c * cosine, self.c * sine);
        let (double_cosine, double_sine) = (cosine * cosine - sine * sine, 2.0 * sine * cosine);
        let real = 1.0 - 2.0 * self.real * cosine + self.square * double_cosine;
        above / libm::hypot(real, 2.0 * self.real * sine - self.square * double_sine)
    }

    /// a and c.
    pub(crate) fn zero(&self) -> (f64, f64) {
        (self.a, self.c)
    }

    /// The angle of its pole, and the pole's distance from the unit circle.
    pub(crate) fn pole(&self) -> (f64, f64) {
        let imaginary = libm::sqrt((self.square - self.real * self.real).max(0.0));
        (libm::atan2(imaginary, self.real), 1.0 - libm::sqrt(self.square))
    }
}
