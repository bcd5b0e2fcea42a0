//! Picture of a body and of its lowest modes: points, triangles, and how each point moves.

use std::collections::HashSet;

use super::SolveError;
use super::parts::{Matrices, Part, Place};
use super::places::Places;
use crate::element::{Discrete, Triangle};
use crate::mesh::Mesh;
use crate::outline::Point;

/// Maximum number of modes in a picture, the lowest.
pub const MOST_MODES: usize = 16;
/// Number of triangles into which all elements together are parted, about.
const PIECES: f64 = 30_000.0;
/// Maximum number of parts of an element's edge.
const MOST_PARTS: usize = 12;

/// Picture of a body and of its lowest modes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Points of the triangles and then those of the rim, metres.
    pub points: Vec<Point>,
    /// True for each point on the outline.
    pub on_rim: Vec<bool>,
    /// Points of each triangle, counter-clockwise; an element is parted into several triangles.
    pub triangles: Vec<[usize; 3]>,
    /// Points along each edge of the mesh on the outline, both ends included.
    pub rim: Vec<Vec<usize>>,
    /// Ends of each edge of the mesh inside the body, metres.
    pub inner_edges: Vec<[Point; 2]>,
    /// Places of strikes in the order of the positions, metres.
    pub strikes: Vec<Point>,
    /// Point of the body that is heard, metres; `None` for other readouts.
    pub heard: Option<Point>,
    /// Motion in each mode, the lowest first; at most [`MOST_MODES`].
    pub motions: Vec<Motion>,
}

/// Motion of a body in a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Number of waves round the axis of a body of revolution; 0 for other bodies.
    pub waves: u32,
    /// True for the second of a pair, whose waves lie a quarter of a wave further round the axis.
    pub is_second: bool,
    /// Motion of each point of the picture, shapes of unit modal mass: of plates and membranes
    /// the normal one and two slopes, of sheets that along x and y, of bodies of revolution the
    /// radial one, that round the axis, and that along it.
    pub at: Vec<[f32; 3]>,
}

/// Mesh that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// Number of unknowns.
    pub unknowns: usize,
    /// Number of triangles, of a solid cells.
    pub elements: usize,
    /// Frequencies of the modes without damping, Hz.
    pub frequencies_hz: Vec<f64>,
}

/// Place in an element of each point, and the points of each of its triangles.
struct Parting {
    /// Barycentric steps of each point: three numbers that sum to the number of parts.
    steps: Vec<[usize; 3]>,
    triangles: Vec<[usize; 3]>,
}

impl Parting {
    /// Parts an element into as many triangles as the square of a number.
    fn new(parts: usize) -> Self {
        let row = |second: usize| (0..=parts - second).map(move |first| [parts - first - second, first, second]);
        let steps: Vec<[usize; 3]> = (0..=parts).flat_map(row).collect();
        // Number of points in the rows below one.
        let begin = |second: usize| second * (2 * parts + 3 - second) / 2;
        let cell = |[first, second]: [usize; 2]| {
            let (low, high) = (begin(second) + first, begin(second + 1) + first);
            let is_whole = first + second + 2 <= parts;
            let other = is_whole.then_some([low + 1, high + 1, high]);
            std::iter::once([low, low + 1, high]).chain(other)
        };
        let cells = (0..parts).flat_map(|second| (0..parts - second).map(move |first| [first, second]));
        Self { steps, triangles: cells.flat_map(cell).collect() }
    }
}

