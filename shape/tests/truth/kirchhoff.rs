//! Thin rectangular plates: Ritz's method with products of polynomials.

use faer::{Mat, Side};

use super::line::{Line, product};
use super::ritz::sorted;

/// Edges of a thin plate, all alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Edges {
    Free,
    Clamped,
}

/// Thin rectangle whose axes are those of its material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ThinPlate {
    /// Extents, metres.
    pub(crate) size_m: [f64; 2],
    /// Stiffness D1, D12, D2 and D66 against bending and twist, N m.
    pub(crate) stiffness: [f64; 4],
    /// Mass per area, kg/m².
    pub(crate) mass: f64,
}

impl ThinPlate {
    /// Plate of an orthotropic material: moduli E1 and E2, Pa, contraction ν12, shear modulus, Pa.
    pub(crate) fn orthotropic(size_m: [f64; 2], thickness: f64, young: [f64; 2], poisson: f64, shear: f64) -> Self {
        let cube = thickness.powi(3) / 12.0;
        let rest = 1.0 - poisson * poisson * young[1] / young[0];
        let stiffness = [young[0] / rest, poisson * young[1] / rest, young[1] / rest, shear].map(|part| part * cube);
        Self { size_m, stiffness, mass: 8000.0 * thickness }
    }

    /// Frequencies in Hz of hinged plates, the lowest first: closed form.
    pub(crate) fn hinged(&self, count: usize) -> Vec<f64> {
        let [d1, d12, d2, d66] = self.stiffness;
        let waves = (1..60).flat_map(|m| (1..60).map(move |n| [f64::from(m), f64::from(n)]));
        let hz = |waves: [f64; 2]| {
            let [x, y] = [0, 1].map(|axis| (std::f64::consts::PI * waves[axis] / self.size_m[axis]).powi(2));
            let square = d1 * x * x + 2.0 * (d12 + 2.0 * d66) * x * y + d2 * y * y;
            (square / self.mass).sqrt() / std::f64::consts::TAU
        };
        sorted(waves.map(hz).collect(), count)
    }

    /// Frequencies in Hz of the elastic modes, the lowest first, by as many polynomials, even and
    /// odd ones, along each axis.
    pub(crate) fn ritz(&self, edges: Edges, degrees: [usize; 2], count: usize) -> Vec<f64> {
        let factor = |x: f64| match edges {
            Edges::Free => [1.0, 0.0, 0.0],
            Edges::Clamped => product([1.0 - x * x, -2.0 * x, -2.0], [1.0 - x * x, -2.0 * x, -2.0]),
        };
        let [d1, d12, d2, d66] = self.stiffness;
        let mut all = Vec::new();
        for [odd_x, odd_y] in [[false, false], [false, true], [true, false], [true, true]] {
            let lines = [Line::new(odd_x, degrees[0], None, factor), Line::new(odd_y, degrees[1], None, factor)];
            // Integrals of the products of derivatives of two orders along an axis.
            let integrals = |axis: usize, one: usize, other: usize| {
                let scale = (2.0 / self.size_m[axis]).powi((one + other) as i32);
                let mut result = lines[axis].integrals(one, &lines[axis], other);
                result.iter_mut().flatten().for_each(|value| *value *= scale);
                result
            };
            let terms = [
                (d1, [2, 2], [0, 0]),
                (d2, [0, 0], [2, 2]),
                (d12, [2, 0], [0, 2]),
                (d12, [0, 2], [2, 0]),
                (4.0 * d66, [1, 1], [1, 1]),
            ];
            let rows = lines[1].count();
            let size = lines[0].count() * rows;
            let mut stiffness = Mat::<f64>::zeros(size, size);
            for (modulus, x, y) in terms {
                let [along, across] = [integrals(0, x[0], x[1]), integrals(1, y[0], y[1])];
                for j in 0..size {
                    for i in 0..size {
                        stiffness[(i, j)] += modulus * along[i / rows][j / rows] * across[i % rows][j % rows];
                    }
                }
            }
            let rigid = usize::from(edges == Edges::Free && !(odd_x && odd_y));
            let values = stiffness.self_adjoint_eigenvalues(Side::Lower).unwrap();
            let hz = |value: &f64| (value.max(0.0) / self.mass).sqrt() / std::f64::consts::TAU;
            all.extend(values.iter().skip(rigid).map(hz));
        }
        sorted(all, count)
    }
}
