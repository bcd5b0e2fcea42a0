//! Parallel chains of biquads in `f64` (*Differentiable Modal Synthesis for Physical Modeling of
//! Planar Objects*, "diffmodal", eq. 2 and 3).

use std::f64::consts::PI;

/// A biquad section `(b0 + b1 z⁻¹ + b2 z⁻²) / (1 + a1 z⁻¹ + a2 z⁻²)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biquad {
    /// Coefficients b0, b1, b2.
    pub numerator: [f64; 3],
    /// Coefficients a1, a2: `-2 Re p` and `|p|²` of the conjugate poles.
    pub denominator: [f64; 2],
}

impl Biquad {
    /// Biquad of eq. 2: pole `p = (re, im)` and zero `q`, each with its conjugate, and gain k.
    pub fn from_roots(pole: (f64, f64), zero: (f64, f64), gain: f64) -> Self {
        let square = |(re, im): (f64, f64)| re * re + im * im;
        Self {
            numerator: [gain, -2.0 * gain * zero.0, gain * square(zero)],
            denominator: [-2.0 * pole.0, square(pole)],
        }
    }

    /// Biquad of [`from_roots`](Self::from_roots), carried to a sample rate `1/ratio` times as
    /// high.
    ///
    /// Each root r e^{±iα}, α from 0 to π, becomes `r^ratio e^{±i min(ratio α, π)}`. It keeps its
    /// frequency in hertz, up to half the new rate, and its decay per second. k is scaled so that
    /// |H| at the pole's angle stays. If |H| nearly vanishes at that angle before or after, k is
    /// left as it is. That is the case if the product of the zeros' distances from that point of
    /// the unit circle is below 1e-6.
    pub fn carried(pole: (f64, f64), zero: (f64, f64), gain: f64, ratio: f64) -> Self {
        if ratio == 1.0 {
            return Self::from_roots(pole, zero, gain);
        }
        let polar = |(re, im): (f64, f64)| (re.hypot(im), im.abs().atan2(re));
        let moved = |(radius, angle): (f64, f64)| (radius.powf(ratio), (angle * ratio).min(PI));
        let cartesian = |(radius, angle): (f64, f64)| (radius * angle.cos(), radius * angle.sin());
        let (old_pole, old_zero) = (polar(pole), polar(zero));
        let (new_pole, new_zero) = (moved(old_pole), moved(old_zero));
        // |1 - r e^{i(α - θ)}| |1 - r e^{i(α + θ)}|: distances from the unit circle at θ.
        let distances = |(radius, angle): (f64, f64), theta: f64| -> f64 {
            let distance = |between: f64| (1.0 - radius).hypot(2.0 * radius.sqrt() * (between / 2.0).sin());
            distance(angle - theta) * distance(angle + theta)
        };
        let (before, after) = (distances(old_zero, old_pole.1), distances(new_zero, new_pole.1));
        let of_poles = distances(new_pole, new_pole.1) / distances(old_pole, old_pole.1);
        let same = if before < 1e-6 || after < 1e-6 { 1.0 } else { before / after * of_poles };
        Self::from_roots(cartesian(new_pole), cartesian(new_zero), gain * same)
    }

    /// Filters `input` from rest, by the difference equation.
    pub fn filter(&self, input: &[f64]) -> Vec<f64> {
        let ([b0, b1, b2], [a1, a2]) = (self.numerator, self.denominator);
        let (mut x1, mut x2, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0);
        let step = |&x: &f64| {
            let y = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
            (x2, x1, y2, y1) = (x1, x, y1, y);
            y
        };
        input.iter().map(step).collect()
    }

    /// Radius of the pole that decays more slowly.
    pub fn radius(&self) -> f64 {
        let [a1, a2] = self.denominator;
        let rest = a1 * a1 / 4.0 - a2;
        // The product of a conjugate pair is the square of its radius. Rounding can split a double
        // pole in two.
        if rest <= 1e-12 * a2.abs() { a2.max(0.0).sqrt() } else { a1.abs() / 2.0 + rest.sqrt() }
    }

    /// Magnitude `|H|` at an angle in radians a sample.
    pub fn magnitude(&self, angle: f64) -> f64 {
        let at = |[c0, c1, c2]: [f64; 3]| {
            let re = c0 + c1 * angle.cos() + c2 * (2.0 * angle).cos();
            let im = c1 * angle.sin() + c2 * (2.0 * angle).sin();
            re.hypot(im)
        };
        let [a1, a2] = self.denominator;
        at(self.numerator) / at([1.0, a1, a2])
    }
}

/// Sum of the outputs of all chains for `input`, from rest (eq. 3).
pub fn filter(chains: &[Vec<Biquad>], input: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; input.len()];
    for chain in chains {
        let out = chain.iter().fold(input.to_vec(), |signal, biquad| biquad.filter(&signal));
        sum.iter_mut().zip(out).for_each(|(sum, y)| *sum += y);
    }
    sum
}
