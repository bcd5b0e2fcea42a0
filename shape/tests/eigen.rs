//! Modes of sparse symmetric problems, against closed forms and a dense solver.

use faer::{Mat, Side};
use proptest::prelude::*;
use shape::eigen::{EigenError, Modes, Problem, Wanted, count_below, modes};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Entries of the lower triangles: stiffness and mass by column and row.
#[derive(Default)]
struct Entries(BTreeMap<(usize, usize), (f64, f64)>);

impl Entries {
    fn add(&mut self, row: usize, column: usize, stiffness: f64, mass: f64) {
        let entry = self.0.entry((row.min(column), row.max(column))).or_default();
        entry.0 += stiffness;
        entry.1 += mass;
    }

    fn spring(&mut self, one: usize, other: usize, stiffness: f64) {
        self.add(one, one, stiffness, 0.0);
        self.add(other, other, stiffness, 0.0);
        self.add(one, other, -stiffness, 0.0);
    }

    fn problem(&self, size: usize) -> Problem {
        let mut problem = Problem { size, starts: vec![0], ..Problem::default() };
        for (&(column, row), &(stiffness, mass)) in &self.0 {
            while problem.starts.len() <= column {
                problem.starts.push(problem.rows.len());
            }
            problem.rows.push(row);
            problem.stiffness.push(stiffness);
            problem.mass.push(mass);
        }
        problem.starts.push(problem.rows.len());
        problem
    }
}

/// Chain of unit masses and springs, both ends held or both free.
fn chain(size: usize, held: bool) -> Problem {
    let mut entries = Entries::default();
    for at in 0..size {
        entries.add(at, at, 0.0, 1.0);
        if at > 0 {
            entries.spring(at - 1, at, 1.0);
        }
    }
    if held {
        entries.add(0, 0, 1.0, 0.0);
        entries.add(size - 1, size - 1, 1.0, 0.0);
    }
    entries.problem(size)
}

/// Grid of unit masses held all around, as many rows as columns, in some layers that do not touch.
fn grid(side: usize, layers: usize) -> Problem {
    let mut entries = Entries::default();
    for layer in 0..layers {
        let at = |x: usize, y: usize| (layer * side + y) * side + x;
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            entries.add(at(x, y), at(x, y), 4.0, 1.0);
            if x > 0 {
                entries.add(at(x, y), at(x - 1, y), -1.0, 0.0);
            }
            if y > 0 {
                entries.add(at(x, y), at(x, y - 1), -1.0, 0.0);
            }
        }
    }
    entries.problem(layers * side * side)
}

fn grid_values(side: usize, layers: usize) -> Vec<f64> {
    let of = |order: usize| 4.0 * (0.5 * PI * order as f64 / (side + 1) as f64).sin().powi(2);
    let mut values: Vec<f64> =
        (1..=side).flat_map(|x| (1..=side).map(move |y| (x, y))).map(|(x, y)| of(x) + of(y)).collect();
    values = values.iter().flat_map(|&value| vec![value; layers]).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn find(problem: &Problem, wanted: Wanted) -> Modes {
    modes(problem, wanted, None).unwrap()
}

fn assert_close(found: &[f64], exact: &[f64], tolerance: f64) {
    assert_eq!(found.len(), exact.len());
    for (at, (found, exact)) in found.iter().zip(exact).enumerate() {
        assert!((found - exact).abs() <= tolerance * exact.abs(), "value {at}: {found} instead of {exact}");
    }
}

/// Product of a symmetric matrix with a vector.
fn times(problem: &Problem, entries: &[f64], vector: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; problem.size];
    for column in 0..problem.size {
        let of_column = problem.starts[column]..problem.starts[column + 1];
        for (&row, entry) in problem.rows[of_column.clone()].iter().zip(&entries[of_column]) {
            product[row] += entry * vector[column];
            if row != column {
                product[column] += entry * vector[row];
            }
        }
    }
    product
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
}

fn assert_orthonormal(problem: &Problem, found: &Modes) {
    for (at, one) in found.vectors.iter().enumerate() {
        let product = times(problem, &problem.mass, one);
        for (beside, other) in found.vectors.iter().enumerate() {
            let expected = f64::from(at == beside);
            assert!((dot(&product, other) - expected).abs() < 1e-9, "vectors {at} and {beside}");
        }
    }
}

