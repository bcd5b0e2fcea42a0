//! Functions that scale the descent's normalised numbers (appendix A of the paper).

/// Exponential sigmoid `upper · sigmoid(x + bias)^power + lower` (eq. 4, 6, 11 and 20).
#[derive(Clone, Copy, Debug)]
pub(super) struct ExpSigmoid {
    /// Upper bound, less the lower one.
    pub(super) upper: f64,
    /// Lower bound.
    pub(super) lower: f64,
    /// Bias that sets where the descent begins.
    pub(super) bias: f64,
}

/// Exponent λ of all exponential sigmoids. Eq. 20 prints it; eq. 4, 6 and 11 leave it open.
const POWER: f64 = std::f64::consts::LN_10;

impl ExpSigmoid {
    /// Value at x, and its derivative by x.
    pub(super) fn at(self, x: f64) -> (f64, f64) {
        let sigmoid = 1.0 / (1.0 + (-x - self.bias).exp());
        let value = self.upper * sigmoid.powf(POWER);
        (value + self.lower, value * POWER * (1.0 - sigmoid))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_sigmoid_has_the_derivative_that_it_states() {
        let scale = ExpSigmoid { upper: 3.0, lower: 0.1, bias: -1.5 };
        for x in [-4.0, -0.3, 0.0, 2.0, 9.0] {
            let difference = (scale.at(x + 1e-6).0 - scale.at(x - 1e-6).0) / 2e-6;
            let stated = scale.at(x).1;
            assert!((difference - stated).abs() < 1e-6 * stated.abs().max(1e-3), "{x}: {difference} {stated}");
        }
        assert!(scale.at(-60.0).0 < 0.1 + 1e-9 && scale.at(60.0).0 > 3.1 - 1e-9);
    }
}
