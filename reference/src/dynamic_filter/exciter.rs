//! The exciter's band-pass: a fourth-order Butterworth whose edges follow the strike's level
//! (§III-C, D).

use crate::rate::SampleRate;

/// Band of the noise that excites a dynamic filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exciter {
    /// Lower edge (-3 dB) in Hz at level 1.
    pub low_hz: f64,
    /// Upper edge (-3 dB) in Hz at level 1.
    pub high_hz: f64,
    /// Exponent of the level: both edges are multiplied by `level^exponent`.
    pub exponent: f64,
}

impl Exciter {
    /// Edges in Hz for a level: 0.0001 fs to 0.49 fs, with a ratio of at least 1.05.
    pub fn edges_hz(&self, level: f64, rate: SampleRate) -> [f64; 2] {
        let fs = rate.hz();
        let factor = level.max(2f64.powi(-31)).powf(self.exponent);
        let high = (self.high_hz * factor).clamp(2e-4 * fs, 0.49 * fs);
        [(self.low_hz * factor).clamp(1e-4 * fs, high / 1.05), high]
    }

    /// Filters `input` by the band for a strike of `level`, from rest.
    ///
    /// The prototype's two poles go from low-pass to band-pass, each a biquad by the bilinear
    /// transformation.
    pub fn filter(&self, level: f64, input: &[f64], rate: SampleRate) -> Vec<f64> {
        let [low, high] = self.edges_hz(level, rate).map(|hz| (std::f64::consts::PI * hz / rate.hz()).tan());
        let width = high - low;
        Self::poles(low, high).into_iter().fold(input.to_vec(), |signal, (re, im)| {
            // B s / (s² + c s + ω²), s = (1 - z⁻¹) / (1 + z⁻¹).
            let (c, square) = (-2.0 * re, re * re + im * im);
            let a0 = 1.0 + c + square;
            let (b0, a1, a2) = (width / a0, 2.0 * (square - 1.0) / a0, (1.0 - c + square) / a0);
            let (mut x, mut y) = ([0.0; 2], [0.0; 2]);
            let step = |now: f64| {
                let out = b0 * (now - x[1]) - a1 * y[0] - a2 * y[1];
                (x, y) = ([now, x[0]], [out, y[0]]);
                out
            };
            signal.into_iter().map(step).collect()
        })
    }

    /// Poles with positive imaginary part of the band-pass between two warped edges.
    ///
    /// The one with the larger imaginary part is first.
    pub(super) fn poles(low: f64, high: f64) -> [(f64, f64); 2] {
        let (width, middle_squared) = (high - low, low * high);
        // s² - p B s + ω0² = 0 for p = (-1 + i)/√2: s = h ± √(h² - ω0²), h = p B / 2.
        let half = width / 8f64.sqrt();
        let (re, im) = (-middle_squared, -2.0 * half * half);
        let size = re.hypot(im);
        let root = (((size + re) / 2.0).max(0.0).sqrt(), -((size - re) / 2.0).sqrt());
        [-1.0, 1.0].map(|sign| (-half + sign * root.0, half + sign * root.1))
    }
}
