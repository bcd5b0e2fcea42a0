//! The exciter's band-pass while strikes move it: two state-variable sections, whose state does not depend on where the band is.

use std::f64::consts::PI;

use super::Exciter;
use crate::SampleRate;

/// A section: `v1` its band-pass, `v2` its low-pass, `x - k v1 - v2` its high-pass (trapezoidal state-variable filter).
#[derive(Clone, Copy, Debug, Default)]
struct Section {
    /// The pole's size, warped, and what it is damped by.
    g: f64,
    k: f64,
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

/// An exciter sounding, from rest; before the first strike it passes nothing.
#[derive(Clone, Copy, Debug)]
pub struct BandPass {
    exciter: Exciter,
    rate: SampleRate,
    low: Section,
    high: Section,
    is_wide: bool,
}

impl BandPass {
    /// At rest.
    pub fn new(exciter: Exciter, rate: SampleRate) -> Self {
        Self { exciter, rate, low: Section::default(), high: Section::default(), is_wide: false }
    }

    /// Moves the band to where a strike of a level has it. What rings, rings on in it.
    ///
    /// A band narrower than its middle frequency is two band-passes, a wider one a high-pass at the low pole and a low-pass at the high one.
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

    /// One sample.
    pub fn step(&mut self, x: f64) -> f64 {
        let x = self.low.input * x;
        let [v1, v2] = self.low.step(x);
        let x = if self.is_wide { x - self.low.k * v1 - v2 } else { v1 };
        let [v1, v2] = self.high.step(self.high.input * x);
        if self.is_wide { v2 } else { v1 }
    }

    /// Leaves so much of what rings.
    pub fn attenuate(&mut self, left: f64) {
        for section in [&mut self.low, &mut self.high] {
            section.state = section.state.map(|c| left * c);
        }
    }
}
