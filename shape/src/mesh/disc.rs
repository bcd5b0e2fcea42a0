//! Mesh over a circle, with or without a concentric hole, that parts of a turn map onto itself.

use std::f64::consts::TAU;

use super::boundary::{angle, curve_parameters};
use super::free::misfits;
use super::polar::{Ring, Span, TURNS};
use super::{BoundaryEdge, Mesh, Sizing};
use crate::outline::side::{between, distance, mix};
use crate::outline::{FlatSide, Outline, Point};

/// Share of the radius by which points may be off the circle.
const ROUND: f64 = 2e-3;

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
        let arc = TAU / count as f64;
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

    /// Gives the edges per side that size and turn need, for a multiple of [`TURNS`] around.
    fn edges_per_side(&self, sizing: &Sizing) -> usize {
        let layer = sizing.layer_m.filter(|_| self.layered);
        let edges = |side: &FlatSide| curve_parameters(side, sizing.size_m, layer, None).len() - 1;
        let least = self.sides.iter().map(edges).max().unwrap_or(1);
        (least..).find(|each| (each * self.sides.len()).is_multiple_of(TURNS)).unwrap_or(least)
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

/// Makes the mesh over a disc: rings of triangles around its centre.
fn disc(outer: &Circle<'_>, sizing: &Sizing) -> Option<Mesh> {
    let layer = Some(outer.layer(sizing)).filter(|layer| 4.0 * layer <= 2.0 * outer.radius).unwrap_or(0.0);
    let nodes = outer.nodes(outer.edges_per_side(sizing));
    let mut mesh = Mesh { points: Vec::new(), triangles: Vec::new(), edges: Vec::new() };
    let rim = mesh.push_ring(nodes.iter().map(|node| node.at), 0.0);
    let inside = mesh.push_layer(rim, outer.centre, layer / outer.radius);
    let span = Span {
        centre: outer.centre,
        angle: direction(between(outer.centre, nodes[0].at)),
        radii: [0.0, outer.radius - layer],
        inner_step: None,
        size_m: longest(sizing, outer.radius, nodes.len()),
    };
    span.fill(&mut mesh, inside, None);
    outer.push_edges(&mut mesh, &nodes, &(0..nodes.len()).collect::<Vec<usize>>());
    Some(mesh)
}

/// Makes the mesh over a circle with a hole: rings of triangles, smaller ones near a small hole.
fn ring(outer: &Circle<'_>, hole: &Circle<'_>, sizing: &Sizing) -> Option<Mesh> {
    let width = outer.radius - hole.radius;
    if distance(outer.centre, hole.centre) > 1e-5 * outer.radius {
        return None;
    }
    let nodes = outer.nodes(outer.edges_per_side(sizing));
    let inner = hole.nodes(hole.edges_per_side(sizing));
    let way = between(outer.centre, nodes[0].at);
    // The hole runs clockwise: its nodes in the other direction, from that nearest to the first.
    let turn = |k: usize| angle(way, between(outer.centre, inner[k].at));
    let shift = (0..inner.len()).min_by(|&a, &b| turn(a).abs().total_cmp(&turn(b).abs()))?;
    let names: Vec<usize> = (0..inner.len()).map(|k| (shift + inner.len() - k) % inner.len()).collect();
    let fits = |layer: f64| if 4.0 * layer <= width { layer } else { 0.0 };
    let [begin, end] = [fits(hole.layer(sizing)), fits(outer.layer(sizing))];
    let mut mesh = Mesh { points: Vec::new(), triangles: Vec::new(), edges: Vec::new() };
    let rim = mesh.push_ring(nodes.iter().map(|node| node.at), 0.0);
    let low = mesh.push_ring(names.iter().map(|k| inner[*k].at), turn(shift) * inner.len() as f64 / TAU);
    let outside = mesh.push_layer(rim, outer.centre, end / outer.radius);
    let inside = mesh.push_layer(low, outer.centre, -begin / hole.radius);
    let span = Span {
        centre: outer.centre,
        angle: direction(way),
        radii: [hole.radius + begin, outer.radius - end],
        inner_step: Some(TAU * hole.radius / inner.len() as f64),
        size_m: longest(sizing, outer.radius, nodes.len()),
    };
    span.fill(&mut mesh, outside, Some(inside));
    outer.push_edges(&mut mesh, &nodes, &(0..nodes.len()).collect::<Vec<usize>>());
    let names: Vec<usize> = names.iter().map(|k| low.first + k).collect();
    hole.push_edges(&mut mesh, &inner, &names);
    Some(mesh)
}

/// Gives the angle of a vector, radians.
fn direction(way: Point) -> f64 {
    way[1].atan2(way[0])
}

/// Gives the longest edge inside a circle: at most twice as long as those on it.
fn longest(sizing: &Sizing, radius: f64, count: usize) -> f64 {
    sizing.size_m.min(2.0 * TAU * radius / count as f64)
}

impl Mesh {
    /// Adds the points of a ring.
    fn push_ring(&mut self, points: impl Iterator<Item = Point>, begin: f64) -> Ring {
        let first = self.points.len();
        self.points.extend(points);
        Ring { first, count: self.points.len() - first, begin }
    }

    /// Adds a layer beside a circle, inwards by a share of its radius or, if that is below zero,
    /// outwards; gives the ring on its other side, the circle itself without a layer.
    fn push_layer(&mut self, circle: Ring, centre: Point, share: f64) -> Ring {
        if share == 0.0 {
            return circle;
        }
        let points = self.points[circle.first..circle.first + circle.count].to_vec();
        let ring = self.push_ring(points.into_iter().map(|point| mix(point, centre, share)), circle.begin);
        if share > 0.0 {
            self.join(circle, ring)
        } else {
            self.join(ring, circle)
        }
        ring
    }
}
