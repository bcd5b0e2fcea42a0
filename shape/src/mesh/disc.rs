//! Mesh over a circle, with or without a concentric hole, that a quarter turn maps onto itself.

use super::boundary::{angle, curve_parameters};
use super::free::misfits;
use super::{BoundaryEdge, Mesh, Sizing};
use crate::outline::side::{between, distance, mix};
use crate::outline::{FlatSide, Outline, Point};

/// Share of the radius by which points may be off the circle.
const ROUND: f64 = 2e-3;

/// Radius of the corners of the block of square cells in the middle, in radii.
const BLOCK: f64 = 0.55;

/// Circle of an outline.
struct Circle<'a> {
    centre: Point,
    radius: f64,
    sides: &'a [FlatSide],
    first: usize,
    layered: bool,
}

/// Node on a circle.
struct Node {
    at: Point,
    side: usize,
    span: [f64; 2],
}

/// Makes the mesh if the outline is a circle's.
pub(super) fn mesh(outline: &Outline, sides: &[FlatSide], sizing: &Sizing) -> Option<Mesh> {
    let count = outline.rings[0].len();
    let outer = Circle::new(&sides[..count], 0, sizing)?;
    let mesh = match outline.rings.len() {
        1 => disc(&outer, sizing)?,
        2 => ring(&outer, &Circle::new(&sides[count..], count, sizing)?, sizing)?,
        _ => return None,
    };
    let upright = (0..mesh.triangles.len()).all(|triangle| mesh.triangle_area(triangle) > 0.0);
    (upright && misfits(&mesh).is_empty()).then_some(mesh)
}

impl<'a> Circle<'a> {
    /// Takes a ring as a circle if it is one of 4, 8, 12, … even arcs, all layered or none.
    fn new(sides: &'a [FlatSide], first: usize, sizing: &Sizing) -> Option<Circle<'a>> {
        let count = sides.len();
        if !count.is_multiple_of(4) || sides.iter().any(|side| side.curve.is_none()) {
            return None;
        }
        let sum = sides.iter().fold([0.0; 2], |sum, side| [sum[0] + side.from[0], sum[1] + side.from[1]]);
        let centre = sum.map(|x| x / count as f64);
        let radius = distance(centre, sides[0].from);
        let arc = 2.0 * std::f64::consts::PI / count as f64;
        let fits = |side: &FlatSide| {
            let round = (0..8).all(|k| {
                let far = distance(centre, side.point(f64::from(k) / 8.0));
                (far - radius).abs() < ROUND * radius
            });
            round && (angle(between(centre, side.from), between(centre, side.to)).abs() - arc).abs() < ROUND
        };
        let layered = sizing.is_layered(first);
        let alike = (first..first + count).all(|side| sizing.is_layered(side) == layered);
        (alike && sides.iter().all(fits)).then_some(Circle { centre, radius, sides, first, layered })
    }

    /// Gives the width of the layer, metres; 0 without one.
    fn layer(&self, sizing: &Sizing) -> f64 {
        sizing.layer_m.filter(|_| self.layered).unwrap_or(0.0)
    }

    /// Gives the edges per side that size and turn need.
    fn edges_per_side(&self, sizing: &Sizing) -> usize {
        let layer = sizing.layer_m.filter(|_| self.layered);
        let edges = |side: &FlatSide| curve_parameters(side, sizing.size_m, layer, None).len() - 1;
        self.sides.iter().map(edges).max().unwrap_or(1)
    }

    /// Places a count of nodes on each side.
    fn nodes(&self, per_side: usize) -> Vec<Node> {
        let place = |(k, side): (usize, &FlatSide)| {
            let parameters = curve_parameters(side, 1.0, None, Some(per_side));
            let node = |span: &[f64]| Node { at: side.point(span[0]), side: self.first + k, span: [span[0], span[1]] };
            parameters.windows(2).map(node).collect::<Vec<Node>>()
        };
        self.sides.iter().enumerate().flat_map(place).collect()
    }

    /// Adds the edges on the circle, whose nodes have these names.
    fn push_edges(&self, mesh: &mut Mesh, nodes: &[Node], names: &[usize]) {
        for (k, node) in nodes.iter().enumerate() {
            let part = self.sides[node.side - self.first].part(node.span[0], node.span[1]);
            let vertices = [names[k], names[(k + 1) % names.len()]];
            mesh.edges.push(BoundaryEdge { vertices, side: node.side, curve: part.curve });
        }
    }
}

/// Makes the mesh over a disc: a block of square cells, and rows of cells around it.
fn disc(outer: &Circle<'_>, sizing: &Sizing) -> Option<Mesh> {
    let layer = Some(outer.layer(sizing)).filter(|layer| 4.0 * layer <= 2.0 * outer.radius).unwrap_or(0.0);
    let nodes = outer.nodes(outer.edges_per_side(sizing));
    let quarter = nodes.len() / 4;
    let block = BLOCK.min(0.7 * (1.0 - layer / outer.radius));
    // Half straight, half round.
    let rim: Vec<Point> = (0..nodes.len())
        .map(|k| {
            let (q, share) = (k / quarter, (k % quarter) as f64 / quarter as f64);
            let chord = mix(nodes[q * quarter].at, nodes[(q + 1) % 4 * quarter].at, share);
            mix(outer.centre, mix(chord, nodes[k].at, 0.5), block)
        })
        .collect();
    let mut mesh = Mesh { points: Vec::new(), triangles: Vec::new(), edges: Vec::new() };
    let inside = push_block(&mut mesh, &rim, quarter);
    let least = rim.iter().map(|p| distance(outer.centre, *p)).fold(f64::INFINITY, f64::min);
    let count = ((outer.radius - layer - least) / sizing.size_m).ceil().max(1.0) as usize;
    let mut rows = vec![inside];
    let mut push_row = |mesh: &mut Mesh, at: &dyn Fn(usize) -> Point| {
        let first = mesh.points.len();
        mesh.points.extend((0..nodes.len()).map(at));
        rows.push((first..mesh.points.len()).collect());
    };
    let last = |k: usize| mix(nodes[k].at, outer.centre, layer / outer.radius);
    for row in 1..count {
        push_row(&mut mesh, &|k| mix(rim[k], last(k), row as f64 / count as f64));
    }
    if layer > 0.0 {
        push_row(&mut mesh, &last);
    }
    push_row(&mut mesh, &|k| nodes[k].at);
    push_rows(&mut mesh, &rows);
    outer.push_edges(&mut mesh, &nodes, &rows[rows.len() - 1]);
    Some(mesh)
}

/// Adds the block of square cells inside a rim; gives the names of the rim's points.
fn push_block(mesh: &mut Mesh, rim: &[Point], quarter: usize) -> Vec<usize> {
    let n = quarter;
    let at = |k: usize| rim[k % rim.len()];
    let name = |i: usize, j: usize| j * (n + 1) + i;
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (i as f64 / n as f64, j as f64 / n as f64);
            let (low, high) = (at(i), at(3 * n - i));
            let (left, right) = (at(4 * n - j), at(n + j));
            let lines = [mix(low, high, y), mix(left, right, x)];
            let corners = mix(mix(at(0), at(n), x), mix(at(3 * n), at(2 * n), x), y);
            mesh.points.push([0, 1].map(|axis| lines[0][axis] + lines[1][axis] - corners[axis]));
        }
    }
    for j in 0..n {
        for i in 0..n {
            mesh.push_cell([name(i, j), name(i + 1, j), name(i + 1, j + 1), name(i, j + 1)]);
        }
    }
    let sides = [(0..n).map(|i| name(i, 0)).collect::<Vec<_>>(), (0..n).map(|j| name(n, j)).collect()];
    let back = [(0..n).map(|i| name(n - i, n)).collect::<Vec<_>>(), (0..n).map(|j| name(0, n - j)).collect()];
    sides.into_iter().chain(back).flatten().collect()
}

