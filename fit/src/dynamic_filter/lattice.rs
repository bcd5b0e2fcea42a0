//! Filters that stay stable, and loadable, whatever a search does to their numbers.

use dsp_core::dynamic_filter::path::{MAX_POLE, MIN_POLE};

use super::{Coefficients, Form};

/// Numbers of a search stay within plus and minus this: hyperbolic tangents up to 0.9999.
pub(crate) const WIDEST: f64 = 5.0;
/// Conjugate poles keep so much of their angle's cosine: where they meet, their parts grow without bound.
const APART: f64 = 0.999;
/// A real pole is at the middle of the range of poles, give or take half its length.
const MIDDLE: f64 = 0.5 * (MAX_POLE + MIN_POLE);
const HALF: f64 = 0.5 * (MAX_POLE - MIN_POLE);

impl Form {
    /// The shapes in which a form is sought, one path after the other: the last of each list, from those before it.
    pub(crate) fn shapes(self) -> &'static [&'static [Shape]] {
        match self {
            Self::FirstOrder => &[&[Shape::FirstOrder]],
            Self::OnePoleOneZero => &[&[Shape::FirstOrder, Shape::OnePoleOneZero], &[Shape::OnePoleOneZero]],
            Self::SecondOrder => {
                &[&[Shape::FirstOrder, Shape::RealPoles], &[Shape::RealPoles], &[Shape::ConjugatePoles]]
            }
        }
    }
}

/// What a path keeps all along: the instrument has a form for each, and no way from real to conjugate poles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// One pole, a zero at half the rate (eq. 17).
    FirstOrder,
    /// One pole, one zero.
    OnePoleOneZero,
    /// Two real poles, two zeros.
    RealPoles,
    /// Two conjugate poles, two zeros.
    ConjugatePoles,
}

/// A filter as free numbers: the logarithm of its gain, then its poles, then the inverse hyperbolic tangents of the reflection coefficients of
/// its zeros.
///
/// `A(z) = 1 + k1(1 + k2) z^-1 + k2 z^-2` has its roots inside the unit circle for |k1|, |k2| < 1: so the numerator's, which magnitude alone
/// cannot tell from their mirror images. Poles stay where the instrument can hold them, which is inside the unit circle (eq. 21).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lattice {
    shape: Shape,
    /// ln gain, then the numbers that the shape leaves free.
    pub(crate) free: Vec<f64>,
}

impl Lattice {
    /// A nearly flat filter of some gain, but for a zero at half the rate where the shape has it.
    pub(crate) fn flat(shape: Shape, gain: f64) -> Self {
        let count = match shape {
            Shape::FirstOrder => 2,
            Shape::OnePoleOneZero => 3,
            Shape::RealPoles | Shape::ConjugatePoles => 5,
        };
        let mut free = vec![0.0; count];
        free[0] = gain.max(f64::MIN_POSITIVE).ln();
        Self { shape, free }
    }

    /// With free numbers as they are.
    pub(crate) fn of(shape: Shape, free: Vec<f64>) -> Self {
        Self { shape, free }
    }

    /// The same filter in a shape that holds all numbers of its own; in any other, a flat one.
    pub(crate) fn within(&self, shape: Shape) -> Self {
        let at = |index: usize| self.free.get(index).copied().unwrap_or(0.0);
        // A second pole at 0.
        let none = (MIDDLE / HALF).atanh();
        let free = match (self.shape, shape) {
            (from, to) if from == to => self.free.clone(),
            (Shape::FirstOrder, Shape::OnePoleOneZero) => vec![at(0), at(1), WIDEST],
            (Shape::FirstOrder, Shape::RealPoles) => vec![at(0), at(1), none, WIDEST, 0.0],
            (Shape::OnePoleOneZero, Shape::RealPoles) => vec![at(0), at(1), none, at(2), 0.0],
            (_, _) => return Self::flat(shape, at(0).exp()),
        };
        Self { shape, free }
    }

    /// The shape.
    pub(crate) fn shape(&self) -> Shape {
        self.shape
    }

    /// a1, a2; a number that rises turns a low-pass into a high-pass.
    fn denominator(&self) -> [f64; 2] {
        let at = |index: usize| (-self.free.get(index).copied().unwrap_or(0.0)).tanh();
        let pole = |index: usize| MIDDLE + HALF * at(index);
        match self.shape {
            Shape::FirstOrder | Shape::OnePoleOneZero => [-pole(1), 0.0],
            Shape::RealPoles => [-(pole(1) + pole(2)), pole(1) * pole(2)],
            Shape::ConjugatePoles => {
                let radius = 0.5 * MAX_POLE * (1.0 - at(2));
                [-2.0 * radius * APART * at(1), radius * radius]
            }
        }
    }

    /// Reflection coefficients of the numerator.
    fn zeros(&self) -> [f64; 2] {
        let at = |index: usize| self.free.get(index).copied().unwrap_or(0.0).tanh();
        match self.shape {
            Shape::FirstOrder => [1.0, 0.0],
            Shape::OnePoleOneZero => [at(2), 0.0],
            Shape::RealPoles | Shape::ConjugatePoles => [at(3), at(4)],
        }
    }

    /// The filter's coefficients.
    pub(crate) fn coefficients(&self) -> Coefficients {
        let [m1, m2] = self.zeros();
        let gain = self.free.first().copied().unwrap_or(f64::NEG_INFINITY).exp();
        Coefficients { a: self.denominator(), b: [gain, gain * m1 * (1.0 + m2), gain * m2] }
    }

    /// `|F|²` over cos ω.
    pub(crate) fn squared(&self) -> impl Fn(f64) -> f64 + use<> {
        squared(&self.coefficients())
    }
}

/// `|F|²` over cos ω.
pub(crate) fn squared(coefficients: &Coefficients) -> impl Fn(f64) -> f64 + use<> {
    let polynomial = |[c0, c1, c2]: [f64; 3]| [c0 * c0 + c1 * c1 + c2 * c2, 2.0 * c1 * (c0 + c2), 2.0 * c0 * c2];
    let [n0, n1, n2] = polynomial(coefficients.b);
    let [d0, d1, d2] = polynomial([1.0, coefficients.a[0], coefficients.a[1]]);
    move |once: f64| {
        let twice = 2.0 * once * once - 1.0;
        ((n0 + n1 * once + n2 * twice) / (d0 + d1 * once + d2 * twice)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::response::response;
    use super::*;

    #[test]
    fn any_numbers_give_a_stable_filter_of_the_magnitude_that_they_say() {
        let mut random = crate::synthetic::SplitMix64(3);
        for shape in [Shape::FirstOrder, Shape::OnePoleOneZero, Shape::RealPoles, Shape::ConjugatePoles] {
            for _ in 0..200 {
                let mut lattice = Lattice::flat(shape, 0.3);
                lattice.free[1..].iter_mut().for_each(|x| *x = WIDEST * (2.0 * random.uniform() - 1.0));
                let coefficients = lattice.coefficients();
                let [a1, a2] = coefficients.a;
                assert!(a2.abs() < 1.0 && a1.abs() < 1.0 + a2, "{coefficients:?}");
                assert_eq!(a1 * a1 < 4.0 * a2, shape == Shape::ConjugatePoles);
                let angular = std::f64::consts::PI * random.uniform();
                let expected = response(&coefficients, angular).norm_sqr();
                assert!((lattice.squared()(angular.cos()) - expected).abs() <= 1e-6 * expected + 1e-12);
            }
        }
    }
}
