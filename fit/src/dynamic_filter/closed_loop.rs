//! The filter with its loops at one moment: the gain round the loops, and the poles of the closed
//! loop.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::model::{Coefficients, Loop, RATE_HZ};

/// Delay and band-pass of a loop of gain 1 (eq. 8 to 11), as the instrument plays it.
///
/// `z^-D (a + c z^-1)/(1 - 2 real z^-1 + square z^-2)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BandPass {
    /// Delay D in whole samples.
    frames: i32,
    real: f64,
    square: f64,
    a: f64,
    c: f64,
}

impl BandPass {
    /// The loop with a centre and a width in Hz and a delay of `frames` whole samples.
    ///
    /// Its numerator makes the wave at the centre come back `phase` radians late.
    pub(crate) fn new(frequency_hz: f64, bandwidth_hz: f64, frames: f64, phase: f64) -> Self {
        let centre = TAU * frequency_hz / RATE_HZ;
        let tau = centre.sin() * bandwidth_hz / (2.0 * frequency_hz);
        let (real, square) = (centre.cos() / (1.0 + tau), (1.0 - tau) / (1.0 + tau));
        let late = Complex::from_polar(1.0, -centre);
        let below = late * (late * square - 2.0 * real) + 1.0;
        let wanted = below * Complex::from_polar(1.0, centre * frames - phase);
        let c = -wanted.im / centre.sin();
        Self { frames: frames as i32, real, square, a: wanted.re - c * centre.cos(), c }
    }

    /// The band-pass and delay of a loop of the model.
    pub(crate) fn of(guide: &Loop) -> Self {
        let delay = guide.delay_s * RATE_HZ;
        let phase = TAU * guide.frequency_hz * guide.delay_s;
        Self::new(guide.frequency_hz, guide.bandwidth_hz, delay.floor(), phase)
    }

    /// Response at `w = z^-1`, and the derivative of its logarithm by w.
    fn at(&self, w: Complex<f64>) -> (Complex<f64>, Complex<f64>) {
        let above = w * self.c + self.a;
        let below = w * (w * self.square - 2.0 * self.real) + 1.0;
        let slope = above.inv() * self.c - (w * (2.0 * self.square) - 2.0 * self.real) / below
            + w.inv() * f64::from(self.frames);
        (above / below * w.powi(self.frames), slope)
    }

    /// Magnitude of the response at ω in radians a sample.
    pub(crate) fn magnitude(&self, angular: f64) -> f64 {
        let w = Complex::from_polar(1.0, -angular);
        ((w * self.c + self.a) / (w * (w * self.square - 2.0 * self.real) + 1.0)).norm()
    }

    /// Response at ω in radians a sample.
    pub(crate) fn response(&self, angular: f64) -> Complex<f64> {
        self.at(Complex::from_polar(1.0, -angular)).0
    }
}

/// A resonance of the closed loop: `R/(s + α - jω)`, added to the direct path of the noise, which
/// is 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pole {
    /// Pole s in 1/s, for z = e^{s/rate}.
    pub(crate) s: Complex<f64>,
    /// Residue R in 1/s.
    pub(crate) residue: Complex<f64>,
}

impl Pole {
    /// The pole of `1/(1 - L)`, `L = F Σ γ_s B_s`, after `steps` of Newton's method from `start`.
    ///
    /// Newton's method runs on `1/L - 1`. For a single narrow band-pass that is a straight line in
    /// s, so that one step is exact.
    pub(crate) fn near(
        start: Complex<f64>,
        steps: usize,
        filter: &Coefficients,
        bands: &[BandPass],
        gains: &[f64],
    ) -> Self {
        let mut pole = Self { s: start, residue: Complex::new(0.0, 0.0) };
        for _ in 0..steps {
            let (round, slope) = round(pole.s, filter, bands, gains);
            pole.residue = -slope.inv();
            let step = round * (Complex::new(1.0, 0.0) - round) / slope;
            let most = 0.5 * start.norm();
            pole.s += if step.norm() > most { step * (most / step.norm()) } else { step };
        }
        pole
    }

    /// Decay rate α in 1/s.
    pub(crate) fn decay_per_s(&self) -> f64 {
        -self.s.re
    }
}

/// Open-loop response `L = F Σ γ_s B_s` at s, and dL/ds.
fn round(s: Complex<f64>, filter: &Coefficients, bands: &[BandPass], gains: &[f64]) -> (Complex<f64>, Complex<f64>) {
    let w = (s * (-1.0 / RATE_HZ)).exp();
    let ([b0, b1, b2], [a1, a2]) = (filter.b, filter.a);
    let (above, below) = (w * (w * b2 + b1) + b0, w * (w * a2 + a1) + 1.0);
    let filter_slope = (w * (2.0 * b2) + b1) / above - (w * (2.0 * a2) + a1) / below;
    let (mut sum, mut slope) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
    for (band, gain) in bands.iter().zip(gains) {
        let (response, by_w) = band.at(w);
        sum += response * *gain;
        slope += response * by_w * *gain;
    }
    let filter = above / below;
    (filter * sum, filter * (slope + sum * filter_slope) * w * (-1.0 / RATE_HZ))
}

#[cfg(test)]
mod tests {
    use super::super::delay::delay_s;
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_single_narrow_loop_has_the_pole_and_the_residue_of_its_width_and_gain() {
        let flat = Coefficients { a: [0.0; 2], b: [1.0, 0.0, 0.0] };
        for (frequency_hz, bandwidth_hz, gain) in [(440.0, 10.0, 0.9), (2055.0, 24.0, 0.6), (5963.0, 30.0, 0.97)] {
            let delay_s = delay_s(frequency_hz, 0.0);
            let band = BandPass::new(frequency_hz, bandwidth_hz, (delay_s * RATE_HZ).floor(), 0.0);
            let pole = Pole::near(Complex::new(0.0, TAU * frequency_hz), 5, &flat, &[band], &[gain]);
            let centre = TAU * frequency_hz / RATE_HZ;
            let beta = PI * bandwidth_hz * centre.sin() / centre;
            // The pole solves (β + s) = β γ e^{-s d} to first order in d.
            let slowed = beta / (1.0 + beta * gain * delay_s);
            assert!((pole.decay_per_s() / (slowed * (1.0 - gain)) - 1.0).abs() < 0.02, "{frequency_hz}: {pole:?}");
            assert!((pole.residue.re / (slowed * gain) - 1.0).abs() < 0.04, "{frequency_hz}: {pole:?}");
            assert!((pole.s.im / TAU - frequency_hz).abs() < 0.05 * bandwidth_hz, "{frequency_hz}: {pole:?}");
        }
    }
}
