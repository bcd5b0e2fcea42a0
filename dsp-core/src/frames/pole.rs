//! Place of a mode among the lines, and its turns and decays over blocks.

use super::numbers::HALF;
use super::{BLOCK_FRAMES, POINTS};
use crate::SampleRate;
use crate::{exponential, sine};

/// Complex number in `f64`, for the load.
pub(super) type Complex64 = [f64; 2];

/// Product of two complex numbers.
pub(super) fn times(x: Complex64, y: Complex64) -> Complex64 {
    [x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0]]
}

/// A mode's pole `z = e^{(-d + 2πi f)/fs}`, as frames use it.
#[derive(Clone, Copy, Debug)]
pub(super) struct FramePole {
    /// Line nearest to the frequency, 0 to N.
    pub(super) line: usize,
    /// Distance from the line in lines, -1/2 to 1/2.
    pub(super) distance: f64,
    /// Damping in lines: `d 2N/(2π fs)`.
    pub(super) damping: f64,
    /// Angle of z in turns.
    turns: f64,
    /// Decay a frame, in nepers.
    nepers: f64,
}

/// Largest damping of a mode in the lines. A faster one loses 115 dB within N frames, and only the
/// head plays it.
pub(super) const MAX_DAMPING: f64 = 4.2;

/// Largest damping of a mode whose head the lines make. Above, a recursion in `f32` does.
pub(super) const MAX_DAMPING_OF_HEAD: f64 = 0.25;

impl FramePole {
    /// Pole of a mode below Nyquist at a rate.
    pub(super) fn new(frequency_hz: f64, decay_per_s: f64, rate: SampleRate) -> Self {
        let fs = rate.hz();
        let place = frequency_hz * POINTS as f64 / fs;
        let line = libm::rint(place);
        let nepers = decay_per_s / fs;
        Self {
            line: line as usize,
            distance: place - line,
            damping: nepers * POINTS as f64 / core::f64::consts::TAU,
            turns: frequency_hz / fs,
            nepers,
        }
    }

    /// Power `z^n`.
    pub(super) fn power(&self, n: usize) -> Complex64 {
        let n = n as f64;
        let turns = self.turns * n;
        let angle = (turns - libm::floor(turns)) * core::f64::consts::TAU;
        let size = exponential::power_of_two(-self.nepers * n * core::f64::consts::LOG2_E);
        [size * sine::cos(angle), size * sine::sin(angle)]
    }

    /// Powers `z^(N/2)` and `z^N`.
    pub(super) fn powers(&self) -> [Complex64; 2] {
        let half = self.power(HALF);
        const { assert!(HALF * 2 == BLOCK_FRAMES) };
        [half, times(half, half)]
    }

    /// Sum `Σ_{n>=0} z^n = 1/(1 - z)`: the response to a constant force.
    pub(super) fn sum(&self) -> Complex64 {
        // 1 - z without cancellation: 1 - r cos θ = (1 - r) + 2 r sin²(θ/2).
        let gap = exponential::loss(self.nepers);
        let half_angle = self.turns * core::f64::consts::PI;
        let (sin, cos) = (sine::sin(half_angle), sine::cos(half_angle));
        let radius = 1.0 - gap;
        let [re, im] = [gap + 2.0 * radius * sin * sin, -2.0 * radius * sin * cos];
        let size = re * re + im * im;
        [re / size, -im / size]
    }
}
