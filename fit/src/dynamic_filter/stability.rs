//! Whether loops round a filter decay: `|F| Σ|B_s| < 1` at every frequency, all along the path.

use std::f64::consts::TAU;

use nalgebra::Complex;
use reference::waveguide::Tuned;

use super::lattice::squared;
use super::sound::RATE;
use super::{Coefficients, Loop, Path, RATE_HZ};

/// `|F| Σ|B_s|` stays below this at every frequency and time: less than 1 by what the way between breakpoints may add.
pub const MOST_LOOP_GAIN: f64 = 0.998;
/// Frequencies of the condition, beside those round each loop.
const FREQUENCIES: usize = 512;

/// `B_s D_s` at ω in radians a sample.
pub(crate) fn through(tuned: &Tuned, angular: f64) -> Complex<f64> {
    band_pass(tuned, angular) * Complex::from_polar(1.0, -angular * tuned.delay as f64)
}

/// `B_s`, with the fraction of the delay in its numerator.
fn band_pass(tuned: &Tuned, angular: f64) -> Complex<f64> {
    let late = Complex::from_polar(1.0, -angular);
    let ([c0, c1], [c3, c4]) = (tuned.numerator, tuned.denominator);
    (late * c1 + c0) / (late * (late * c4 + c3) + 1.0)
}

/// Largest `|F| Σ|B_s|` over frequencies and a path's breakpoints and places between them.
pub fn loop_gain(path: &Path, loops: &[Loop]) -> f64 {
    gain_of(&filters_of(path), loops)
}

/// Between breakpoints as many filters as the instrument looks at on load.
fn filters_of(path: &Path) -> Vec<Coefficients> {
    let between = path.points.windows(2).flat_map(|pair| {
        let parts = [0.25, 0.5, 0.75];
        parts.map(|part| match pair {
            [from, to] => from.coefficients.towards(&to.coefficients, part),
            _ => Coefficients::default(),
        })
    });
    path.points.iter().map(|point| point.coefficients).chain(between).collect()
}

fn gain_of(filters: &[Coefficients], loops: &[Loop]) -> f64 {
    let tuned: Vec<Tuned> = loops.iter().map(|guide| guide.exact().tuned(RATE)).collect();
    let wide = (1..FREQUENCIES).map(|at| 0.5 * RATE_HZ * (at as f64 / FREQUENCIES as f64).powi(2));
    let near = loops
        .iter()
        .flat_map(|guide| (-16..=16).map(|step| guide.frequency_hz + 0.25 * f64::from(step) * guide.bandwidth_hz));
    let inside = wide.chain(near).filter(|frequency| (0.0..0.5 * RATE_HZ).contains(frequency));
    let gain = |frequency_hz: f64| {
        let angular = TAU * frequency_hz / RATE_HZ;
        let of_loops: f64 = tuned.iter().map(|tuned| band_pass(tuned, angular).norm()).sum();
        let squared = filters.iter().map(|filter| squared(filter)(angular.cos()));
        squared.fold(0.0, f64::max).sqrt() * of_loops
    };
    inside.map(gain).fold(0.0, f64::max)
}

/// Lowers gains until the loops are stable: each alone, then all together.
pub(crate) fn stabilise(path: &Path, loops: &mut [Loop]) {
    let filters = filters_of(path);
    for guide in loops.iter_mut() {
        let gain = gain_of(&filters, std::slice::from_ref(guide));
        if gain > MOST_LOOP_GAIN {
            guide.gain *= MOST_LOOP_GAIN / gain;
        }
    }
    let gain = gain_of(&filters, loops);
    if gain > MOST_LOOP_GAIN {
        loops.iter_mut().for_each(|guide| guide.gain *= MOST_LOOP_GAIN / gain);
    }
}
