//! Functions and quadrature along one axis of a cell, from 0 to 1.

use super::ORDER;

/// Number of moments along an axis: products of two functions have up to twice their order.
pub(super) const MOMENTS: usize = 2 * ORDER + 1;
/// Number of functions along an axis.
pub(super) const FUNCTIONS: usize = ORDER + 1;

/// Legendre's polynomials on 0 to 1, P_0 to P_(`count` - 1).
pub(super) fn legendre<const COUNT: usize>(at: f64) -> [f64; COUNT] {
    let x = 2.0 * at - 1.0;
    let mut values = [1.0; COUNT];
    for order in 1..COUNT {
        let before = if order > 1 { values[order - 2] } else { 0.0 };
        let number = order as f64;
        values[order] = ((2.0 * number - 1.0) * x * values[order - 1] - (number - 1.0) * before) / number;
    }
    values
}

/// Integrals of Legendre's polynomials from 0 to a place between 0 and 1.
pub(super) fn legendre_integrals(at: f64) -> [f64; MOMENTS] {
    let values = legendre::<{ MOMENTS + 1 }>(at);
    let mut integrals = [at; MOMENTS];
    for order in 1..MOMENTS {
        // ∫ P_n = (P_(n+1) - P_(n-1)) / (2 n + 1), half of it on an interval of length 1.
        integrals[order] = (values[order + 1] - values[order - 1]) / (2.0 * (2.0 * order as f64 + 1.0));
    }
    integrals
}

/// Points and weights of Gauss's rule on 0 to 1, exact up to the degree 2 `count` - 1.
pub(super) fn gauss(count: usize) -> Vec<[f64; 2]> {
    let polynomial = |x: f64| {
        let (mut before, mut value) = (0.0, 1.0);
        for order in 1..=count {
            let number = order as f64;
            (before, value) = (value, ((2.0 * number - 1.0) * x * value - (number - 1.0) * before) / number);
        }
        let slope = count as f64 * (x * value - before) / (x * x - 1.0);
        (value, slope)
    };
    let point = |index: usize| {
        let mut x = -(std::f64::consts::PI * (index as f64 + 0.75) / (count as f64 + 0.5)).cos();
        for _ in 0..8 {
            let (value, slope) = polynomial(x);
            x -= value / slope;
        }
        let slope = polynomial(x).1;
        [(1.0 + x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..count).map(point).collect()
}

/// Nodes of the functions: both ends, and Gauss and Lobatto's points between them.
pub(super) fn nodes() -> [f64; FUNCTIONS] {
    let inner = (1.0 - (0.2_f64).sqrt()) / 2.0;
    [0.0, inner, 1.0 - inner, 1.0]
}

/// Values and slopes at a place of the functions that are 1 at one node and 0 at the others.
pub(super) fn lagrange(at: f64) -> [[f64; 2]; FUNCTIONS] {
    let nodes = nodes();
    let mut result = [[1.0, 0.0]; FUNCTIONS];
    for (function, [value, slope]) in result.iter_mut().enumerate() {
        for other in (0..FUNCTIONS).filter(|other| *other != function) {
            let width = nodes[function] - nodes[other];
            *slope = *slope * (at - nodes[other]) / width + *value / width;
            *value *= (at - nodes[other]) / width;
        }
    }
    result
}
