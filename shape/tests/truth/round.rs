//! Spheres and cylinders by elasticity in space: Ritz's method along the radius and the axis.

use faer::{Mat, Side};

use super::line::{Line, gauss, legendre};
use super::ritz::sorted;

/// Isotropic material by Lamé's constants, Pa, and density, kg/m³.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lame {
    pub(crate) first: f64,
    pub(crate) shear: f64,
    pub(crate) density: f64,
}

/// Square roots of the eigenvalues of a stiffness by a density, Hz.
fn hz(stiffness: &Mat<f64>, density: f64) -> Vec<f64> {
    let values = stiffness.self_adjoint_eigenvalues(Side::Lower).unwrap();
    values.iter().map(|value| (value.max(0.0) / density).sqrt() / std::f64::consts::TAU).collect()
}

/// Places and weights of a quadrature between two places, with a weight that depends on the place.
fn points(from: f64, to: f64, count: usize, weight: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let at = |[share, part]: [f64; 2]| (from + (to - from) * share, (to - from) * part);
    gauss(count).into_iter().map(at).map(|(at, part)| [at, part * weight(at)]).collect()
}

/// Frequencies in Hz of a free sphere, hollow below its inner radius, all modes of a multiplet
/// counted, by as many polynomials along the radius. The motion of degree l is that of vector
/// spherical harmonics; its energy: Dahlen and Tromp, Theoretical Global Seismology (1998), 8.
pub(crate) fn sphere(lame: Lame, [inner, outer]: [f64; 2], degrees: usize, count: usize) -> Vec<f64> {
    let points = points(inner, outer, degrees + 8, |r| r * r);
    let middle = |r: f64| (2.0 * r - inner - outer) / (outer - inner);
    let polynomial = |degree: usize| {
        move |r: f64| {
            let [value, slope, _] = legendre(degree, middle(r));
            [value, slope * 2.0 / (outer - inner)]
        }
    };
    let line = Line::over(&points, &(0..degrees).map(polynomial).collect::<Vec<_>>());
    let number = line.count();
    let bulk = lame.first + 2.0 / 3.0 * lame.shear;
    let mut all = Vec::new();
    for degree in 0..12 {
        let square = f64::from(degree * (degree + 1));
        let root = square.sqrt();
        let mut spheroidal = Mat::<f64>::zeros(2 * number, 2 * number);
        let mut torsional = Mat::<f64>::zeros(number, number);
        for (point, [r, weight]) in points.iter().enumerate() {
            let [value, slope] =
                [0, 1].map(|order| (0..number).map(|k| line.value(k, order, point)).collect::<Vec<_>>());
            // Rows: what the energy takes the squares of, by the functions of U, then of V.
            let row = |of_u: [f64; 2], of_v: [f64; 2]| -> Vec<f64> {
                let part =
                    |[a, b]: [f64; 2]| value.iter().zip(&slope).map(move |(value, slope)| a * value / r + b * slope);
                part(of_u).chain(part(of_v)).collect()
            };
            let rows = [
                (bulk, row([2.0, 1.0], [-root, 0.0])),
                (lame.shear / 3.0, row([-2.0, 2.0], [root, 0.0])),
                (lame.shear, row([root, 0.0], [-1.0, 1.0])),
                (lame.shear * (square - 2.0), row([0.0; 2], [1.0, 0.0])),
            ];
            for (modulus, row) in rows {
                for i in 0..2 * number {
                    (0..2 * number).for_each(|j| spheroidal[(i, j)] += weight * modulus * row[i] * row[j]);
                }
            }
            for i in 0..number {
                for j in 0..number {
                    let twist = (slope[i] - value[i] / r) * (slope[j] - value[j] / r);
                    let own = (square - 2.0) * value[i] * value[j] / (r * r);
                    torsional[(i, j)] += weight * lame.shear * (twist + own);
                }
            }
        }
        if degree == 0 {
            // Radial motion alone.
            spheroidal = spheroidal.submatrix(0, 0, number, number).to_owned();
        }
        let rigid = usize::from(degree == 1);
        let mut found: Vec<f64> = hz(&spheroidal, lame.density).split_off(rigid);
        if degree > 0 {
            found.extend(&hz(&torsional, lame.density)[rigid..]);
        }
        (0..2 * degree + 1).for_each(|_| all.extend(&found));
    }
    sorted(all, count)
}

