//! Derivation of a loop's delay and band-pass from physical parameters.

use core::f64::consts::TAU;

use super::error::LoopError;
use crate::SampleRate;
use crate::sine;
use crate::square_root::length;

/// A loop: one resonance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loop {
    /// Frequency f_c of the resonance in Hz.
    pub frequency_hz: f64,
    /// Bandwidth Δf at -3 dB in Hz, 1 to 5 in the paper.
    pub bandwidth_hz: f64,
    /// Gain γ_s of the band-pass at f_c. With `γ |F(f_c)|` just below 1 the loop rings long.
    pub gain: f64,
    /// Delay d_s in seconds, at least a frame. From 32 frames on a loop costs least.
    pub delay_s: f64,
}

/// A loop at a rate: `z^-delay (a + c z⁻¹) / (1 - 2 real z⁻¹ + square z⁻²)`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tuned {
    /// Delay in whole frames.
    pub(super) delay: usize,
    /// Real part of the pole. The pole does not depend on the delay.
    pub(super) real: f64,
    /// Square of the pole's magnitude.
    pub(super) square: f64,
    /// Coefficient of 1 in the numerator.
    pub(super) a: f64,
    /// Coefficient of z⁻¹ in the numerator.
    pub(super) c: f64,
    /// Angular frequency ω of f_c, in radians per frame.
    omega: f64,
    /// Gain at f_c, `γ e^{-iωφ}`, as real and imaginary part.
    gain: (f64, f64),
}

impl Tuned {
    /// Derives a loop at a rate. `index` is its index for errors, `room` the length of the line.
    ///
    /// Poles are as in eq. 9 to 11 with `τ = sin ω / 2Q`, `Q = f_c / Δf` (the paper prints the
    /// inverse). The delay is split into whole frames and a fraction φ. The numerator makes the
    /// gain at f_c `γ e^{-iωφ}`, which delays a band of a few hertz by φ.
    pub(crate) fn new(of: &Loop, index: usize, room: usize, rate: SampleRate) -> Result<Self, LoopError> {
        let Loop { frequency_hz, bandwidth_hz, gain, delay_s } = *of;
        let delay = delay_s * rate.hz();
        // The numerator is divided by sin ω, so f_c must stay a thousandth of fs below Nyquist.
        let good = 0.0 < bandwidth_hz && bandwidth_hz < frequency_hz && frequency_hz < 0.499 * rate.hz();
        // With lower values δ as Q32 would be off by 1 %.
        let good = good && frequency_hz >= 1e-4 * rate.hz() && bandwidth_hz >= 1e-7 * rate.hz();
        if !(good && gain.is_finite() && delay >= 1.0) {
            return Err(LoopError::Band { index });
        }
        if delay >= room as f64 {
            return Err(LoopError::Delay { index, frames: delay, room });
        }
        let omega = TAU * frequency_hz / rate.hz();
        let (cosine, sine) = (sine::cos(omega), sine::sin(omega));
        let tau = sine * bandwidth_hz / frequency_hz / 2.0;
        let (real, square) = (cosine / (1.0 + tau), (1.0 - tau) / (1.0 + tau));
        if square < 0.51 {
            return Err(LoopError::Band { index });
        }
        let whole = libm::floor(delay);
        let angle = omega * (delay - whole);
        let gain = (gain * sine::cos(angle), -gain * sine::sin(angle));
        let (delay, nothing) = (whole as usize, Self::default());
        Ok(Self { delay, omega, gain, ..nothing }.with_pole(real, square))
    }

    /// Returns the loop with another pole, and with the numerator for an equal gain at f_c:
    /// `a + c w = γ e^{-iωφ} D(w)`, w = e^{-iω}.
    ///
    /// A loop of gain G close to 1 rings off f_c by only (1 - G) times the error of its pole. So
    /// the rounding of the pole hardly matters.
    pub(super) fn with_pole(self, real: f64, square: f64) -> Self {
        let (cosine, sine) = (sine::cos(self.omega), sine::sin(self.omega));
        let (double_cosine, double_sine) = (cosine * cosine - sine * sine, 2.0 * sine * cosine);
        let below = (1.0 - 2.0 * real * cosine + square * double_cosine, 2.0 * real * sine - square * double_sine);
        let (re, im) = self.gain;
        let wanted = (re * below.0 - im * below.1, re * below.1 + im * below.0);
        let c = -wanted.1 / sine;
        Self { real, square, a: wanted.0 - c * cosine, c, ..self }
    }

    /// Magnitude `|B|` of the band-pass at `w = cos - i sin`.
    pub(crate) fn magnitude(&self, (cosine, sine): (f64, f64)) -> f64 {
        let above = length(self.a + self.c * cosine, self.c * sine);
        let (double_cosine, double_sine) = (cosine * cosine - sine * sine, 2.0 * sine * cosine);
        let real = 1.0 - 2.0 * self.real * cosine + self.square * double_cosine;
        above / length(real, 2.0 * self.real * sine - self.square * double_sine)
    }

    /// Coefficients a and c of the numerator.
    pub(crate) fn zero(&self) -> (f64, f64) {
        (self.a, self.c)
    }

    /// Angle of the pole, and the pole's distance from the unit circle.
    pub(crate) fn pole(&self) -> (f64, f64) {
        let imaginary = libm::sqrt((self.square - self.real * self.real).max(0.0));
        (libm::atan2(imaginary, self.real), 1.0 - libm::sqrt(self.square))
    }
}
