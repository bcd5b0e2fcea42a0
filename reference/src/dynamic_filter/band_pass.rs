//! The exciter's band-pass, which each strike moves: two state-variable sections.
//!
//! Their state does not depend on the position of the band, so moving the band makes no click.

use std::f64::consts::PI;

use super::exciter::Exciter;
use crate::rate::SampleRate;

/// Trapezoidal state-variable filter: `v1` is its band-pass output, `v2` its low-pass output.
///
/// Its high-pass output is `x - k v1 - v2`.
#[derive(Clone, Copy, Debug, Default)]
struct Section {
    /// Magnitude of the pole, warped for the bilinear transformation.
    g: f64,
    /// Damping of the pole.
    k: f64,
    /// Factor on the input.
    input: f64,
    state: [f64; 2],
}

impl Section {
    fn step(&mut self, x: f64) -> [f64; 2] {
        let [c1, c2] = self.state;
        let below = 1.0 + self.g * (self.g + self.k);
        let v1 = (c1 + self.g * (x - c2)) / below;
        let v2 = c2 + self.g * v1;
        self.state = [2.0 * v1 - c1, 2.0 * v2 - c2];
        [v1, v2]
    }
}

/// Band-pass of an exciter in motion, from rest. It passes nothing before the first strike.
#[derive(Clone, Copy, Debug)]
pub struct BandPass {
    exciter: Exciter,
    rate: SampleRate,
    low: Section,
    high: Section,
    is_wide: bool,
}

impl BandPass {
    /// Band-pass at rest.
    pub fn new(exciter: Exciter, rate: SampleRate) -> Self {
        Self { exciter, rate, low: Section::default(), high: Section::default(), is_wide: false }
    }

    /// Moves the band to the edges for a strike of `level`. The present sound rings on in the moved
    /// band.
    ///
    /// A band narrower than its middle frequency is made of two band-passes. A wider one is a
    /// high-pass at the low pole and a low-pass at the high one.
    pub fn strike(&mut self, level: f64) {
        let [low, high] = self.exciter.edges_hz(level, self.rate).map(|hz| (PI * hz / self.rate.hz()).tan());
        let width = high - low;
        self.is_wide = width * width > low * high;
        let [high_pole, low_pole] = Exciter::poles(low, high);
        for (section, (re, im)) in [(&mut self.high, high_pole), (&mut self.low, low_pole)] {
            section.g = f64::hypot(re, im);
            section.k = -2.0 * re / section.g;
            section.input = width / (low * high).sqrt();
        }
        if self.is_wide {
            (self.low.input, self.high.input) = (1.0, (width / self.high.g).powi(2));
        }
    }

    /// Filters one sample.
    pub fn step(&mut self, x: f64) -> f64 {
        let x = self.low.input * x;
        let [v1, v2] = self.low.step(x);
        let x = if self.is_wide { x - self.low.k * v1 - v2 } else { v1 };
        let [v1, v2] = self.high.step(self.high.input * x);
        if self.is_wide { v2 } else { v1 }
    }

    /// Multiplies the state of both sections by `left`.
    pub fn attenuate(&mut self, left: f64) {
        for section in [&mut self.low, &mut self.high] {
            section.state = section.state.map(|c| left * c);
        }
    }
}