/// Frequencies in Hz of a free solid cylinder of a radius and a height, both modes of a pair
/// counted, by as many polynomials along the radius and, even and odd ones, along the height.
pub(crate) fn cylinder(lame: Lame, radius: f64, height: f64, degrees: [usize; 2], count: usize) -> Vec<f64> {
    let across = points(0.0, radius, degrees[0] + 16, |r| r);
    let along = points(0.0, 1.0, degrees[1] + 2, |_| 1.0);
    // Near the axis a component falls as a power of the radius, times even powers.
    let line = |power: i32| {
        let function = |degree: usize| {
            move |r: f64| {
                let share = r / radius;
                let [value, slope, _] = legendre(degree, 2.0 * share * share - 1.0);
                let [own, falls] = [share.powi(power), f64::from(power) * share.powi((power - 1).max(0))];
                [own * value, (falls * value + own * slope * 4.0 * share) / radius]
            }
        };
        Line::over(&across, &(0..degrees[0]).map(function).collect::<Vec<_>>())
    };
    let heights = [false, true].map(|is_odd| {
        let function = |degree: usize| {
            move |z: f64| {
                let [value, slope, _] = legendre(degree, z);
                [value, slope * 2.0 / height]
            }
        };
        let degrees: Vec<usize> = (usize::from(is_odd)..degrees[1]).step_by(2).collect();
        Line::over(&along, &degrees.into_iter().map(function).collect::<Vec<_>>())
    });
    let mut all = Vec::new();
    for waves in 0..12 {
        let n = f64::from(waves);
        // Sum and difference of the motions along radius and circumference, by √2, and that along
        // the axis: each has a power of its own.
        let lines = [waves + 1, (waves - 1_i32).abs(), waves].map(line);
        for is_odd in [false, true] {
            let of_height = [is_odd, is_odd, !is_odd].map(|odd| &heights[usize::from(odd)]);
            let functions: Vec<[usize; 3]> = (0..3)
                .flat_map(|c| (0..lines[c].count()).map(move |k| [c, k]))
                .flat_map(|[c, k]| (0..of_height[c].count()).map(move |l| [c, k, l]))
                .collect();
            let mut strains = Mat::<f64>::zeros(7 * across.len() * along.len(), functions.len());
            for (p, [r, weight_r]) in across.iter().enumerate() {
                for (q, [_, weight_z]) in along.iter().enumerate() {
                    let weight = (weight_r * weight_z).sqrt();
                    for (column, &[c, k, l]) in functions.iter().enumerate() {
                        let [value, slope] = [0, 1].map(|order| lines[c].value(k, order, p));
                        let [at, climb] = [0, 1].map(|order| of_height[c].value(l, order, q));
                        // Shares of the radial, round and axial motion.
                        let half = std::f64::consts::FRAC_1_SQRT_2;
                        let [u, v, w] = [[half, half, 0.0], [half, -half, 0.0], [0.0, 0.0, 1.0]][c];
                        let stretches = [u * slope * at, (u + n * v) * value / r * at, w * value * climb];
                        let shears = [
                            u * value * climb + w * slope * at,
                            (v * slope - (n * u + v) * value / r) * at,
                            v * value * climb - n * w * value / r * at,
                        ];
                        let row = 7 * (p * along.len() + q);
                        for axis in 0..3 {
                            strains[(row + axis, column)] = weight * (2.0 * lame.shear).sqrt() * stretches[axis];
                            strains[(row + 3 + axis, column)] = weight * lame.shear.sqrt() * shears[axis];
                        }
                        strains[(row + 6, column)] = weight * lame.first.sqrt() * stretches.iter().sum::<f64>();
                    }
                }
            }
            let stiffness = strains.transpose() * &strains;
            let rigid = usize::from(waves < 2);
            let found = hz(&stiffness, lame.density).split_off(rigid);
            (0..1 + usize::from(waves > 0)).for_each(|_| all.extend(&found));
        }
    }
    sorted(all, count)
}
