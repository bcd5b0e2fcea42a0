//! Coefficients between breakpoints: the instrument's forms move along straight lines, not the coefficients themselves.

use reference::dynamic_filter::{Breakpoint, Form};

use super::{Coefficients, Path};

impl Coefficients {
    /// 1 without a2 and b2, 2 with them.
    pub fn order(&self) -> u8 {
        if self.a[1] == 0.0 && self.b[2] == 0.0 { 1 } else { 2 }
    }

    /// Part of the way (0 to 1) to others in a straight line of the form's parameters (one pole; partial fractions of conjugate poles; real poles
    /// one behind the other): stable between stable ones. Between conjugate and real poles there is no way: then it stays.
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let order = self.order().max(other.order());
        let form = |coefficients: &Self| Form::of(order, &coefficients.at(0.0, 1.0));
        Self::of(&form(self).toward(&form(other), part))
    }

    /// As a breakpoint of the reference.
    fn at(&self, time_s: f64, noise: f64) -> Breakpoint {
        let ([a1, a2], [b0, b1, b2]) = (self.a, self.b);
        Breakpoint { time_s, noise, a1, a2, b0, b1, b2 }
    }

    /// The coefficients that a form stands for.
    fn of(form: &Form) -> Self {
        // n1 and n2 are those of H = b0 + (n1 w + n2 w²)/A(w).
        let with = |a: [f64; 2], [n1, n2]: [f64; 2], b0: f64| Self { a, b: [b0, n1 + a[0] * b0, n2 + a[1] * b0] };
        match *form {
            Form::First([b0, b1, a1]) => Self { a: [a1, 0.0], b: [b0, b1, 0.0] },
            Form::Conjugate([re, im, g_re, g_im, d]) => {
                with([-2.0 * re, re * re + im * im], [g_re, -g_re * re - g_im * im], d)
            }
            Form::Real([p1, p2, alpha, beta, d]) => with([-(p1 + p2), p1 * p2], [alpha, beta - p2 * alpha], d),
        }
    }
}

impl Path {
    /// 1, or 2 where a breakpoint has a2 or b2.
    pub fn order(&self) -> u8 {
        self.points.iter().map(|point| point.coefficients.order()).max().unwrap_or(1)
    }

    /// As the reference takes it.
    pub(crate) fn breakpoints(&self) -> Vec<Breakpoint> {
        self.points.iter().map(|point| point.coefficients.at(point.time_s, point.noise)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_begins_and_ends_where_it_should_and_its_middle_has_the_middle_of_the_poles() {
        let pair = |a: [f64; 2], b: [f64; 3]| Coefficients { a, b };
        for (from, to, pole) in [
            (pair([-0.9, 0.0], [0.2, 0.1, 0.0]), pair([-0.5, 0.0], [0.4, 0.3, 0.0]), [-0.7, 0.0]),
            // Poles 0.8 and 0.2, 0.6 and 0.4.
            (pair([-1.0, 0.16], [0.2, 0.1, 0.05]), pair([-1.0, 0.24], [0.3, -0.1, 0.02]), [-1.0, 0.21]),
            // Poles 0.5 ± 0.5i and 0.3 ± 0.7i.
            (pair([-1.0, 0.5], [0.2, 0.1, 0.05]), pair([-0.6, 0.58], [0.3, -0.1, 0.02]), [-0.8, 0.52]),
        ] {
            let apart = |x: &Coefficients, y: &Coefficients| {
                let pairs = x.a.iter().chain(&x.b).zip(y.a.iter().chain(&y.b));
                pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
            };
            assert!(apart(&from.towards(&to, 0.0), &from) < 1e-12 && apart(&from.towards(&to, 1.0), &to) < 1e-12);
            let middle = from.towards(&to, 0.5);
            assert!((middle.a[0] - pole[0]).abs() < 1e-12 && (middle.a[1] - pole[1]).abs() < 1e-12, "{middle:?}");
        }
    }
}