/// Draws the picture of the lowest modes, which lie at places among the parts of the motion.
pub(super) fn of(mesh: &Mesh, parts: &[Part], places: &[Place], strikes: &Places) -> Result<Figure, SolveError> {
    let Some(Matrices::Flat(first)) = parts.first().map(|part| &part.matrices) else { return Ok(Figure::default()) };
    let nodes = &first.nodes;
    let count = (PIECES / mesh.triangles.len() as f64).sqrt() as usize;
    let count = count.clamp(1, MOST_PARTS);
    let parting = Parting::new(count);
    let local = |steps: &[usize; 3]| [steps[1] as f64 / count as f64, steps[2] as f64 / count as f64];
    let values: Vec<Vec<f64>> = parting.steps.iter().map(|steps| nodes.functions.values(local(steps))).collect();
    let mut figure = Figure { strikes: strikes.struck(), heard: strikes.heard_point(), ..Figure::default() };
    let rim: HashSet<[usize; 2]> = mesh.edges.iter().map(|edge| key(edge.vertices)).collect();
    let on_rim: HashSet<usize> = mesh.edges.iter().flat_map(|edge| edge.vertices).collect();
    for (element, vertices) in nodes.triangles.iter().zip(&mesh.triangles) {
        let begin = figure.points.len();
        let of_element = parting.triangles.iter().map(|corners| corners.map(|corner| begin + corner));
        figure.triangles.extend(of_element);
        // Edge against each vertex.
        let edges = [[1, 2], [2, 0], [0, 1]].map(|ends| rim.contains(&key(ends.map(|end: usize| vertices[end]))));
        for (steps, values) in parting.steps.iter().zip(&values) {
            let sum = |axis: usize| element.iter().zip(values).map(|(&node, v)| v * nodes.positions[node][axis]).sum();
            figure.points.push([0, 1].map(sum));
            let is_on_edge = (0..3).any(|corner| edges[corner] && steps[corner] == 0);
            let is_vertex = (0..3).any(|corner| steps[corner] == count && on_rim.contains(&vertices[corner]));
            figure.on_rim.push(is_on_edge || is_vertex);
        }
    }
    for edge in &nodes.edges {
        let begin = figure.points.len();
        figure.points.extend(edge.nodes.iter().map(|&node| nodes.positions[node]));
        figure.rim.push((begin..figure.points.len()).collect());
    }
    figure.on_rim.resize(figure.points.len(), true);
    figure.inner_edges = inner_edges(mesh, &nodes.positions, &rim);
    for place in places.iter().take(MOST_MODES) {
        let part = parts.get(place.part).ok_or(SolveError::NoModes)?;
        let vector = part.found.vectors.get(place.index).ok_or(SolveError::NoModes)?;
        let Matrices::Flat(discrete) = &part.matrices else { continue };
        let at = motion(discrete, vector, &values);
        figure.motions.push(Motion { waves: part.waves, is_second: place.is_second, at });
    }
    Ok(figure)
}

/// Motion of all points, from the values of all functions at the points of an element.
fn motion(discrete: &Discrete, vector: &[f64], values: &[Vec<f64>]) -> Vec<[f32; 3]> {
    let mut at = Vec::new();
    for element in &discrete.nodes.triangles {
        let own: Vec<[f64; 3]> = element.iter().map(|&node| discrete.at_node(vector, node)).collect();
        at.extend(values.iter().map(|values| {
            let component = |axis: usize| own.iter().zip(values).map(|(own, v)| v * own[axis]).sum::<f64>() as f32;
            [0, 1, 2].map(component)
        }));
    }
    let rim = discrete.nodes.edges.iter().flat_map(|edge| &edge.nodes);
    at.extend(rim.map(|&node| discrete.at_node(vector, node).map(|value| value as f32)));
    at
}

fn key([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// Edges of the mesh that are not on the outline, each once; vertices are the first nodes.
fn inner_edges(mesh: &Mesh, positions: &[Point], rim: &HashSet<[usize; 2]>) -> Vec<[Point; 2]> {
    let sides = |vertices: &[usize; 3]| Triangle::EDGES.map(|ends| key(ends.map(|end| vertices[end])));
    let mut seen: HashSet<[usize; 2]> = HashSet::new();
    let edges = mesh.triangles.iter().flat_map(sides);
    let inner = edges.filter(|edge| !rim.contains(edge) && seen.insert(*edge));
    inner.map(|ends| ends.map(|end| positions[end])).collect()
}

#[cfg(test)]
mod tests {
    use super::Parting;

    #[test]
    fn parts_of_an_element_cover_it_once_and_run_counter_clockwise() {
        for parts in 1..6 {
            let parting = Parting::new(parts);
            assert_eq!(parting.triangles.len(), parts * parts);
            let at = |corner: usize| parting.steps[corner].map(|step| step as f64 / parts as f64);
            let mut whole = 0.0;
            for corners in &parting.triangles {
                let [a, b, c] = corners.map(at);
                let twice = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
                assert!((twice * (parts * parts) as f64 - 1.0).abs() < 1e-12, "{twice}");
                whole += twice;
            }
            assert!((whole - 1.0).abs() < 1e-12, "{whole}");
        }
    }
}
