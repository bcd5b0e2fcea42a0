//! Assembly of the matrices of all elements.

use pulp::Arch;

use super::discrete::to_axes;
use super::support::Ties;
use super::triangle::Sample;
use super::{Discrete, Error, Nodes};
use crate::eigen::Problem;
use crate::outline::Point;

/// Most strains of a body.
pub(super) const STRAINS: usize = 6;

/// Body as the integral of energies that are quadratic in strains and velocities.
pub(super) trait Body {
    /// Number of components of the motion.
    const COMPONENTS: usize;
    /// Number of strains.
    const STRAINS: usize;
    /// First of the two components that nodes take in axes of their own.
    const TURNED: Option<usize>;

    /// True if strains need lowered vectors.
    const LOWERED: bool = false;

    /// Returns the strains, by each component, of one function with a value and derivatives. For
    /// each axis `lowered` is the vector of this value along it, less what its order exceeds.
    fn strains(&self, value: f64, lowered: [[f64; 2]; 2], slope: [f64; 2], at: Point) -> [[f64; 3]; STRAINS];
    /// Returns the stiffness for the strains.
    fn stiffness(&self) -> [[f64; STRAINS]; STRAINS];
    /// Returns the mass a unit of area for each component.
    fn inertia(&self) -> [f64; 3];
    /// Returns the mass a unit of area of the deflection times the sum of the first two strains,
    /// and of that sum squared.
    fn swelling(&self) -> Option<[f64; 2]> {
        None
    }
    /// Returns the factor of both energies at a point.
    fn weight(&self, _at: Point) -> f64 {
        1.0
    }
    /// Returns the motions that store no energy; lengths are in units of the size of the body.
    fn rigid(&self, at: Point) -> Vec<[f64; 3]>;
    /// Returns whether strains or weights are no polynomials on straight triangles.
    fn uneven(&self) -> bool {
        false
    }
}

/// Assembles a body on its nodes.
pub(super) fn assemble<B: Body>(body: &B, nodes: Nodes, ties: Ties) -> Result<Discrete, Error> {
    let mut size = 0;
    let mut unknowns = vec![[None; 3]; nodes.positions.len()];
    for (unknowns, fixed) in unknowns.iter_mut().zip(&ties.fixed) {
        for (unknown, fixed) in unknowns.iter_mut().zip(fixed).take(B::COMPONENTS) {
            if !fixed {
                *unknown = Some(size);
                size += 1;
            }
        }
    }
    if size == 0 {
        return Err(Error::Held);
    }
    let mut problem = pattern(&nodes, &unknowns, size);
    let order = nodes.functions.order();
    let even = nodes.functions.samples(2 * order);
    let rich = nodes.functions.samples(3 * order + 2);
    for (number, triangle) in nodes.triangles.iter().enumerate() {
        let samples = if nodes.curved[number] || body.uneven() { &rich } else { &even };
        let element = Element::new(body, &nodes, &ties, number, samples)?;
        let places: Vec<Option<usize>> =
            triangle.iter().flat_map(|node| unknowns[*node][..B::COMPONENTS].iter().copied()).collect();
        scatter(&mut problem, &places, |row, column| {
            let entry = row * places.len() + column;
            [element.stiffness[entry], element.mass[entry]]
        });
    }
    let rigid = rigid(body, &nodes, &ties);
    Ok(Discrete { problem, nodes, components: B::COMPONENTS, unknowns, axes: ties.axes, turned: B::TURNED, rigid })
}

/// Adds the entries of an element's stiffness and mass, given by row and column, to the lower
/// triangle of a problem at the unknowns that are not held.
pub(super) fn scatter(problem: &mut Problem, places: &[Option<usize>], entries: impl Fn(usize, usize) -> [f64; 2]) {
    for (row, row_place) in places.iter().enumerate() {
        for (column, column_place) in places.iter().enumerate() {
            let (Some(at_row), Some(at_column)) = (*row_place, *column_place) else { continue };
            if at_row < at_column {
                continue;
            }
            let begin = problem.starts[at_column];
            let rows = &problem.rows[begin..problem.starts[at_column + 1]];
            let entry = begin + rows.partition_point(|other| *other < at_row);
            let [stiffness, mass] = entries(row, column);
            problem.stiffness[entry] += stiffness;
            problem.mass[entry] += mass;
        }
    }
}

