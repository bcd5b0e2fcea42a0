//! Matrices of the body from those of its cells.

use std::collections::HashMap;

use super::cell::{CellMatrices, Functions, NODES, parts};
use super::functions::FUNCTIONS;
use super::moments::Inside;
use super::{Cells, Grid, ORDER, Solid};
use crate::eigen::Problem;

/// Assembles the cells that have a part inside the body.
pub(super) fn assemble(solid: &Solid, grid: &Grid, moments: &[Inside]) -> Cells {
    let lattice = grid.counts().map(|count| ORDER * count + 1);
    let mut nodes = vec![None; lattice.iter().product()];
    let mut cells = vec![None; moments.len()];
    let mut active = Vec::new();
    for (number, inside) in moments.iter().enumerate() {
        if matches!(inside, Inside::None) {
            continue;
        }
        cells[number] = Some(active.len());
        active.push((number, lattice_nodes(grid.place(number), lattice)));
    }
    for (_, members) in &active {
        members.iter().for_each(|node| nodes[*node] = Some(0));
    }
    let mut count = 0;
    let last = grid.counts().map(|count| ORDER * count);
    dissect([[0; 3], last], &mut |[x, y, z]| {
        if let Some(node) = &mut nodes[(x * lattice[1] + y) * lattice[2] + z] {
            *node = count;
            count += 1;
        }
    });
    let members: Vec<Vec<usize>> =
        active.iter().map(|(_, members)| members.iter().filter_map(|node| nodes[*node]).collect()).collect();
    let mut problem = pattern(&members, count);
    let functions = Functions::new();
    // Matrices of whole cells by their edges: few, as planes are even between faces.
    let mut wholes: HashMap<[u64; 3], CellMatrices> = HashMap::new();
    let extents = grid.extents_m();
    let mut volume_m3 = 0.0;
    for ((number, _), members) in active.iter().zip(&members) {
        let (inside, edges_m) = (&moments[*number], grid.edges_m(grid.place(*number)));
        volume_m3 += share(inside) * edges_m.iter().product::<f64>();
        let key = [0, 1, 2].map(|axis| (edges_m[axis] / extents[axis] * 1e9).round() as u64);
        let whole = wholes.entry(key).or_insert_with(|| functions.matrices(solid, &Inside::All, edges_m, None));
        match inside {
            Inside::Part(_) => add(&mut problem, &functions.matrices(solid, inside, edges_m, Some(whole)), members),
            Inside::None | Inside::All => add(&mut problem, whole, members),
        }
    }
    Cells { problem, grid: grid.clone(), cells, members, mass_kg: solid.density * volume_m3 }
}

/// Visits the nodes of a box, both corners included, by nested dissection (George 1973): a plane of
/// nodes between cells comes after both halves that it parts, so that these never meet.
fn dissect([low, high]: [[usize; 3]; 2], visit: &mut impl FnMut([usize; 3])) {
    // Planes between cells strictly within the box.
    let planes = |axis: usize| low[axis] / ORDER + 1..high[axis].div_ceil(ORDER);
    let longest = (0..3).max_by_key(|&axis| planes(axis).len()).unwrap_or(0);
    let within = planes(longest);
    if within.is_empty() {
        return all([low, high], visit);
    }
    let plane = ORDER * (within.start + within.len() / 2);
    let [mut first, mut second, mut between] = [[low, high]; 3];
    first[1][longest] = plane - 1;
    second[0][longest] = plane + 1;
    between[0][longest] = plane;
    between[1][longest] = plane;
    dissect(first, visit);
    dissect(second, visit);
    all(between, visit);
}

/// Visits all nodes of a box, both corners included.
fn all([low, high]: [[usize; 3]; 2], visit: &mut impl FnMut([usize; 3])) {
    let line = |axis: usize| low[axis]..=high[axis];
    line(0).for_each(|x| line(1).for_each(|y| line(2).for_each(|z| visit([x, y, z]))));
}

fn share(inside: &Inside) -> f64 {
    match inside {
        Inside::None => 0.0,
        Inside::All => 1.0,
        Inside::Part(moments) => moments[0],
    }
}

/// Numbers, on the lattice of all nodes, of a cell's nodes, the third axis first.
fn lattice_nodes(cell: [usize; 3], lattice: [usize; 3]) -> Vec<usize> {
    let of = |node: usize| {
        let place = parts(node, FUNCTIONS);
        let [x, y, z] = [0, 1, 2].map(|axis| ORDER * cell[axis] + place[axis]);
        (x * lattice[1] + y) * lattice[2] + z
    };
    (0..NODES).map(of).collect()
}

/// Pattern of all unknowns that share a cell: three of each node.
fn pattern(members: &[Vec<usize>], count: usize) -> Problem {
    let mut cells = vec![Vec::new(); count];
    for (cell, members) in members.iter().enumerate() {
        members.iter().for_each(|node| cells[*node].push(cell));
    }
    let mut problem = Problem { size: 3 * count, starts: vec![0], is_ordered: true, ..Problem::default() };
    for (node, cells) in cells.iter().enumerate() {
        let mut near: Vec<usize> = cells.iter().flat_map(|cell| &members[*cell]).copied().collect();
        near.retain(|other| *other >= node);
        near.sort_unstable();
        near.dedup();
        for component in 0..3 {
            let rows = near.iter().flat_map(|other| (0..3).map(move |part| 3 * other + part));
            problem.rows.extend(rows.filter(|row| *row >= 3 * node + component));
            problem.starts.push(problem.rows.len());
        }
    }
    problem.stiffness = vec![0.0; problem.rows.len()];
    problem.mass = vec![0.0; problem.rows.len()];
    problem
}

fn add(problem: &mut Problem, cell: &CellMatrices, members: &[usize]) {
    for (b, &column_node) in members.iter().enumerate() {
        for j in 0..3 {
            let column = 3 * column_node + j;
            let begin = problem.starts[column];
            let rows = &problem.rows[begin..problem.starts[column + 1]];
            for (a, &row_node) in members.iter().enumerate().filter(|(_, node)| **node >= column_node) {
                // A node's three rows lie side by side; in its own column those from the diagonal
                // on.
                let first = if row_node == column_node { j } else { 0 };
                let entry = begin + rows.partition_point(|row| *row < 3 * row_node + first);
                for i in first..3 {
                    problem.stiffness[entry + i - first] += cell.stiffness[i][j][(a, b)];
                }
                if first <= j {
                    problem.mass[entry + j - first] += cell.mass[(a, b)];
                }
            }
        }
    }
}
