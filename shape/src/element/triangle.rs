//! Lagrange functions and quadrature on the triangle (0, 0), (1, 0), (0, 1).

use std::f64::consts::PI;

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};

use super::Error;

/// Functions of all nodes at a point of quadrature.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Values.
    pub values: Vec<f64>,
    /// Values of the polynomials of one order less, of which each has the mean square 2 over the
    /// triangle, and products of two of them the mean 0.
    pub lower: Vec<f64>,
    /// Derivatives by both local coordinates.
    pub derivatives: Vec<[f64; 2]>,
    /// Weight; all weights sum to 1/2, the area of the triangle.
    pub weight: f64,
}

/// Lagrange functions of one order on the triangle.
///
/// Nodes: the three vertices; those within the edges from vertex 0 to 1, 1 to 2 and 2 to 0, each in
/// the direction of its edge; those inside. They lie at the points of Gauss and Lobatto on the
/// edges, and inside where Blyth and Pozrikidis place them.
#[derive(Clone, Debug)]
pub struct Triangle {
    order: usize,
    /// Index of each node in each barycentric coordinate; exponents of the Bernstein polynomials.
    lattice: Vec<[usize; 3]>,
    nodes: Vec<[f64; 3]>,
    /// Bernstein polynomials of the Lagrange functions, one row a polynomial.
    coefficients: Vec<Vec<f64>>,
    /// Exponents of the Bernstein polynomials of one order less.
    lower_lattice: Vec<[usize; 3]>,
    /// Bernstein polynomials of those of one order less that are orthonormal, one row a polynomial.
    lower: Vec<Vec<f64>>,
}

impl Triangle {
    /// Makes the functions of an order from 1 to 4.
    pub fn new(order: usize) -> Result<Self, Error> {
        let lines: Vec<f64> = match order {
            1 => vec![0.0, 1.0],
            2 => vec![0.0, 0.5, 1.0],
            3 => vec![0.0, 0.5 - 0.2f64.sqrt() / 2.0, 0.5 + 0.2f64.sqrt() / 2.0, 1.0],
            4 => vec![0.0, 0.5 - (3.0f64 / 7.0).sqrt() / 2.0, 0.5, 0.5 + (3.0f64 / 7.0).sqrt() / 2.0, 1.0],
            _ => return Err(Error::Order(order)),
        };
        let lattice = lattice(order);
        let nodes: Vec<[f64; 3]> = lattice
            .iter()
            .map(|index| {
                let line = index.map(|part| lines[part]);
                let sum: f64 = line.iter().sum();
                line.map(|part| (1.0 + 3.0 * part - sum) / 3.0)
            })
            .collect();
        let count = nodes.len();
        let at_nodes = Mat::from_fn(count, count, |row, column| bernstein(lattice[column], nodes[row]));
        let inverse = at_nodes.partial_piv_lu().inverse();
        let coefficients = (0..count).map(|row| (0..count).map(|column| inverse[(row, column)]).collect()).collect();
        let lower_lattice = if order > 1 { self::lattice(order - 1) } else { vec![[0; 3]] };
        let mut triangle = Self { order, lattice, nodes, coefficients, lower_lattice, lower: Vec::new() };
        triangle.orthonormalise()?;
        Ok(triangle)
    }

    /// Finds the orthonormal polynomials of one order less.
    fn orthonormalise(&mut self) -> Result<(), Error> {
        let count = self.lower_lattice.len();
        let mut gram = Mat::<f64>::zeros(count, count);
        for (at, weight) in quadrature(2 * self.order) {
            let polynomials: Vec<f64> = self.lower_lattice.iter().map(|e| bernstein(*e, barycentric(at))).collect();
            for (row, polynomial) in polynomials.iter().enumerate() {
                polynomials.iter().enumerate().for_each(|(c, other)| gram[(row, c)] += weight * polynomial * other);
            }
        }
        let factor = gram.llt(Side::Lower).map_err(|_| Error::Order(self.order))?.L().to_owned();
        let inverse = factor.partial_piv_lu().inverse();
        self.lower = (0..count).map(|row| (0..count).map(|column| inverse[(column, row)]).collect()).collect();
        Ok(())
    }

    /// Vertices at the begin and the end of each edge.
    pub const EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

    /// Returns the order of the functions.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Returns the barycentric coordinates of the nodes.
    pub fn nodes(&self) -> &[[f64; 3]] {
        &self.nodes
    }

    /// Returns the number of the first node inside.
    pub fn first_inner(&self) -> usize {
        3 * self.order
    }

    /// Returns the values of all functions at local coordinates.
    pub fn values(&self, at: [f64; 2]) -> Vec<f64> {
        combine(&self.lattice, &self.coefficients, at)
    }

    /// Returns the derivatives of all functions by both local coordinates.
    pub fn derivatives(&self, at: [f64; 2]) -> Vec<[f64; 2]> {
        let barycentric = barycentric(at);
        let mut derivatives = vec![[0.0; 2]; self.nodes.len()];
        for (exponents, row) in self.lattice.iter().zip(&self.coefficients) {
            let [zero, one, two] = bernstein_derivatives(*exponents, barycentric);
            for (derivative, factor) in derivatives.iter_mut().zip(row) {
                derivative[0] += factor * (one - zero);
                derivative[1] += factor * (two - zero);
            }
        }
        derivatives
    }

