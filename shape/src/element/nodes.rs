//! Nodes of the elements over a mesh.

use std::collections::HashMap;

use super::locate::Grid;
use super::triangle::barycentric;
use super::{Error, Triangle};
use crate::mesh::{BoundaryEdge, Mesh};
use crate::outline::Point;

/// Distance at which a point outside its triangle still belongs to it, in barycentric coordinates.
const OUTSIDE: f64 = 1e-6;

/// Nodes on an edge of the outline.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeEdge {
    /// Side of the outline.
    pub side: usize,
    /// Nodes along the edge, both vertices included.
    pub nodes: Vec<usize>,
    /// Unit vector along the edge at each node.
    pub tangents: Vec<[f64; 2]>,
}

/// Nodes of all elements: the vertices, numbered as in the mesh, then those on edges and inside.
#[derive(Clone, Debug)]
pub struct Nodes {
    /// Position of each node, metres.
    pub positions: Vec<Point>,
    /// Nodes of each triangle, in the order of [`Triangle`].
    pub triangles: Vec<Vec<usize>>,
    /// True for each triangle with a curved edge.
    pub curved: Vec<bool>,
    /// Nodes on the edges of the outline, one entry an edge of the mesh.
    pub edges: Vec<NodeEdge>,
    /// Functions of the elements.
    pub functions: Triangle,
    grid: Grid,
}

fn key(vertices: [usize; 2]) -> [usize; 2] {
    [vertices[0].min(vertices[1]), vertices[0].max(vertices[1])]
}

/// Control points of an edge that is passed from one vertex to the other.
fn curve_from(edge: &BoundaryEdge, from: usize) -> Option<[Point; 2]> {
    edge.curve.map(|[first, second]| if edge.vertices[0] == from { [first, second] } else { [second, first] })
}

impl Nodes {
    /// Places the nodes of elements of an order on a mesh.
    pub fn new(mesh: &Mesh, order: usize) -> Result<Self, Error> {
        let functions = Triangle::new(order)?;
        let count = mesh.points.len();
        let named = mesh.triangles.iter().flatten().chain(mesh.edges.iter().flat_map(|edge| &edge.vertices));
        if let Some(vertex) = named.copied().find(|vertex| *vertex >= count) {
            return Err(Error::Vertex(vertex));
        }
        let outline: HashMap<_, _> = mesh.edges.iter().map(|edge| (key(edge.vertices), edge)).collect();
        let mut positions = mesh.points.clone();
        let mut firsts: HashMap<[usize; 2], usize> = HashMap::new();
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        let mut curved = Vec::with_capacity(mesh.triangles.len());
        for vertices in &mesh.triangles {
            let mut nodes = vertices.to_vec();
            let mut curves = [None; 3];
            for (curve, [from, to]) in curves.iter_mut().zip(Triangle::EDGES) {
                let ends = [vertices[from], vertices[to]];
                let first = *firsts.entry(key(ends)).or_insert(positions.len());
                positions.resize(positions.len().max(first + order - 1), [0.0; 2]);
                nodes.extend(along(first, order, ends));
                *curve = outline.get(&key(ends)).and_then(|edge| curve_from(edge, ends[0]));
            }
            let inner = functions.nodes().len() - functions.first_inner();
            nodes.extend(positions.len()..positions.len() + inner);
            positions.resize(positions.len() + inner, [0.0; 2]);
            let corners = vertices.map(|vertex| mesh.points[vertex]);
            for (node, at) in nodes.iter().zip(functions.nodes()).skip(3) {
                positions[*node] = blend(corners, curves, *at);
            }
            triangles.push(nodes);
            curved.push(curves.iter().any(Option::is_some));
        }
        let mut used = vec![false; count];
        mesh.triangles.iter().flatten().for_each(|vertex| used[*vertex] = true);
        if let Some(vertex) = used.iter().position(|used| !used) {
            return Err(Error::Loose(vertex));
        }
        let edges = mesh.edges.iter().map(|edge| {
            let first = *firsts.get(&key(edge.vertices)).ok_or(Error::Edge(edge.vertices))?;
            Ok(node_edge(mesh, edge, &functions, first))
        });
        let edges = edges.collect::<Result<_, _>>()?;
        let grid = Grid::new(&positions, &triangles, &curved);
        Ok(Self { positions, triangles, curved, edges, functions, grid })
    }

    /// Moves all nodes to a multiple of their positions.
    pub(super) fn stretch(&mut self, factor: f64) {
        self.positions.as_flattened_mut().iter_mut().for_each(|part| *part *= factor);
        self.grid = Grid::new(&self.positions, &self.triangles, &self.curved);
    }