#[test]
fn chain_of_springs_has_the_values_of_the_closed_form() {
    let found = find(&chain(400, true), Wanted::Lowest(30));
    let exact: Vec<f64> = (1..=30).map(|order| 4.0 * (0.5 * PI * f64::from(order) / 401.0).sin().powi(2)).collect();
    assert_close(&found.values, &exact, 1e-10);
}

#[test]
fn free_chain_has_a_rigid_mode_first() {
    let found = find(&chain(300, false), Wanted::Lowest(10));
    assert!(found.values[0].abs() < 1e-12);
    let exact: Vec<f64> = (1..10).map(|order| 4.0 * (0.5 * PI * f64::from(order) / 300.0).sin().powi(2)).collect();
    assert_close(&found.values[1..], &exact, 1e-10);
    assert!(found.vectors[0].iter().all(|value| (value - found.vectors[0][0]).abs() < 1e-9));
}

#[test]
fn all_modes_of_a_small_chain_are_found() {
    let found = find(&chain(7, false), Wanted::Lowest(7));
    let exact: Vec<f64> = (1..7).map(|order| 4.0 * (0.5 * PI * f64::from(order) / 7.0).sin().powi(2)).collect();
    assert_close(&found.values[1..], &exact, 1e-12);
    assert_eq!(found.counted, 7);
}

#[test]
fn body_of_one_unknown_has_one_mode() {
    let (stiffness, mass) = (vec![8.0], vec![2.0]);
    let problem = Problem { size: 1, starts: vec![0, 1], rows: vec![0], is_ordered: false, stiffness, mass };
    let found = find(&problem, Wanted::Lowest(1));
    assert_close(&found.values, &[4.0], 1e-14);
    assert!((found.vectors[0][0].abs() - 0.5_f64.sqrt()).abs() < 1e-14);
}

#[test]
fn body_without_stiffness_has_rigid_modes_only() {
    let mut problem = chain(20, false);
    problem.stiffness.fill(0.0);
    let found = find(&problem, Wanted::Lowest(3));
    assert!(found.values.iter().all(|value| value.abs() < 1e-12));
    assert_eq!(found.counted, 20);
}

#[test]
fn both_modes_of_each_pair_of_a_square_are_found() {
    let found = find(&grid(30, 1), Wanted::Lowest(60));
    let exact = grid_values(30, 1);
    assert_close(&found.values, &exact[..60], 1e-10);
    for pair in found.values.windows(2).zip(exact.windows(2)).filter(|(_, exact)| exact[1] - exact[0] < 1e-12) {
        assert!((pair.0[1] - pair.0[0]).abs() < 1e-8 * pair.0[0]);
    }
}

#[test]
fn all_modes_of_multiplets_of_eighteen_are_found() {
    let problem = grid(12, 9);
    let found = find(&problem, Wanted::Lowest(50));
    assert_close(&found.values, &grid_values(12, 9)[..50], 1e-10);
    assert_eq!(found.counted, 54);
    assert_orthonormal(&problem, &found);
}

#[test]
fn modes_below_a_limit_are_all_those_up_to_it() {
    let exact = grid_values(20, 1);
    let limit = 0.5 * (exact[24] + exact[26]);
    let expected: Vec<f64> = exact.iter().copied().filter(|&value| value <= limit).collect();
    let found = find(&grid(20, 1), Wanted::Below(limit));
    assert_close(&found.values, &expected, 1e-10);
    let found = find(&grid(20, 1), Wanted::Below(exact[10]));
    assert_close(&found.values, &exact[..found.values.len()], 1e-10);
    assert!(exact[found.values.len()] > exact[10] * (1.0 + 1e-9));
    assert!(find(&grid(20, 1), Wanted::Below(0.5 * exact[0])).values.is_empty());
}

#[test]
fn count_by_inertia_is_that_of_the_closed_form() {
    let exact = grid_values(25, 2);
    for limit in [-1.0, 0.0, 0.01, 0.1, 0.7, 2.3, 3.99, 4.01, 6.1, 9.0] {
        let expected = exact.iter().filter(|&&value| value < limit).count();
        assert_eq!(count_below(&grid(25, 2), limit), Ok(expected), "limit {limit}");
    }
}

