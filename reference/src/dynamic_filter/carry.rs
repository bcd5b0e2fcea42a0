//! Conversion of coefficients to another sample rate, by the bilinear transformation.

use super::breakpoint::Breakpoint;

impl Breakpoint {
    /// Coefficients for a rate `ratio` times as high.
    ///
    /// `z⁻¹` is replaced by `(1 - x) / (1 + x)`, `x = ratio (1 - z⁻¹) / (1 + z⁻¹)`.
    pub fn at_ratio(&self, ratio: f64) -> Self {
        // (1 + x)(1 + v) and (1 - x)(1 + v), as polynomials of v = z⁻¹.
        let plus = [1.0 + ratio, 1.0 - ratio];
        let minus = [1.0 - ratio, 1.0 + ratio];
        let product = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[1] * b[1]];
        let of = |c: [f64; 3]| {
            let terms = [product(plus, plus), product(plus, minus), product(minus, minus)];
            std::array::from_fn::<f64, 3, _>(|power| c.iter().zip(terms).map(|(c, term)| c * term[power]).sum())
        };
        let above = of([self.b0, self.b1, self.b2]);
        let below = of([1.0, self.a1, self.a2]);
        // A first-order filter keeps a common factor (1 + x)(1 + v), whose root is divided out.
        let divide = |c: [f64; 3]| {
            let first = c[0] / plus[0];
            [first, (c[1] - first * plus[1]) / plus[0], 0.0]
        };
        let first_order = self.a2 == 0.0 && self.b2 == 0.0;
        let (above, below) = if first_order { (divide(above), divide(below)) } else { (above, below) };
        let [b0, b1, b2] = above.map(|c| c / below[0]);
        let [_, a1, a2] = below.map(|c| c / below[0]);
        Self { time_s: self.time_s, noise: self.noise, a1, a2, b0, b1, b2 }
    }
}