    /// Returns the nodes on a side of the outline, in order of their numbers.
    pub fn on_side(&self, side: usize) -> Vec<usize> {
        let edges = self.edges.iter().filter(|edge| edge.side == side);
        let mut nodes: Vec<usize> = edges.flat_map(|edge| edge.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Returns the triangle in which a point lies and the local coordinates that it has there;
    /// `None` outside the body.
    pub fn locate(&self, point: Point) -> Option<(usize, [f64; 2])> {
        let mut best = None;
        let mut depth = -OUTSIDE;
        for triangle in self.grid.near(point) {
            let Some(local) = self.local(triangle, point) else { continue };
            let lowest = barycentric(local).into_iter().fold(f64::INFINITY, f64::min);
            if lowest >= depth {
                best = Some((triangle, local));
                depth = lowest;
            }
        }
        best
    }

    /// Returns the position of local coordinates of a triangle, metres.
    pub fn position(&self, triangle: usize, local: [f64; 2]) -> Point {
        let values = self.functions.values(local);
        let mut position = [0.0; 2];
        for (node, value) in self.triangles[triangle].iter().zip(values) {
            (0..2).for_each(|axis| position[axis] += value * self.positions[*node][axis]);
        }
        position
    }

    /// Local coordinates of a point in a triangle, inside it or not; by Newton's method if it is
    /// curved.
    fn local(&self, triangle: usize, point: Point) -> Option<[f64; 2]> {
        let nodes = &self.triangles[triangle];
        let [origin, first, second] = [0, 1, 2].map(|vertex| self.positions[nodes[vertex]]);
        let minus = |to: Point, from: Point| [to[0] - from[0], to[1] - from[1]];
        let mut local = solve(minus(first, origin), minus(second, origin), minus(point, origin))?;
        if !self.curved[triangle] {
            return Some(local);
        }
        for _ in 0..30 {
            let mut columns = [[0.0; 2]; 2];
            for (node, derivative) in nodes.iter().zip(self.functions.derivatives(local)) {
                for (column, slope) in columns.iter_mut().zip(derivative) {
                    (0..2).for_each(|axis| column[axis] += slope * self.positions[*node][axis]);
                }
            }
            let change = solve(columns[0], columns[1], minus(point, self.position(triangle, local)))?;
            // Far from the triangle its map means nothing.
            local = [0, 1].map(|axis| (local[axis] + change[axis].clamp(-0.5, 0.5)).clamp(-1.0, 2.0));
            if change[0].abs() + change[1].abs() < 1e-13 {
                return Some(local);
            }
        }
        // Rounding may keep the change above the bound.
        let missed = minus(point, self.position(triangle, local));
        let size = minus(first, origin).into_iter().chain(minus(second, origin)).fold(0.0, |a: f64, b| a.max(b.abs()));
        (missed[0].abs() + missed[1].abs() < 1e-9 * size).then_some(local)
    }
}

/// Factors of two columns that sum to a vector.
fn solve(first: [f64; 2], second: [f64; 2], sum: [f64; 2]) -> Option<[f64; 2]> {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let area = cross(first, second);
    let result = [cross(sum, second) / area, cross(first, sum) / area];
    result.iter().all(|number| number.is_finite()).then_some(result)
}

/// Nodes within an edge, numbered from its lower vertex on, passed in the direction of `ends`.
fn along(first: usize, order: usize, ends: [usize; 2]) -> impl Iterator<Item = usize> {
    let count = order - 1;
    (0..count).map(move |step| if ends[0] < ends[1] { first + step } else { first + count - 1 - step })
}

/// Position of barycentric coordinates in a triangle with straight and cubic edges.
///
/// A cubic differs from its chord by s (1 - s) times a linear function. Inside the triangle, the
/// product of two barycentric coordinates and a function of their difference take the place of
/// these: a polynomial of degree 3, which vanishes on the other edges.
fn blend(corners: [Point; 3], curves: [Option<[Point; 2]>; 3], at: [f64; 3]) -> Point {
    [0, 1].map(|axis| {
        let mut position: f64 = (0..3).map(|corner| at[corner] * corners[corner][axis]).sum();
        for (curve, [from, to]) in curves.iter().zip(Triangle::EDGES) {
            let Some([first, second]) = curve else { continue };
            let part = (1.0 + at[to] - at[from]) / 2.0;
            let bulge = 3.0 * (1.0 - part) * first[axis] + 3.0 * part * second[axis]
                - (2.0 - part) * corners[from][axis]
                - (1.0 + part) * corners[to][axis];
            position += at[from] * at[to] * bulge;
        }
        position
    })
}

fn node_edge(mesh: &Mesh, edge: &BoundaryEdge, functions: &Triangle, first: usize) -> NodeEdge {
    let order = functions.order();
    let [from, to] = edge.vertices;
    let mut nodes = vec![from];
    nodes.extend(along(first, order, edge.vertices));
    nodes.push(to);
    let begin = mesh.points[from];
    let end = mesh.points[to];
    let unit = |vector: [f64; 2]| {
        let length = vector[0].hypot(vector[1]);
        (length > 0.0).then(|| vector.map(|part| part / length))
    };
    let chord = unit([end[0] - begin[0], end[1] - begin[1]]).unwrap_or([1.0, 0.0]);
    // The nodes within the first edge of the triangle are passed from its begin to its end.
    let parts = std::iter::once(0.0)
        .chain(functions.nodes()[3..3 + order - 1].iter().map(|node| node[1]))
        .chain(std::iter::once(1.0));
    let tangents = parts.map(|part| {
        let Some([first, second]) = edge.curve else { return chord };
        let rest: f64 = 1.0 - part;
        let slope = [0, 1].map(|axis| {
            rest * rest * (first[axis] - begin[axis])
                + 2.0 * rest * part * (second[axis] - first[axis])
                + part * part * (end[axis] - second[axis])
        });
        unit(slope).unwrap_or(chord)
    });
    NodeEdge { side: edge.side, nodes, tangents: tangents.collect() }
}
