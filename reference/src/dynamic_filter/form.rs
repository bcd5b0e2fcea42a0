//! Filter structures whose parameters are interpolated. Each is stable however its parameters
//! change.

use super::breakpoint::Breakpoint;

/// Parameters of a filter structure. In its equations `'` marks the sample before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// First order, `s = b0 e + b1 e' - a1 s'`: b0, b1, a1.
    First([f64; 3]),
    /// Conjugate poles, `z = p z' + g e'` (complex), `s = Re z + d e`: Re p, Im p, Re g, Im g, d.
    Conjugate([f64; 5]),
    /// Real poles, `z1 = p1 z1' + e'; z2 = p2 z2' + β z1'; s = d e + α z1 + z2`: p1, p2, α, β, d.
    Real([f64; 5]),
}

impl Form {
    /// Structure of a breakpoint: first order, or partial fractions for conjugate poles.
    ///
    /// Real poles follow one another, the larger first.
    pub fn of(order: u8, point: &Breakpoint) -> Self {
        let Breakpoint { a1, a2, b0, b1, b2, .. } = *point;
        if order == 1 {
            return Self::First([b0, b1, a1]);
        }
        let (n1, n2) = (b1 - a1 * b0, b2 - a2 * b0);
        let discriminant = a1 * a1 - 4.0 * a2;
        if discriminant < 0.0 {
            let (re, im) = (-a1 / 2.0, (-discriminant).sqrt() / 2.0);
            Self::Conjugate([re, im, n1, -(n2 + n1 * re) / im, b0])
        } else {
            let [p1, p2] = [1.0, -1.0].map(|sign| (-a1 + sign * discriminant.sqrt()) / 2.0);
            Self::Real([p1, p2, n1, n2 + p2 * n1, b0])
        }
    }

    /// Parameters a part (0 to 1) of the way to those of another structure of one kind.
    ///
    /// The result is `self` if the structures are of different kinds.
    pub fn toward(&self, other: &Self, part: f64) -> Self {
        fn mix<const N: usize>(a: &[f64; N], b: &[f64; N], part: f64) -> [f64; N] {
            std::array::from_fn(|i| a[i] + part * (b[i] - a[i]))
        }
        match (self, other) {
            (Self::First(a), Self::First(b)) => Self::First(mix(a, b, part)),
            (Self::Conjugate(a), Self::Conjugate(b)) => Self::Conjugate(mix(a, b, part)),
            (Self::Real(a), Self::Real(b)) => Self::Real(mix(a, b, part)),
            _ => *self,
        }
    }

    /// Filters one sample `e`; `last` is the sample before it.
    pub fn step(&self, state: &mut [f64; 2], last: f64, e: f64) -> f64 {
        let [x, y] = *state;
        match *self {
            Self::First([b0, b1, a1]) => {
                state[0] = b0 * e + b1 * last - a1 * x;
                state[0]
            }
            Self::Conjugate([re, im, g_re, g_im, d]) => {
                *state = [re * x - im * y + g_re * last, re * y + im * x + g_im * last];
                state[0] + d * e
            }
            Self::Real([p1, p2, alpha, beta, d]) => {
                *state = [p1 * x + last, p2 * y + beta * x];
                d * e + alpha * state[0] + state[1]
            }
        }
    }
}
