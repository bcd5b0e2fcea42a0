//! Contribution of one pole to one stretch of sound: its response `u`, and the derivative
//! `v = ∂u/∂(ln z)`.
//!
//! Ringing freely, `u = zⁿ` and `v = n zⁿ`. Under a known force F of M samples, `u = F ⊗ zⁿ`. Its
//! first M samples are stored (the head). A free decay follows, `u[M+i] = U zⁱ`,
//! `v[M+i] = (V + i U) zⁱ` (the tail), whose inner products need no samples.

use nalgebra::Complex;

use super::pole::{Pole, add_ringing, project};
use super::power_sums::power_sums;

/// A stretch of sound in which modes ring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch<'a> {
    /// Samples of the sound.
    pub(crate) samples: &'a [f64],
    /// Force that drives the modes from the first sample on, at most as long as the sound.
    ///
    /// `None` if the modes ring freely.
    pub(crate) force: Option<&'a [f64]>,
}

impl<'a> Stretch<'a> {
    pub(crate) fn ringing(samples: &'a [f64]) -> Self {
        Self { samples, force: None }
    }

    pub(crate) fn energy(&self) -> f64 {
        self.samples.iter().map(|x| x * x).sum()
    }

    fn head_length(&self) -> usize {
        self.force.map_or(0, |force| force.len().min(self.samples.len()))
    }
}

/// Response of a pole within a stretch.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    pub(crate) pole: Pole,
    head_u: Vec<Complex<f64>>,
    head_v: Vec<Complex<f64>>,
    tail_u: Complex<f64>,
    tail_v: Complex<f64>,
    tail_length: usize,
}

/// Inner products of the responses of two poles a and b: u with u, u with v, v with u, v with v.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Products {
    pub(crate) uu: Pair,
    pub(crate) uv: Pair,
    pub(crate) vu: Pair,
    pub(crate) vv: Pair,
}

/// A pair of inner products, `[Σ a b*, Σ a b]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair(Complex<f64>, Complex<f64>);

impl Pair {
    /// Real inner product `Σ Re(α a) Re(β b)`.
    pub(crate) fn real(self, alpha: Complex<f64>, beta: Complex<f64>) -> f64 {
        0.5 * (alpha * (beta.conj() * self.0 + beta * self.1)).re
    }
}

impl Basis {
    pub(crate) fn new(pole: Pole, stretch: &Stretch<'_>) -> Self {
        let zero = Complex::new(0.0, 0.0);
        let length = stretch.head_length();
        let tail_length = stretch.samples.len() - length;
        let Some(force) = stretch.force else {
            let tail_u = Complex::new(1.0, 0.0);
            return Self { pole, head_u: vec![], head_v: vec![], tail_u, tail_v: zero, tail_length };
        };
        let z = pole.power(1.0);
        let (mut u, mut v) = (zero, zero);
        let (mut head_u, mut head_v) = (Vec::with_capacity(length), Vec::with_capacity(length));
        for &force in &force[..length] {
            v = z * (v + u);
            u = z * u + force;
            head_u.push(u);
            head_v.push(v);
        }
        Self { pole, head_u, head_v, tail_u: z * u, tail_v: z * (v + u), tail_length }
    }

    /// The response at the first sample after the force.
    pub(crate) fn after_force(&self) -> Complex<f64> {
        self.tail_u
    }

    /// The response from sample `from` on, which must lie after the force.
    pub(crate) fn later(&self, from: usize, length: usize) -> Self {
        let since = from.saturating_sub(self.head_u.len()) as f64;
        let power = self.pole.power(since);
        Self {
            pole: self.pole,
            head_u: vec![],
            head_v: vec![],
            tail_u: power * self.tail_u,
            tail_v: power * (self.tail_v + self.tail_u * since),
            tail_length: length,
        }
    }

    /// Inner products `[Σ x u, Σ x v]` with samples x.
    pub(crate) fn project(&self, samples: &[f64]) -> [Complex<f64>; 2] {
        let (head, tail) = samples.split_at(self.head_u.len());
        let [plain, ramp] = project(self.pole, tail);
        let mut sums = [self.tail_u * plain, self.tail_v * plain + self.tail_u * ramp];
        for ((x, u), v) in head.iter().zip(&self.head_u).zip(&self.head_v) {
            sums[0] += u * *x;
            sums[1] += v * *x;
        }
        sums
    }

    /// Inner products `[Σ F u, Σ F v]` with the force F.
    pub(crate) fn along_force(&self, force: &[f64]) -> [Complex<f64>; 2] {
        let mut sums = [Complex::new(0.0, 0.0); 2];
        for ((force, u), v) in force.iter().zip(&self.head_u).zip(&self.head_v) {
            sums[0] += u * *force;
            sums[1] += v * *force;
        }
        sums
    }

    /// Adds `Re(gain u)` to the samples.
    pub(crate) fn add(&self, gain: Complex<f64>, samples: &mut [f64]) {
        let (head, tail) = samples.split_at_mut(self.head_u.len());
        for (x, u) in head.iter_mut().zip(&self.head_u) {
            *x += (gain * u).re;
        }
        add_ringing(self.pole, gain * self.tail_u, tail);
    }

    /// All inner products with another pole's response in the same stretch.
    pub(crate) fn products(&self, other: &Self) -> Products {
        let (z, w) = (self.pole.power(1.0), other.pole.power(1.0));
        let (ua, va) = (self.tail_u, self.tail_v);
        let tail = |w, ub: Complex<f64>, vb: Complex<f64>| {
            let [s0, s1, s2] = power_sums(z * w, self.tail_length);
            [
                ua * ub * s0,
                ua * (vb * s0 + ub * s1),
                ub * (va * s0 + ua * s1),
                va * vb * s0 + (va * ub + ua * vb) * s1 + ua * ub * s2,
            ]
        };
        let mut conjugate = tail(w.conj(), other.tail_u.conj(), other.tail_v.conj());
        let mut plain = tail(w, other.tail_u, other.tail_v);
        for (((ua, va), ub), vb) in self.head_u.iter().zip(&self.head_v).zip(&other.head_u).zip(&other.head_v) {
            let factors = [(ua, ub), (ua, vb), (va, ub), (va, vb)];
            for ((conjugate, plain), (a, b)) in conjugate.iter_mut().zip(&mut plain).zip(factors) {
                *conjugate += a * b.conj();
                *plain += a * b;
            }
        }
        Products {
            uu: Pair(conjugate[0], plain[0]),
            uv: Pair(conjugate[1], plain[1]),
            vu: Pair(conjugate[2], plain[2]),
            vv: Pair(conjugate[3], plain[3]),
        }
    }
}
