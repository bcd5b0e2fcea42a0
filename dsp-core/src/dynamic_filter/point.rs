//! The poles and the magnitude response of the filter at a point of its path.

use super::limits::CARRIED;
use super::path::{Form, PARAMETERS, derive};
use super::settings::Breakpoint;
use crate::square_root::length;

/// The filter at a point of the path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) form: Form,
    pub(super) at: [f64; PARAMETERS],
}

impl Point {
    /// Interpolates the parameters at the fraction `part` of the way between two breakpoints.
    ///
    /// Gives `None` if either breakpoint is invalid.
    pub(super) fn between(order: u8, here: &Breakpoint, next: &Breakpoint, part: f64) -> Option<Self> {
        let (Ok(from), Ok(to)) = (derive(order, here, 0, CARRIED), derive(order, next, 0, CARRIED)) else {
            return None;
        };
        let mut at = from.parameters;
        at.iter_mut().zip(to.parameters).for_each(|(value, to)| *value += part * (to - *value));
        Some(Self { form: from.form, at })
    }

    /// Angles of the poles, and their distances from the unit circle.
    pub(super) fn poles(&self) -> [(f64, f64); 2] {
        let real = |pole: f64| (if pole < 0.0 { core::f64::consts::PI } else { 0.0 }, 1.0 - pole.abs());
        let [p0, p1, ..] = self.at;
        match self.form {
            Form::EqualZeros | Form::OnePole => [real(1.0 + p0); 2],
            Form::Conjugate => [(libm::atan2(p1.abs(), p0), 1.0 - length(p0, p1)); 2],
            Form::Real => [real(p0), real(p1)],
        }
    }

    /// Magnitude `|F|` of the filter's response at `w = cos - i sin`.
    pub(super) fn magnitude(&self, (cosine, sine): (f64, f64)) -> f64 {
        let w = (cosine, -sine);
        let one_less = |p: (f64, f64)| {
            let turned = times(p, w);
            (1.0 - turned.0, -turned.1)
        };
        let sum = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
        let [p0, p1, p2, p3, p4] = self.at;
        let response = match self.form {
            Form::EqualZeros | Form::OnePole => {
                // The next breakpoint may be of the other of these forms. Both have b1 as their
                // third parameter.
                over(sum((p1, 0.0), times((p2, 0.0), w)), one_less((1.0 + p0, 0.0)))
            }
            Form::Conjugate => {
                let half = |im: f64| {
                    let ring = over(times((p2 / 2.0, im * p3 / 2.0), w), one_less((p0, im * p1)));
                    sum(ring, (p4 / 2.0, 0.0))
                };
                sum(half(1.0), half(-1.0))
            }
            Form::Real => {
                let second = over(times((p3, 0.0), w), one_less((p1, 0.0)));
                let ring = times(over(w, one_less((p0, 0.0))), sum((p2, 0.0), second));
                sum(ring, (p4, 0.0))
            }
        };
        length(response.0, response.1)
    }
}

fn times(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn over(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let square = b.0 * b.0 + b.1 * b.1;
    times(a, (b.0 / square, -b.1 / square))
}