    /// Returns the functions at the points of a quadrature that is exact up to a degree.
    pub fn samples(&self, degree: usize) -> Vec<Sample> {
        quadrature(degree)
            .into_iter()
            .map(|(at, weight)| Sample {
                values: self.values(at),
                lower: combine(&self.lower_lattice, &self.lower, at),
                derivatives: self.derivatives(at),
                weight,
            })
            .collect()
    }
}

/// Exponents of all polynomials of an order from 1 on, in the order of the nodes.
fn lattice(order: usize) -> Vec<[usize; 3]> {
    let mut lattice = vec![[order, 0, 0], [0, order, 0], [0, 0, order]];
    for [from, to] in Triangle::EDGES {
        for step in 1..order {
            let mut index = [0; 3];
            index[from] = order - step;
            index[to] = step;
            lattice.push(index);
        }
    }
    for second in 1..order {
        lattice.extend((1..order - second).map(|first| [first, second, order - first - second]));
    }
    lattice
}

/// Values of functions that are sums of Bernstein polynomials.
fn combine(lattice: &[[usize; 3]], coefficients: &[Vec<f64>], at: [f64; 2]) -> Vec<f64> {
    let mut values = vec![0.0; coefficients.first().map_or(0, Vec::len)];
    for (exponents, row) in lattice.iter().zip(coefficients) {
        let polynomial = bernstein(*exponents, barycentric(at));
        values.iter_mut().zip(row).for_each(|(value, factor)| *value += factor * polynomial);
    }
    values
}

/// Returns the barycentric coordinates of local ones.
pub(super) fn barycentric(at: [f64; 2]) -> [f64; 3] {
    [1.0 - at[0] - at[1], at[0], at[1]]
}

fn power(base: f64, exponent: usize) -> f64 {
    (0..exponent).map(|_| base).product()
}

fn multinomial(exponents: [usize; 3]) -> f64 {
    let factorial = |number: usize| (1..=number).product::<usize>() as f64;
    factorial(exponents.iter().sum()) / exponents.map(factorial).iter().product::<f64>()
}

fn bernstein(exponents: [usize; 3], at: [f64; 3]) -> f64 {
    multinomial(exponents) * (0..3).map(|part| power(at[part], exponents[part])).product::<f64>()
}

/// Derivatives of a Bernstein polynomial by each barycentric coordinate.
fn bernstein_derivatives(exponents: [usize; 3], at: [f64; 3]) -> [f64; 3] {
    let order: usize = exponents.iter().sum();
    [0, 1, 2].map(|part| {
        if exponents[part] == 0 {
            return 0.0;
        }
        let mut lower = exponents;
        lower[part] -= 1;
        order as f64 * bernstein(lower, at)
    })
}

/// Points, in local coordinates, and weights of a quadrature that is exact up to a degree: the
/// product of two of Gauss and Legendre, one side of the square collapsed to a vertex.
fn quadrature(degree: usize) -> Vec<([f64; 2], f64)> {
    // Collapsing adds one degree to the second direction.
    let line = gauss((degree + 2).div_ceil(2));
    let mut points = Vec::with_capacity(line.len() * line.len());
    for &(second, second_weight) in &line {
        for &(first, first_weight) in &line {
            let width = 1.0 - second;
            points.push(([first * width, second], first_weight * second_weight * width));
        }
    }
    points
}

/// Points and weights of Gauss and Legendre between 0 and 1, exact up to degree 2 `count` - 1.
pub(super) fn gauss(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|index| {
            let mut root = (PI * (index as f64 + 0.75) / (count as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut before, mut value) = (0.0, 1.0);
                for degree in 0..count {
                    let next = ((2 * degree + 1) as f64 * root * value - degree as f64 * before) / (degree + 1) as f64;
                    before = value;
                    value = next;
                }
                slope = count as f64 * (before - root * value) / (1.0 - root * root);
                let change = value / slope;
                root -= change;
                if change.abs() < 1e-15 {
                    break;
                }
            }
            ((1.0 - root) / 2.0, 1.0 / ((1.0 - root * root) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_one_at_their_nodes_and_zero_at_others() {
        for order in 1..=4 {
            let triangle = Triangle::new(order).unwrap();
            for (number, node) in triangle.nodes().iter().enumerate() {
                for (function, value) in triangle.values([node[1], node[2]]).iter().enumerate() {
                    let expected = if function == number { 1.0 } else { 0.0 };
                    assert!((value - expected).abs() < 1e-13);
                }
            }
        }
        assert_eq!(Triangle::new(5).err(), Some(Error::Order(5)));
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        let triangle = Triangle::new(4).unwrap();
        let (at, step) = ([0.3, 0.25], 1e-5);
        for (axis, shift) in [[step, 0.0], [0.0, step]].into_iter().enumerate() {
            let above = triangle.values([at[0] + shift[0], at[1] + shift[1]]);
            let below = triangle.values([at[0] - shift[0], at[1] - shift[1]]);
            for ((above, below), derivative) in above.iter().zip(&below).zip(triangle.derivatives(at)) {
                assert!(((above - below) / (2.0 * step) - derivative[axis]).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn quadrature_is_exact_up_to_its_degree() {
        let factorial = |number: i32| (1..=number).map(f64::from).product::<f64>();
        for degree in 0..=14 {
            for first in 0..=degree {
                let second = degree - first;
                let sum: f64 =
                    quadrature(degree as usize).iter().map(|(at, w)| w * at[0].powi(first) * at[1].powi(second)).sum();
                let exact = factorial(first) * factorial(second) / factorial(degree + 2);
                assert!((sum / exact - 1.0).abs() < 1e-12, "{first} {second}");
            }
        }
    }
}
