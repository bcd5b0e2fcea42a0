//! Blocks by elasticity in space: Ritz's method with products of Legendre polynomials.

use faer::{Mat, Side};

use super::line::Line;

/// Block of an isotropic material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    /// Extents, metres.
    pub(crate) size_m: [f64; 3],
    /// Young's modulus, Pa.
    pub(crate) young: f64,
    /// Poisson's ratio.
    pub(crate) poisson: f64,
    /// Density, kg/m³.
    pub(crate) density: f64,
    /// True if the sides at the ends of the first two axes are clamped; false if all are free.
    pub(crate) is_clamped: bool,
}

/// Functions of an expansion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Functions {
    /// Number of Legendre polynomials, even and odd ones, along each axis.
    pub(crate) degrees: [usize; 3],
    /// Number of powers within a layer at both ends of the first two axes; 0 for none. A thin
    /// plate's stress falls off within a thickness of its edge, where polynomials are coarse.
    pub(crate) layer: usize,
}

/// Width of the layer, in thicknesses.
const LAYER: f64 = 1.5;

/// Parities about the middles of the three axes: true if the component along an axis is even in
/// its own coordinate, and the other components are odd in that coordinate.
pub(crate) type Parity = [bool; 3];

/// All eight parities.
pub(crate) fn parities() -> impl Iterator<Item = Parity> {
    (0..8).map(|bits| [0, 1, 2].map(|axis| bits >> axis & 1 == 1))
}

impl Block {
    /// Frequencies in Hz of all elastic modes of the expansion, the lowest first.
    pub(crate) fn frequencies(&self, functions: Functions, count: usize) -> Vec<f64> {
        sorted(parities().flat_map(|parity| self.of_parity(parity, functions)).collect(), count)
    }

    /// Frequencies in Hz of the elastic modes that bend or twist a plate: the motion across it is
    /// even in the third axis, that along it is odd.
    pub(crate) fn bending(&self, functions: Functions, count: usize) -> Vec<f64> {
        let bending = parities().filter(|parity| parity[2]);
        sorted(bending.flat_map(|parity| self.of_parity(parity, functions)).collect(), count)
    }

    /// Frequencies in Hz of the elastic modes of a parity, the lowest first.
    pub(crate) fn of_parity(&self, parity: Parity, functions: Functions) -> Vec<f64> {
        let line = |axis: usize, is_odd: bool| {
            let width = 2.0 * LAYER * self.size_m[2] / self.size_m[axis];
            let layer = (axis < 2 && functions.layer > 0 && width < 1.0).then_some((width, functions.layer));
            Line::new(is_odd, functions.degrees[axis], layer, |x| {
                let is_held = self.is_clamped && axis < 2;
                if is_held { [1.0 - x * x, -2.0 * x, -2.0] } else { [1.0, 0.0, 0.0] }
            })
        };
        let lines = [0, 1, 2].map(|axis| [line(axis, false), line(axis, true)]);
        // Parity of a component along an axis.
        let odd = |component: usize, axis: usize| usize::from(parity[axis] != (component == axis));
        let lines_of = |component: usize| [0, 1, 2].map(|axis| &lines[axis][odd(component, axis)]);
        let counts = [0, 1, 2].map(|component| lines_of(component).map(Line::count));
        let sizes = counts.map(|count| count.iter().product::<usize>());
        let starts = [0, sizes[0], sizes[0] + sizes[1]];
        let shear = self.young / (2.0 * (1.0 + self.poisson));
        let lame = 2.0 * shear * self.poisson / (1.0 - 2.0 * self.poisson);
        let mut stiffness = Mat::<f64>::zeros(sizes.iter().sum(), sizes.iter().sum());
        for a in 0..3 {
            for b in 0..=a {
                let [one, other] = [lines_of(a), lines_of(b)];
                // Adds a modulus times the integral of the derivative of a's along one axis times
                // that of b's along another.
                let mut add = |modulus: f64, along_a: usize, along_b: usize| {
                    let factors = [0, 1, 2].map(|axis| {
                        let orders = [along_a == axis, along_b == axis].map(usize::from);
                        let scale = (2.0 / self.size_m[axis]).powi((orders[0] + orders[1]) as i32);
                        let mut factor = one[axis].integrals(orders[0], other[axis], orders[1]);
                        factor.iter_mut().flatten().for_each(|value| *value *= scale);
                        factor
                    });
                    let [columns, rows] = [counts[b], counts[a]];
                    for j in 0..sizes[b] {
                        let column = [j / (columns[1] * columns[2]), j / columns[2] % columns[1], j % columns[2]];
                        for i in 0..sizes[a] {
                            let row = [i / (rows[1] * rows[2]), i / rows[2] % rows[1], i % rows[2]];
                            let value: f64 = (0..3).map(|axis| factors[axis][row[axis]][column[axis]]).product();
                            stiffness[(starts[a] + i, starts[b] + j)] += modulus * value;
                        }
                    }
                };
                add(lame, a, b);
                add(shear, b, a);
                if a == b {
                    (0..3).for_each(|axis| add(shear, axis, axis));
                }
            }
        }
        let values = stiffness.self_adjoint_eigenvalues(Side::Lower).unwrap();
        // A translation has one even parity, a turn two.
        let rigid = usize::from(!self.is_clamped && parity != [false; 3] && parity != [true; 3]);
        let hz = |value: &f64| (value.max(0.0) / self.density).sqrt() / std::f64::consts::TAU;
        values.iter().skip(rigid).map(hz).collect()
    }
}

/// Lowest of some values, in order.
pub(crate) fn sorted(mut values: Vec<f64>, count: usize) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.truncate(count);
    values
}
