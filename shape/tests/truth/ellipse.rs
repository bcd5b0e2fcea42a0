//! Clamped membranes and thin plates within an ellipse: Ritz's method with polynomials that vanish
//! on it.

use faer::{Mat, Side};

use super::line::{gauss, legendre, product};
use super::ritz::sorted;

/// Body within an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Skin {
    /// Membrane; its numbers are the wave numbers.
    Membrane,
    /// Thin plate; its numbers are the squares of the wave numbers.
    Plate,
}

/// Frequency numbers of a clamped body within an ellipse of two half axes, in order, by polynomials
/// up to a degree.
pub(crate) fn numbers(skin: Skin, half_axes: [f64; 2], degree: usize, count: usize) -> Vec<f64> {
    let parities = [[0, 0], [0, 1], [1, 0], [1, 1]];
    sorted(parities.into_iter().flat_map(|parity| of_parity(skin, half_axes, degree, parity)).collect(), count)
}

/// Frequency numbers of the shapes that are even (0) or odd (1) along each axis.
fn of_parity(skin: Skin, [a, b]: [f64; 2], degree: usize, parity: [usize; 2]) -> Vec<f64> {
    // A quarter of the disc of radius 1, by radius and angle.
    let line = gauss(degree + 12);
    let quarter = std::f64::consts::FRAC_PI_2;
    let places: Vec<[f64; 3]> = line
        .iter()
        .flat_map(|[r, by_r]| {
            line.iter().map(move |[turn, by_turn]| {
                let (sine, cosine) = (quarter * turn).sin_cos();
                [r * cosine, r * sine, r * by_r * quarter * by_turn]
            })
        })
        .collect();
    let degrees = (parity[0]..=degree).step_by(2).flat_map(|m| (parity[1]..=degree).step_by(2).map(move |n| [m, n]));
    // Each function's values, then those of what the energy takes the squares of.
    let mut functions: Vec<[Vec<f64>; 3]> = Vec::new();
    for [m, n] in degrees.filter(|[m, n]| m + n <= degree) {
        let mut new = [vec![], vec![], vec![]];
        for &[x, y, weight] in &places {
            // Derivatives by x, and by y, of the factor that vanishes on the rim.
            let rim = 1.0 - x * x - y * y;
            let [rim_x, rim_y] = match skin {
                Skin::Membrane => [[rim, -2.0 * x, -2.0], [rim, -2.0 * y, -2.0]],
                Skin::Plate => [x, y].map(|at| [rim * rim, -4.0 * at * rim, 8.0 * at * at - 4.0 * rim]),
            };
            let (of_x, of_y) = (legendre(m, x), legendre(n, y));
            let (by_x, by_y) = (product(of_x, rim_x).map(|v| v * of_y[0]), product(of_y, rim_y).map(|v| v * of_x[0]));
            let root = weight.sqrt();
            let [one, other] = match skin {
                Skin::Membrane => [by_x[1] / a, by_y[1] / b],
                Skin::Plate => [by_x[2] / (a * a) + by_y[2] / (b * b), 0.0],
            };
            [by_x[0], one, other].iter().zip(&mut new).for_each(|(value, row)| row.push(root * value));
        }
        push(&mut functions, new);
    }
    let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let stiffness = Mat::from_fn(functions.len(), functions.len(), |row, column| {
        (1..3).map(|part| inner(&functions[row][part], &functions[column][part])).sum::<f64>()
    });
    let values = stiffness.self_adjoint_eigenvalues(Side::Lower).unwrap();
    values.iter().map(|value| value.sqrt()).collect()
}

/// Adds a function made orthonormal to those before.
fn push(functions: &mut Vec<[Vec<f64>; 3]>, mut new: [Vec<f64>; 3]) {
    let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Twice: rounding leaves a part of what the first pass takes away.
    for _ in 0..2 {
        for function in functions.iter() {
            let share = inner(&new[0], &function[0]);
            for (new, old) in new.iter_mut().zip(function) {
                new.iter_mut().zip(old).for_each(|(new, old)| *new -= share * old);
            }
        }
    }
    let size = inner(&new[0], &new[0]).sqrt();
    new.iter_mut().flatten().for_each(|value| *value /= size);
    functions.push(new);
}
