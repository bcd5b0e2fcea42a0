//! Matrices of one cell.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use super::Solid;
use super::functions::{FUNCTIONS, MOMENTS, gauss, lagrange, legendre};
use super::moments::{ALL, Inside};

/// Number of functions of a cell.
pub(super) const NODES: usize = FUNCTIONS * FUNCTIONS * FUNCTIONS;
/// Stiffness outside of the body, as a share of that inside.
const OUTSIDE: f64 = 1e-7;

/// Functions of a cell at the points of a rule that is exact for the product of any two.
pub(super) struct Functions {
    /// Values at all points, and derivatives along the three axes, functions by points.
    values: [Mat<f64>; 4],
    /// Factor of a moment in the weight of a point, along one axis: points by moments.
    weights: [[f64; MOMENTS]; MOMENTS],
}

/// Products of two functions integrated over a part of the cell.
struct Products {
    mass: Mat<f64>,
    /// ∫ ∂_i φ_a ∂_j φ_b by i and j, i up to j.
    slopes: [[Option<Mat<f64>>; 3]; 3],
}

/// Matrices of a cell: stiffness by pairs of components, and the mass that all components share.
pub(super) struct CellMatrices {
    pub(super) stiffness: [[Mat<f64>; 3]; 3],
    pub(super) mass: Mat<f64>,
}

impl Functions {
    /// Tabulates the functions of a cell whose edges are 1.
    pub(super) fn new() -> Self {
        let rule = gauss(MOMENTS);
        let along: Vec<_> = rule.iter().map(|[at, _]| lagrange(*at)).collect();
        let value = |kind: usize| {
            Mat::from_fn(NODES, ALL, |node, point| {
                let nodes = parts(node, FUNCTIONS);
                let points = parts(point, MOMENTS);
                let part = |axis: usize| {
                    let is_slope = kind == axis + 1;
                    along[points[axis]][nodes[axis]][usize::from(is_slope)]
                };
                part(0) * part(1) * part(2)
            })
        };
        let mut weights = [[0.0; MOMENTS]; MOMENTS];
        for (row, &[at, weight]) in weights.iter_mut().zip(&rule) {
            for (order, (entry, value)) in row.iter_mut().zip(legendre::<MOMENTS>(at)).enumerate() {
                *entry = weight * (2.0 * order as f64 + 1.0) * value;
            }
        }
        Self { values: [0, 1, 2, 3].map(value), weights }
    }

    /// Weights of the rule's points under which all products have their integral over the part.
    fn weights(&self, moments: &[f64; ALL]) -> Vec<f64> {
        let mut from = moments.to_vec();
        // The last axis of three becomes the first one: after three turns all are as before.
        for _ in 0..3 {
            let mut to = vec![0.0; ALL];
            for (outer, row) in from.chunks_exact(MOMENTS).enumerate() {
                for (point, factors) in self.weights.iter().enumerate() {
                    to[point * MOMENTS * MOMENTS + outer] = row.iter().zip(factors).map(|(a, b)| a * b).sum();
                }
            }
            from = to;
        }
        from
    }

    fn products(&self, weights: &[f64]) -> Products {
        let weighted = self
            .values
            .each_ref()
            .map(|values| Mat::from_fn(NODES, ALL, |node, point| values[(node, point)] * weights[point]));
        let product = |left: usize, right: usize| {
            let mut sum = Mat::zeros(NODES, NODES);
            let transposed = self.values[right].transpose();
            matmul(&mut sum, Accum::Replace, &weighted[left], transposed, 1.0, Par::Seq);
            sum
        };
        let slopes = [0, 1, 2].map(|i| [0, 1, 2].map(|j| (i <= j).then(|| product(i + 1, j + 1))));
        Products { mass: product(0, 0), slopes }
    }

    /// Makes the matrices of the part of a cell inside the body; `whole` are those of a full cell.
    pub(super) fn matrices(
        &self,
        solid: &Solid,
        inside: &Inside,
        edges_m: [f64; 3],
        whole: Option<&CellMatrices>,
    ) -> CellMatrices {
        let mut full = [0.0; ALL];
        full[0] = 1.0;
        let moments = if let Inside::Part(moments) = inside { moments } else { &full };
        let products = self.products(&self.weights(moments));
        let cell_m3: f64 = edges_m.iter().product();
        let lame = solid.young * solid.poisson / ((1.0 + solid.poisson) * (1.0 - 2.0 * solid.poisson)) * cell_m3;
        let shear = solid.young / (2.0 * (1.0 + solid.poisson)) * cell_m3;
        let slope = |i: usize, j: usize, a: usize, b: usize| {
            let found = if i <= j { products.slopes[i][j].as_ref() } else { products.slopes[j][i].as_ref() };
            let unit = found.map_or(0.0, |slopes| if i <= j { slopes[(a, b)] } else { slopes[(b, a)] });
            unit / (edges_m[i] * edges_m[j])
        };
        let block = |i: usize, j: usize| {
            Mat::from_fn(NODES, NODES, |a, b| {
                let even = if i == j { (0..3).map(|axis| slope(axis, axis, a, b)).sum() } else { 0.0 };
                let own = lame * slope(i, j, a, b) + shear * (slope(j, i, a, b) + even);
                let outside = whole.map_or(0.0, |whole| whole.stiffness[i][j][(a, b)]);
                if whole.is_some() { (1.0 - OUTSIDE) * own + OUTSIDE * outside } else { own }
            })
        };
        let stiffness = [0, 1, 2].map(|i| [0, 1, 2].map(|j| block(i, j)));
        let density = solid.density * cell_m3;
        let mass = Mat::from_fn(NODES, NODES, |a, b| density * products.mass[(a, b)]);
        CellMatrices { stiffness, mass }
    }
}

/// Places along the three axes of a number that counts the third one first.
pub(super) fn parts(number: usize, count: usize) -> [usize; 3] {
    [number / (count * count), number / count % count, number % count]
}
