//! Order of strikes along an object, by the likeness of the shapes that they ring.

use nalgebra::{DMatrix, SymmetricEigen};

/// Number of nearest strikes that a strike is tied to.
const NEIGHBOURS: usize = 7;

/// Positions from 0 to 1 of strikes whose modes have values and variances.
///
/// Strikes near one another ring alike. The second eigenvector of the Laplacian of the graph of
/// nearest strikes orders them along a line (Fiedler); positions are the ranks.
pub(crate) fn positions(shapes: &[Vec<(f64, f64)>]) -> Vec<f64> {
    let count = shapes.len();
    if count < 3 {
        return (0..count).map(|index| index as f64).collect();
    }
    let weight = |(x, v): (f64, f64)| x * x / (x * x + 4.0 * v);
    let distance = |a: usize, b: usize| {
        let (mut along, mut first, mut second) = (0.0, 1e-300, 1e-300);
        for (x, y) in shapes[a].iter().zip(&shapes[b]) {
            let weight = weight(*x) * weight(*y);
            along += weight * x.0 * y.0;
            first += weight * x.0 * x.0;
            second += weight * y.0 * y.0;
        }
        1.0 - along / (first * second).sqrt()
    };
    let mut ties = DMatrix::<f64>::zeros(count, count);
    for a in 0..count {
        let mut others: Vec<(f64, usize)> = (0..count).filter(|b| *b != a).map(|b| (distance(a, b), b)).collect();
        others.sort_by(|x, y| x.0.total_cmp(&y.0));
        let scale = others.get(NEIGHBOURS.min(others.len()) - 1).map_or(1.0, |(far, _)| *far) + 1e-9;
        for (far, b) in others.into_iter().take(NEIGHBOURS) {
            let tie = (-far / scale).exp();
            ties[(a, b)] += tie;
            ties[(b, a)] += tie;
        }
    }
    // Weak ties of all to all keep the graph in one piece.
    ties.add_scalar_mut(1e-4);
    let sizes: Vec<f64> = (0..count).map(|row| ties.row(row).sum()).collect();
    let likeness = DMatrix::from_fn(count, count, |a, b| ties[(a, b)] / (sizes[a] * sizes[b]).sqrt());
    let eigen = SymmetricEigen::new(likeness);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let vector = eigen.eigenvectors.column(order[1]);
    let mut ranks: Vec<usize> = (0..count).collect();
    let along = |strike: usize| vector[strike] / sizes[strike].sqrt();
    ranks.sort_by(|a, b| along(*a).total_cmp(&along(*b)));
    let mut positions = vec![0.0; count];
    ranks.iter().enumerate().for_each(|(rank, strike)| positions[*strike] = rank as f64 / (count - 1) as f64);
    positions
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn strikes_on_a_line_are_put_in_their_order() {
        let mut random = SplitMix64(5);
        let modes: Vec<[f64; 2]> = (0..12).map(|_| [0.2 + 1.3 * random.uniform(), random.uniform()]).collect();
        let truth: Vec<f64> = (0..60).map(|_| random.uniform()).collect();
        let shape = |x: &f64| {
            let value = |[a, b]: &[f64; 2]| (std::f64::consts::PI * (a * x + b)).cos();
            modes.iter().map(|mode| (value(mode), 1e-4)).collect::<Vec<(f64, f64)>>()
        };
        let found = positions(&truth.iter().map(shape).collect::<Vec<_>>());
        let agreeing: i32 = (0..60)
            .flat_map(|a| (0..a).map(move |b| (a, b)))
            .map(|(a, b)| if (truth[a] < truth[b]) == (found[a] < found[b]) { 1 } else { -1 })
            .sum();
        assert!(agreeing.abs() > 1700, "{agreeing} of 1770 pairs");
    }
}