#[test]
fn shapes_are_orthonormal_by_mass_and_solve_the_problem() {
    let problem = stencil(12, 3);
    let found = find(&problem, Wanted::Lowest(25));
    assert_orthonormal(&problem, &found);
    for (value, vector) in found.values.iter().zip(&found.vectors) {
        let force = times(&problem, &problem.stiffness, vector);
        let inertia = times(&problem, &problem.mass, vector);
        let left: f64 = force.iter().zip(&inertia).map(|(force, inertia)| (force - value * inertia).powi(2)).sum();
        assert!(left.sqrt() < 1e-6 * dot(&force, &force).sqrt().max(1.0), "value {value}");
    }
}

#[test]
fn modes_are_the_same_at_each_call() {
    let problem = grid(10, 2);
    assert_eq!(find(&problem, Wanted::Lowest(12)), find(&problem, Wanted::Lowest(12)));
}

#[test]
fn modes_are_those_of_any_guess_of_the_lowest_one() {
    let problem = grid(15, 1);
    let without = modes(&problem, Wanted::Lowest(20), None).unwrap();
    for guess in [1e-9, 1e-3, 1.0, 1e3] {
        let with = modes(&problem, Wanted::Lowest(20), Some(guess * without.values[0])).unwrap();
        for (value, other) in with.values.iter().zip(&without.values) {
            assert!(
                (value / other - 1.0).abs() < 1e-12,
                "{value} for {other} with a guess of {guess} times the lowest"
            );
        }
    }
}

#[test]
fn too_few_unknowns_are_an_error() {
    let error = modes(&chain(5, true), Wanted::Lowest(6), None);
    assert_eq!(error, Err(EigenError::TooFew { size: 5, wanted: 6 }));
    let error = count_below(&Problem::default(), 1.0);
    assert_eq!(error, Err(EigenError::TooFew { size: 0, wanted: 1 }));
}

#[test]
fn mass_or_stiffness_that_is_not_positive_is_an_error() {
    let mut problem = chain(50, true);
    problem.mass.iter_mut().for_each(|mass| *mass = -*mass);
    assert_eq!(modes(&problem, Wanted::Lowest(3), None), Err(EigenError::NotPositive));
    let mut problem = chain(50, true);
    problem.stiffness[0] = -5.0;
    assert_eq!(modes(&problem, Wanted::Lowest(3), None), Err(EigenError::NotPositive));
}

#[test]
fn unsound_pattern_or_infinite_entry_is_an_error() {
    let sound = chain(10, true);
    let mut upper = sound.clone();
    upper.rows.swap(0, 1);
    let mut short = sound.clone();
    short.mass.pop();
    let mut infinite = sound.clone();
    infinite.stiffness[3] = f64::INFINITY;
    let mut outside = sound;
    outside.rows[1] = 10;
    for problem in [upper, short, infinite, outside] {
        assert_eq!(count_below(&problem, 1.0), Err(EigenError::Malformed));
    }
}

/// Free membrane of squares, `order` + 1 nodes along each edge, all nodes of a square coupled:
/// the density of elements of a high order.
fn stencil(side: usize, order: usize) -> Problem {
    let nodes = side * order + 1;
    let (one_k, one_m) = line(order);
    let mut entries = Entries::default();
    let of = |at: usize| (at / (order + 1), at % (order + 1));
    for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
        for row in 0..(order + 1) * (order + 1) {
            for column in 0..=row {
                let ((row_x, row_y), (column_x, column_y)) = (of(row), of(column));
                let at = |across: usize, up: usize| (y * order + up) * nodes + x * order + across;
                let (k_x, m_x) = (one_k[row_x][column_x], one_m[row_x][column_x]);
                let (k_y, m_y) = (one_k[row_y][column_y], one_m[row_y][column_y]);
                entries.add(at(row_x, row_y), at(column_x, column_y), k_x * m_y + m_x * k_y, m_x * m_y);
            }
        }
    }
    entries.problem(nodes * nodes)
}