/// Lower triangle of all unknowns that share an element, without entries; `unknowns` are those of
/// each node, numbered node by node.
pub(super) fn pattern(nodes: &Nodes, unknowns: &[impl AsRef<[Option<usize>]>], size: usize) -> Problem {
    let of_triangle =
        |triangle: usize| nodes.triangles[triangle].iter().flat_map(|node| unknowns[*node].as_ref()).copied().flatten();
    let mut triangles = vec![Vec::new(); nodes.positions.len()];
    for (number, members) in nodes.triangles.iter().enumerate() {
        members.iter().for_each(|node| triangles[*node].push(number));
    }
    let mut problem = Problem { size, starts: vec![0], ..Problem::default() };
    for (node, triangles) in triangles.iter().enumerate() {
        let mut near: Vec<usize> = triangles.iter().flat_map(|triangle| of_triangle(*triangle)).collect();
        near.sort_unstable();
        near.dedup();
        for unknown in unknowns[node].as_ref().iter().copied().flatten() {
            problem.rows.extend(near.iter().filter(|row| **row >= unknown));
            problem.starts.push(problem.rows.len());
        }
    }
    problem.stiffness = vec![0.0; problem.rows.len()];
    problem.mass = vec![0.0; problem.rows.len()];
    problem
}

/// Matrices of one element, by rows, in the axes of its nodes.
struct Element {
    stiffness: Vec<f64>,
    mass: Vec<f64>,
}

impl Element {
    fn new<B: Body>(body: &B, nodes: &Nodes, ties: &Ties, number: usize, samples: &[Sample]) -> Result<Self, Error> {
        let members = &nodes.triangles[number];
        let size = members.len() * B::COMPONENTS;
        let elasticity = body.stiffness();
        let inertia = body.inertia();
        let swelling = body.swelling();
        let mut element = Self { stiffness: vec![0.0; size * size], mass: vec![0.0; size * size] };
        let mut strains = vec![vec![0.0; size]; STRAINS];
        // Integrals of the products of two functions, by rows.
        let mut masses = vec![0.0; members.len() * members.len()];
        let lowered = if B::LOWERED { lower(nodes, members, samples) } else { Vec::new() };
        for sample in samples {
            let (at, map) = place(nodes, members, sample);
            let area = map[0][0] * map[1][1] - map[0][1] * map[1][0];
            if area.is_nan() || area <= 0.0 {
                return Err(Error::Folded(number));
            }
            let from_local = |[first, second]: [f64; 2]| {
                [(first * map[1][1] - second * map[0][1]) / area, (second * map[0][0] - first * map[1][0]) / area]
            };
            let weight = sample.weight * area * body.weight(at);
            for (index, (node, value)) in members.iter().zip(&sample.values).enumerate() {
                let slope = from_local(sample.derivatives[index]);
                let mut vectors = [[0.0; 2]; 2];
                for (polynomial, parts) in sample.lower.iter().zip(&lowered) {
                    for (vector, part) in vectors.as_flattened_mut().iter_mut().zip(parts[index].as_flattened()) {
                        *vector += polynomial * part;
                    }
                }
                let strain = body.strains(*value, vectors.map(from_local), slope, at);
                for (row, strain) in strain.into_iter().enumerate() {
                    let own = to_axes(strain, ties.axes[*node], B::TURNED);
                    for (component, part) in own.into_iter().enumerate().take(B::COMPONENTS) {
                        strains[row][index * B::COMPONENTS + component] = part;
                    }
                }
            }
            for (row, value) in masses.chunks_exact_mut(members.len()).zip(&sample.values) {
                row.iter_mut().zip(&sample.values).for_each(|(entry, other)| *entry += weight * value * other);
            }
            if let Some(masses) = swelling {
                element.swell(masses.map(|mass| mass * weight), &strains, &sample.values, B::COMPONENTS);
            }
            element.strain(&elasticity, &strains[..B::STRAINS], weight);
        }
        for (index, node) in members.iter().enumerate() {
            for (other, partner_node) in members.iter().enumerate() {
                // Components do not couple, unless the axes of two nodes differ.
                let turn = between(ties.axes[*node], ties.axes[*partner_node], B::TURNED);
                for component in 0..B::COMPONENTS {
                    let begin = (index * B::COMPONENTS + component) * size + other * B::COMPONENTS;
                    let mass = inertia[component] * masses[index * members.len() + other];
                    let entries = element.mass[begin..begin + B::COMPONENTS].iter_mut();
                    entries.zip(turn[component]).for_each(|(entry, turn)| *entry += mass * turn);
                }
            }
        }
        for row in 0..size {
            for column in 0..row {
                element.stiffness[column * size + row] = element.stiffness[row * size + column];
            }
        }
        Ok(element)
    }

    /// Adds the lower triangle of the stiffness at a sample, from the strains by all unknowns.
    fn strain(&mut self, elasticity: &[[f64; STRAINS]; STRAINS], strains: &[Vec<f64>], weight: f64) {
        let size = strains.first().map_or(0, Vec::len);
        Arch::new().dispatch(|| {
            for (row, entries) in self.stiffness.chunks_exact_mut(size).enumerate() {
                for (line, others) in elasticity.iter().zip(strains) {
                    let stress: f64 = line.iter().zip(strains).map(|(modulus, strain)| modulus * strain[row]).sum();
                    if stress != 0.0 {
                        let stress = weight * stress;
                        entries[..=row].iter_mut().zip(others).for_each(|(entry, other)| *entry += stress * other);
                    }
                }
            }
        });
    }

