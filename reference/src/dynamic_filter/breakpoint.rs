//! Coefficients of the filter at a time after the strike.

/// Coefficients of the filter at a time after the strike.
///
/// `s(n) = b0 e(n) + b1 e(n-1) + b2 e(n-2) - a1 s(n-1) - a2 s(n-2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakpoint {
    /// Time in seconds after the strike.
    pub time_s: f64,
    /// Level of the noise, 0 to 1: it scales e(n), never the filter.
    pub noise: f64,
    /// Coefficient a1.
    pub a1: f64,
    /// Coefficient a2; 0 for the first order.
    pub a2: f64,
    /// Coefficient b0.
    pub b0: f64,
    /// Coefficient b1; eq. 17 has b1 = b0.
    pub b1: f64,
    /// Coefficient b2; 0 for the first order.
    pub b2: f64,
}

impl Default for Breakpoint {
    /// A breakpoint at 0 s with noise at its full level and coefficients of 0, which pass nothing.
    fn default() -> Self {
        Self { time_s: 0.0, noise: 1.0, a1: 0.0, a2: 0.0, b0: 0.0, b1: 0.0, b2: 0.0 }
    }
}

impl Breakpoint {
    /// Rms of the output for white noise of rms 1: `sqrt(Σ h²)`.
    pub(super) fn noise_gain(&self) -> f64 {
        let Self { a1, a2, b0, b1, b2, .. } = *self;
        // Variance of an ARMA(2, 2) process.
        let e = 1.0 + a2;
        let above =
            (b0 * b0 + b1 * b1 + b2 * b2) * e - 2.0 * (b0 * b1 + b1 * b2) * a1 + 2.0 * b0 * b2 * (a1 * a1 - a2 * e);
        let below = (1.0 - a2 * a2) * e - (1.0 - a2) * a1 * a1;
        (above / below).max(0.0).sqrt()
    }

    /// Radius of the slowest pole.
    pub(super) fn radius(&self) -> f64 {
        let rest = self.a1 * self.a1 - 4.0 * self.a2;
        if rest < 0.0 { self.a2.sqrt() } else { (self.a1.abs() + rest.sqrt()) / 2.0 }
    }
}