/// Stiffness and mass of a line of length 1 with equidistant nodes, by Gauss's rule of many points.
fn line(order: usize) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let nodes: Vec<f64> = (0..=order).map(|at| at as f64 / order as f64).collect();
    let shape = |of: usize, at: f64| {
        let others = || nodes.iter().enumerate().filter(move |&(other, _)| other != of);
        let value: f64 = others().map(|(_, node)| (at - node) / (nodes[of] - node)).product();
        let slope: f64 = others()
            .map(|(left, node)| {
                let rest = others().filter(|&(other, _)| other != left);
                rest.map(|(_, node)| (at - node) / (nodes[of] - node)).product::<f64>() / (nodes[of] - node)
            })
            .sum();
        (value, slope)
    };
    let (points, weights) = (
        [-0.932469514203152, -0.661209386466265, -0.238619186083197],
        [0.171324492379170, 0.360761573048139, 0.467913934572691],
    );
    let mut matrices = (vec![vec![0.0; order + 1]; order + 1], vec![vec![0.0; order + 1]; order + 1]);
    for (point, weight) in
        points.iter().flat_map(|point| [*point, -point]).zip(weights.iter().flat_map(|weight| [weight, weight]))
    {
        let at = 0.5 + 0.5 * point;
        for row in 0..=order {
            for column in 0..=order {
                let (one, other) = (shape(row, at), shape(column, at));
                matrices.0[row][column] += 0.5 * weight * one.1 * other.1;
                matrices.1[row][column] += 0.5 * weight * one.0 * other.0;
            }
        }
    }
    matrices
}

#[test]
#[ignore = "measures time: cargo test --release -p shape --test eigen -- --ignored --nocapture"]
fn sixty_four_modes_of_seven_thousand_unknowns_take_a_second_of_one_core() {
    let problem = stencil(17, 5);
    println!("{} unknowns, {} entries", problem.size, problem.rows.len());
    for wanted in [16, 64, 100] {
        let begin = cpu_time::ProcessTime::now();
        let found = find(&problem, Wanted::Lowest(wanted));
        let took = begin.elapsed();
        println!("{wanted} modes: {took:?}, {} .. {:?}", found.values[1], found.values.last());
        assert!(wanted > 64 || took.as_secs_f64() <= 1.0, "{wanted} modes take {took:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn values_are_those_of_a_dense_solver(
        size in 20_usize..90,
        links in prop::collection::vec((0_usize..1000, 0_usize..1000, 0.1_f64..10.0, -0.2_f64..0.2), 60..200),
        masses in prop::collection::vec(0.5_f64..2.0, 90),
    ) {
        let mut entries = Entries::default();
        for (at, &mass) in masses.iter().take(size).enumerate() {
            entries.add(at, at, 0.05, mass);
        }
        for (one, other, stiffness, mass) in links {
            let (one, other) = (one % size, other % size);
            if one != other {
                entries.spring(one, other, stiffness);
                entries.add(one, one, 0.0, mass.abs());
                entries.add(other, other, 0.0, mass.abs());
                entries.add(one, other, 0.0, mass);
            }
        }
        let problem = entries.problem(size);
        let found = find(&problem, Wanted::Lowest(size / 4));
        assert_close(&found.values, &dense(&problem)[..size / 4], 1e-9);
        assert_orthonormal(&problem, &found);
    }
}

/// Eigenvalues of the problem as dense matrices.
fn dense(problem: &Problem) -> Vec<f64> {
    let full = |entries: &[f64]| {
        let mut matrix = Mat::<f64>::zeros(problem.size, problem.size);
        for column in 0..problem.size {
            for at in problem.starts[column]..problem.starts[column + 1] {
                matrix[(problem.rows[at], column)] = entries[at];
                matrix[(column, problem.rows[at])] = entries[at];
            }
        }
        matrix
    };
    let (stiffness, mass) = (full(&problem.stiffness), full(&problem.mass));
    let solved = mass.self_adjoint_eigen(Side::Lower).unwrap();
    let root =
        Mat::from_fn(problem.size, problem.size, |row, column| solved.U()[(row, column)] / solved.S()[column].sqrt());
    let product = root.transpose() * &stiffness * &root;
    product.self_adjoint_eigenvalues(Side::Lower).unwrap()
}