/// Adds the cells between closed rows of points, from the inside to the outside.
fn push_rows(mesh: &mut Mesh, rows: &[Vec<usize>]) {
    for pair in rows.windows(2) {
        let count = pair[0].len();
        for k in 0..count {
            let next = (k + 1) % count;
            mesh.push_cell([pair[0][k], pair[1][k], pair[1][next], pair[0][next]]);
        }
    }
}

/// Makes the mesh over a circle with a hole: rows of cells that are about square.
fn ring(outer: &Circle<'_>, hole: &Circle<'_>, sizing: &Sizing) -> Option<Mesh> {
    let width = outer.radius - hole.radius;
    if distance(outer.centre, hole.centre) > 1e-5 * outer.radius || outer.sides.len() != hole.sides.len() {
        return None;
    }
    let per_side = outer.edges_per_side(sizing).max(hole.edges_per_side(sizing));
    let nodes = outer.nodes(per_side);
    let inner = hole.nodes(per_side);
    let count = nodes.len();
    // The hole runs clockwise: its nodes in the other direction, from that nearest to the first.
    let shift = (0..count).min_by(|&a, &b| {
        let far = |k: usize| {
            let way = between(outer.centre, inner[k].at);
            angle(between(outer.centre, nodes[0].at), way).abs()
        };
        far(a).total_cmp(&far(b))
    })?;
    let opposite = |k: usize| (shift + count - k) % count;
    let ways = [between(outer.centre, nodes[0].at), between(outer.centre, inner[shift].at)];
    if angle(ways[0], ways[1]).abs() > 1e-3 {
        return None;
    }
    let fits = |layer: f64| if 4.0 * layer <= width { layer } else { 0.0 };
    let [begin, end] = [fits(hole.layer(sizing)), fits(outer.layer(sizing))];
    let [low, high] = [hole.radius + begin, outer.radius - end];
    let even = (high / low).ln() * count as f64 / std::f64::consts::TAU;
    // The outermost row is the widest one: not wider than the size.
    let fine = (high / low).ln() / -(1.0 - (sizing.size_m / high).min(0.9)).ln();
    let steps = even.max(fine).round().max(1.0) as usize;
    let mut radii = vec![hole.radius];
    radii.extend((usize::from(begin == 0.0)..=steps).map(|k| low * (high / low).powf(k as f64 / steps as f64)));
    if end > 0.0 {
        radii.push(outer.radius);
    }
    let mut mesh = Mesh { points: Vec::new(), triangles: Vec::new(), edges: Vec::new() };
    let last = radii.len() - 1;
    for (row, radius) in radii.iter().enumerate() {
        let share = (radius - hole.radius) / width;
        let point = |k: usize| match row {
            0 => inner[opposite(k)].at,
            row if row == last => nodes[k].at,
            _ => mix(inner[opposite(k)].at, nodes[k].at, share),
        };
        mesh.points.extend((0..count).map(point));
    }
    let rows: Vec<Vec<usize>> = (0..=last).map(|row| (row * count..(row + 1) * count).collect()).collect();
    push_rows(&mut mesh, &rows);
    outer.push_edges(&mut mesh, &nodes, &rows[last]);
    let names: Vec<usize> = (0..count).map(|k| opposite(k) % count).collect();
    hole.push_edges(&mut mesh, &inner, &names);
    Some(mesh)
}
