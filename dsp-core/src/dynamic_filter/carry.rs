//! Coefficients at another sample rate, by the bilinear transformation there and back.
//!
//! Let `w = z⁻¹` at the table's rate f0, `v = z⁻¹` at the rate fs, and `κ = fs/f0`. Then
//! `w = ((1 - κ) + (1 + κ) v) / ((1 + κ) + (1 - κ) v)`. This maps the inside of the unit circle
//! onto itself, so that a stable filter stays stable.

use super::settings::Breakpoint;

impl Breakpoint {
    /// Returns the breakpoint for a rate that is `ratio` times the rate it was made for.
    ///
    /// `order` is 1 or 2. At ratio 1 the breakpoint is returned unchanged.
    pub fn carried(self, order: u8, ratio: f64) -> Self {
        if ratio == 1.0 {
            return self;
        }
        // Denominator and numerator in w, times (A + B v)^order with A = 1 + κ, B = 1 - κ.
        let (a, b) = (1.0 + ratio, 1.0 - ratio);
        let terms = |c0: f64, c1: f64, c2: f64| match order {
            1 => [c0 * a + c1 * b, c0 * b + c1 * a, 0.0],
            _ => [
                c0 * a * a + c1 * a * b + c2 * b * b,
                2.0 * a * b * (c0 + c2) + c1 * (a * a + b * b),
                c0 * b * b + c1 * a * b + c2 * a * a,
            ],
        };
        let [d0, d1, d2] = terms(1.0, self.a1, self.a2);
        let [n0, n1, n2] = terms(self.b0, self.b1, self.b2);
        // A zero at -1 stays at -1. It does so exactly, so that eq. 17 is still recognised.
        let n1 = if order == 1 && self.b1 == self.b0 { n0 } else { n1 };
        Self { a1: d1 / d0, a2: d2 / d0, b0: n0 / d0, b1: n1 / d0, b2: n2 / d0, ..self }
    }
}
