//! Rendering of a model in `f64` at 48 kHz.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::model::{Coefficients, Loop, Model, RATE_HZ};
use crate::random::SplitMix64;

/// Renders one strike of a model at the reference force: `length` samples at 48 kHz.
///
/// Eq. 12 and 13 with coefficients interpolated at each sample. The noise of `seed` and the loops'
/// outputs go through the filter; the modes are added to its output.
pub fn render(model: &Model, length: usize, seed: u64) -> Vec<f64> {
    let mut random = SplitMix64(seed);
    let mut loops: Vec<Feedback> = model.loops.iter().map(Feedback::new).collect();
    let mut sound: Vec<f64> = Vec::with_capacity(length);
    let (mut inputs, mut outputs) = ([0.0; 2], [0.0; 2]);
    for n in 0..length {
        let time_s = n as f64 / RATE_HZ;
        let level = model.path.noise_at(time_s);
        let noise = if level > 0.0 { level * (2.0 * random.uniform() - 1.0) } else { 0.0 };
        let input = noise + loops.iter_mut().map(|feedback| feedback.next(&sound)).sum::<f64>();
        let Coefficients { a: [a1, a2], b: [b0, b1, b2] } = model.path.at(time_s);
        let output = b0 * input + b1 * inputs[0] + b2 * inputs[1] - a1 * outputs[0] - a2 * outputs[1];
        inputs = [input, inputs[0]];
        outputs = [output, outputs[0]];
        sound.push(output);
    }
    model.modes.iter().for_each(|mode| mode.add_to(&mut sound, RATE_HZ));
    sound
}

/// Delay and band-pass of a loop (eq. 8 to 11).
struct Feedback {
    /// Delay in whole samples.
    delay: usize,
    /// Numerator of the band-pass.
    ///
    /// It gives the gain at the centre, and the phase of the delay's fraction.
    numerator: [f64; 2],
    denominator: [f64; 2],
    before: [f64; 2],
}

impl Feedback {
    fn new(guide: &Loop) -> Self {
        let delay = (guide.delay_s * RATE_HZ).max(1.0);
        let whole = delay.floor();
        let angular = TAU * guide.frequency_hz / RATE_HZ;
        // Eq. 11 prints Q = Δf/f_c; with f_c/Δf the width is Δf.
        let tau = angular.sin() * guide.bandwidth_hz / (2.0 * guide.frequency_hz);
        let denominator = [-2.0 * angular.cos() / (1.0 + tau), (1.0 - tau) / (1.0 + tau)];
        let late = Complex::from_polar(1.0, -angular);
        let at_centre = late * (late * denominator[1] + denominator[0]) + 1.0;
        let wanted = at_centre * Complex::from_polar(guide.gain, -angular * (delay - whole));
        let second = -wanted.im / angular.sin();
        let numerator = [wanted.re - second * angular.cos(), second];
        Self { delay: whole as usize, numerator, denominator, before: [0.0; 2] }
    }

    /// Next output of the loop, from the filter's output so far.
    fn next(&mut self, sound: &[f64]) -> f64 {
        let n = sound.len();
        let past = |ago: usize| n.checked_sub(ago).and_then(|at| sound.get(at)).copied().unwrap_or(0.0);
        let [n0, n1] = self.numerator;
        let [d1, d2] = self.denominator;
        let now = n0 * past(self.delay) + n1 * past(self.delay + 1) - d1 * self.before[0] - d2 * self.before[1];
        self.before = [now, self.before[0]];
        now
    }
}

#[cfg(test)]
mod tests {
    use super::super::model::{Breakpoint, Path};
    use super::*;

    #[test]
    fn noises_of_neighbouring_seeds_are_uncorrelated() {
        let point =
            |time_s| Breakpoint { time_s, coefficients: Coefficients { a: [0.0; 2], b: [1.0, 0.0, 0.0] }, noise: 1.0 };
        let model = Model { path: Path { points: vec![point(0.0), point(1.0)] }, ..Model::default() };
        let [one, other] = [1, 2].map(|seed| render(&model, 20_000, seed));
        for shift in 0..50 {
            let product = |(a, b): (&f64, &f64)| a * b;
            let common = 3.0 * one.iter().skip(shift).zip(&other).map(product).sum::<f64>() / other.len() as f64;
            let back = 3.0 * other.iter().skip(shift).zip(&one).map(product).sum::<f64>() / one.len() as f64;
            // Between independent noises 0.007 is one standard deviation.
            assert!(common.abs().max(back.abs()) < 0.035, "{shift}: {common:.3}, {back:.3}");
        }
    }
}