    /// Adds the masses of the swelling at a sample.
    fn swell(&mut self, [mixed, own]: [f64; 2], strains: &[Vec<f64>], values: &[f64], components: usize) {
        let sums: Vec<f64> = strains[0].iter().zip(&strains[1]).map(|(x, y)| x + y).collect();
        let deflection = |row: usize| if row.is_multiple_of(components) { values[row / components] } else { 0.0 };
        let deflections: Vec<f64> = (0..sums.len()).map(deflection).collect();
        Arch::new().dispatch(|| {
            for ((entries, sum), deflection) in self.mass.chunks_exact_mut(sums.len()).zip(&sums).zip(&deflections) {
                let (of_sum, of_deflection) = (mixed * deflection + own * sum, mixed * sum);
                for ((entry, sum), deflection) in entries.iter_mut().zip(&sums).zip(&deflections) {
                    *entry += of_sum * sum + of_deflection * deflection;
                }
            }
        });
    }
}

/// Position of a sample, and its derivatives by both local coordinates.
pub(super) fn place(nodes: &Nodes, members: &[usize], sample: &Sample) -> (Point, [[f64; 2]; 2]) {
    let mut at = [0.0; 2];
    let mut map = [[0.0; 2]; 2];
    for ((node, value), slope) in members.iter().zip(&sample.values).zip(&sample.derivatives) {
        for axis in 0..2 {
            at[axis] += value * nodes.positions[*node][axis];
            map[0][axis] += slope[0] * nodes.positions[*node][axis];
            map[1][axis] += slope[1] * nodes.positions[*node][axis];
        }
    }
    (at, map)
}

/// Parts, along both local coordinates, of each function's vectors along x and y, by the
/// orthonormal polynomials of one order less. Local coordinates are those in which gradients have
/// that order.
fn lower(nodes: &Nodes, members: &[usize], samples: &[Sample]) -> Vec<Vec<[[f64; 2]; 2]>> {
    let polynomials = samples.first().map_or(0, |sample| sample.lower.len());
    let mut parts = vec![vec![[[0.0; 2]; 2]; members.len()]; polynomials];
    for sample in samples {
        let map = place(nodes, members, sample).1;
        for (parts, polynomial) in parts.iter_mut().zip(&sample.lower) {
            for (part, value) in parts.iter_mut().zip(&sample.values) {
                for (axis, vector) in part.iter_mut().enumerate() {
                    (0..2).for_each(|local| vector[local] += sample.weight * polynomial * value * map[local][axis]);
                }
            }
        }
    }
    parts
}

/// Cosines between the axes of two nodes, by components.
fn between(axis: [f64; 2], other: [f64; 2], turned: Option<usize>) -> [[f64; 3]; 3] {
    let mut result = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    if let Some(first) = turned {
        let cosine = axis[0] * other[0] + axis[1] * other[1];
        let sine = axis[0] * other[1] - axis[1] * other[0];
        result[first][first] = cosine;
        result[first][first + 1] = -sine;
        result[first + 1][first] = sine;
        result[first + 1][first + 1] = cosine;
    }
    result
}

/// Number of rigid motions that the ties allow: all less the rank of what is held of them.
pub(super) fn rigid<B: Body>(body: &B, nodes: &Nodes, ties: &Ties) -> usize {
    let mut held: Vec<Vec<f64>> = Vec::new();
    let [low, high] = super::locate::bounds(nodes.positions.iter().copied());
    let size = (high[0] - low[0]).max(high[1] - low[1]);
    let mut all = 0;
    for (node, position) in nodes.positions.iter().enumerate() {
        let motions = body.rigid(position.map(|part| part / size));
        all = motions.len();
        let own: Vec<_> = motions.iter().map(|motion| to_axes(*motion, ties.axes[node], B::TURNED)).collect();
        for component in (0..B::COMPONENTS).filter(|component| ties.fixed[node][*component]) {
            let mut row: Vec<f64> = own.iter().map(|motion| motion[component]).collect();
            // Gram and Schmidt's step, twice: the row less its parts along the rows that are held.
            for before in held.iter().chain(&held) {
                let part: f64 = row.iter().zip(before).map(|(a, b)| a * b).sum();
                row.iter_mut().zip(before).for_each(|(entry, other)| *entry -= part * other);
            }
            let length = row.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
            if length > 1e-6 {
                held.push(row.into_iter().map(|entry| entry / length).collect());
            }
        }
    }
    all - held.len()
}
