//! One loop from physical parameters: its delay, its band-pass, and whether it is stable.

use core::f64::consts::{PI, TAU};
use core::fmt;

use crate::SampleRate;
use crate::biquad::{Biquad, Root};
use crate::dynamic_filter::Breakpoint;
use crate::resonator::TICK_FRAMES;

/// A loop: one resonance.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// Why loops are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoopError {
    /// A frequency not between 0 and Nyquist, a bandwidth not between 0 and the frequency, or a gain that is no number.
    Band {
        /// The loop, counted from 0.
        index: usize,
    },
    /// More loops, or a longer delay, than fit.
    Room {
        /// Loops, or frames of delay.
        needed: usize,
        /// How many fit.
        room: usize,
    },
    /// The gain round the loops reaches 1.
    Unstable {
        /// Where, in Hz.
        frequency_hz: f64,
        /// The gain.
        gain: f64,
    },
}

impl fmt::Display for LoopError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Band { index } => {
                write!(f, "loop {index}: give 0 < bandwidth < frequency < Nyquist, and a finite gain")
            }
            Self::Room { needed, room } => {
                write!(f, "{needed} loops or frames of delay where {room} fit: give fewer or higher ones")
            }
            Self::Unstable { frequency_hz, gain } => {
                write!(
                    f,
                    "the gain round the loops is {gain} at {frequency_hz} Hz: lower the loops' gains until it is below 1"
                )
            }
        }
    }
}

impl core::error::Error for LoopError {}

impl Loop {
    /// The delay in whole frames (at least a tick) and the band-pass with the rest of the delay: poles as in eq. 9 to 11 with `τ = sin ω / 2Q`, `Q = f_c / Δf` (the paper prints the
    /// inverse), and a numerator `(1 - z⁻¹)(A + C z⁻¹)` that makes the gain at f_c `γ e^{-iωφ}`, φ the fraction of d.
    ///
    /// # Errors
    /// [`LoopError::Band`].
    pub fn derive(&self, index: usize, rate: SampleRate) -> Result<(usize, Biquad), LoopError> {
        let Self { frequency_hz, bandwidth_hz, gain, delay_s } = *self;
        let good = 0.0 < bandwidth_hz
            && bandwidth_hz < frequency_hz
            && frequency_hz < rate.hz() / 2.0
            && gain.is_finite()
            && (TICK_FRAMES as f64..=1e6).contains(&(delay_s * rate.hz()));
        if !good {
            return Err(LoopError::Band { index });
        }
        let omega = TAU * frequency_hz / rate.hz();
        let tau = libm::sin(omega) * bandwidth_hz / frequency_hz / 2.0;
        let real = libm::cos(omega) / (1.0 + tau);
        let square = (1.0 - tau) / (1.0 + tau);
        let pole = Root { real, imaginary: libm::sqrt((square - real * real).max(0.0)) };
        let delay = delay_s * rate.hz();
        let whole = libm::floor(delay);
        let fraction = delay - whole;
        // A + C w = γ e^{-iωφ} D(w) / (1 - w), w = e^{-iω}.
        let (cosine, sine) = (libm::cos(omega), libm::sin(omega));
        let (double_cosine, double_sine) = (libm::cos(2.0 * omega), libm::sin(2.0 * omega));
        let denominator =
            (1.0 - 2.0 * real * cosine + square * double_cosine, 2.0 * real * sine - square * double_sine);
        let turned = (libm::cos(omega * fraction) * gain, -libm::sin(omega * fraction) * gain);
        let wanted = divide(times(turned, denominator), (1.0 - cosine, sine));
        let c = -wanted.1 / sine;
        let a = wanted.0 - c * cosine;
        Ok((whole as usize, Biquad { pole, numerator: [a, c - a, -c] }))
    }
}

fn times(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn divide(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let square = b.0 * b.0 + b.1 * b.1;
    times(a, (b.0 / square, -b.1 / square))
}

/// `|F|` at an angle: `(b0 + b1 w) / (1 + a1 w)`.
fn response(point: &Breakpoint, omega: f64) -> f64 {
    let (cosine, sine) = (libm::cos(omega), -libm::sin(omega));
    let ratio = divide((point.b0 + point.b1 * cosine, point.b1 * sine), (1.0 + point.a1 * cosine, point.a1 * sine));
    libm::hypot(ratio.0, ratio.1)
}

/// The stability condition of the module's head.
///
/// # Errors
/// [`LoopError::Unstable`].
pub(super) fn check(
    biquads: &[Biquad],
    path: impl Iterator<Item = Breakpoint> + Clone,
    rate: SampleRate,
) -> Result<(), LoopError> {
    let magnitude = |biquad: &Biquad, omega: f64| {
        let (w, w2) = ((libm::cos(omega), -libm::sin(omega)), (libm::cos(2.0 * omega), -libm::sin(2.0 * omega)));
        let [b0, b1, b2] = biquad.numerator;
        let at = |c0: f64, c1: f64, c2: f64| libm::hypot(c0 + c1 * w.0 + c2 * w2.0, c1 * w.1 + c2 * w2.1);
        at(b0, b1, b2) / at(1.0, -2.0 * biquad.pole.real, biquad.pole.square())
    };
    let holds = |omega: f64| {
        let loops: f64 = biquads.iter().map(|biquad| magnitude(biquad, omega)).sum();
        let mut largest = 0.0f64;
        for (index, here) in path.clone().enumerate() {
            let next = path.clone().nth(index + 1).unwrap_or(here);
            for part in 0..4 {
                let at = |from: f64, to: f64| from + (to - from) * f64::from(part) / 4.0;
                let point =
                    Breakpoint { b0: at(here.b0, next.b0), b1: at(here.b1, next.b1), a1: at(here.a1, next.a1), ..here };
                largest = largest.max(response(&point, omega));
            }
        }
        let gain = largest * loops;
        let frequency_hz = omega * rate.hz() / TAU;
        if gain < 1.0 { Ok(()) } else { Err(LoopError::Unstable { frequency_hz, gain }) }
    };
    for biquad in biquads {
        let omega = libm::atan2(biquad.pole.imaginary, biquad.pole.real);
        let width = 1.0 - libm::sqrt(biquad.pole.square());
        for step in -8i32..=8 {
            holds((omega + f64::from(step) / 4.0 * width).clamp(0.0, PI))?;
        }
    }
    (0..256).try_for_each(|step| holds((f64::from(step) + 0.5) / 256.0 * PI))
}
