//! Filters as lattice parameters, which stay stable whatever values a search gives them.

use super::model::{Coefficients, Form};

/// Bound on the magnitude of a search's lattice parameters: reflection coefficients up to 0.9999.
pub(crate) const WIDEST: f64 = 5.0;

/// A filter as free numbers: ln of its gain, then artanh of the reflection coefficients.
///
/// `A(z) = 1 + k1(1 + k2) z^-1 + k2 z^-2` has its poles inside the unit circle for |k1|, |k2| < 1,
/// which is eq. 21 for the first order. The numerator is written in the same form; magnitude alone
/// cannot tell its zeros from their mirror images.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lattice {
    form: Form,
    /// Logarithm of the gain, then the lattice parameters of poles and zeros that the form leaves
    /// free.
    pub(crate) free: Vec<f64>,
}

impl Lattice {
    /// A flat filter of a gain; a form with a fixed zero at half the rate keeps that zero.
    pub(crate) fn flat(form: Form, gain: f64) -> Self {
        let count = match form {
            Form::FirstOrder => 2,
            Form::OnePoleOneZero => 3,
            Form::SecondOrder => 5,
        };
        let mut free = vec![0.0; count];
        free[0] = gain.max(f64::MIN_POSITIVE).ln();
        Self { form, free }
    }

    /// A filter from its free numbers.
    pub(crate) fn of(form: Form, free: Vec<f64>) -> Self {
        Self { form, free }
    }

    /// This filter in another form; exact if that form contains this one's.
    pub(crate) fn within(&self, form: Form) -> Self {
        let at = |index: usize| self.free.get(index).copied().unwrap_or(0.0);
        let free = match (self.form, form) {
            (from, to) if from == to => self.free.clone(),
            (Form::FirstOrder, Form::OnePoleOneZero) => vec![at(0), at(1), WIDEST],
            (Form::FirstOrder, Form::SecondOrder) => vec![at(0), at(1), 0.0, WIDEST, 0.0],
            (Form::OnePoleOneZero, Form::SecondOrder) => vec![at(0), at(1), 0.0, at(2), 0.0],
            (_, Form::FirstOrder) => vec![at(0), at(1)],
            (_, _) => vec![at(0), at(1), at(3)],
        };
        Self { form, free }
    }

    /// Form of the filter.
    pub(crate) fn form(&self) -> Form {
        self.form
    }

    /// Reflection coefficients `[k1, k2]` of the denominator and of the numerator.
    fn reflections(&self) -> ([f64; 2], [f64; 2]) {
        let at = |index: usize| self.free.get(index).copied().unwrap_or(0.0).tanh();
        match self.form {
            Form::FirstOrder => ([at(1), 0.0], [1.0, 0.0]),
            Form::OnePoleOneZero => ([at(1), 0.0], [at(2), 0.0]),
            Form::SecondOrder => ([at(1), at(2)], [at(3), at(4)]),
        }
    }

    /// Coefficients of the filter.
    pub(crate) fn coefficients(&self) -> Coefficients {
        let ([k1, k2], [m1, m2]) = self.reflections();
        let gain = self.free.first().copied().unwrap_or(f64::NEG_INFINITY).exp();
        Coefficients { a: [k1 * (1.0 + k2), k2], b: [gain, gain * m1 * (1.0 + m2), gain * m2] }
    }

    /// Squared magnitude `|F|²` as a function of ω in radians a sample.
    pub(crate) fn squared(&self) -> impl Fn(f64) -> f64 + use<> {
        squared(&self.coefficients())
    }
}

/// Squared magnitude `|F|²` as a function of ω in radians a sample, without complex numbers.
pub(crate) fn squared(coefficients: &Coefficients) -> impl Fn(f64) -> f64 + use<> {
    let polynomial = |[c0, c1, c2]: [f64; 3]| [c0 * c0 + c1 * c1 + c2 * c2, 2.0 * c1 * (c0 + c2), 2.0 * c0 * c2];
    let [n0, n1, n2] = polynomial(coefficients.b);
    let [d0, d1, d2] = polynomial([1.0, coefficients.a[0], coefficients.a[1]]);
    move |angular: f64| {
        let once = angular.cos();
        let twice = 2.0 * once * once - 1.0;
        ((n0 + n1 * once + n2 * twice) / (d0 + d1 * once + d2 * twice)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::response::response;
    use super::*;

    #[test]
    fn any_lattice_parameters_give_a_stable_filter_with_their_magnitude() {
        let mut random = crate::random::SplitMix64(3);
        for form in [Form::FirstOrder, Form::OnePoleOneZero, Form::SecondOrder] {
            for _ in 0..200 {
                let mut lattice = Lattice::flat(form, 0.3);
                lattice.free[1..].iter_mut().for_each(|x| *x = WIDEST * (2.0 * random.uniform() - 1.0));
                let coefficients = lattice.coefficients();
                let [a1, a2] = coefficients.a;
                assert!(a2.abs() < 1.0 && a1.abs() < 1.0 + a2, "{coefficients:?}");
                let angular = std::f64::consts::PI * random.uniform();
                let expected = response(&coefficients, angular).norm_sqr();
                assert!((lattice.squared()(angular) - expected).abs() <= 1e-6 * expected + 1e-12);
            }
        }
    }
}
