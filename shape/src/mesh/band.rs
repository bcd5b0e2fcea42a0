//! Band of thin elements along sides: which pieces of the sides it fits, and its triangles.

use super::boundary::{Chord, angle, unit};
use crate::outline::Point;
use crate::outline::side::{between, cross, distance, mix};
use crate::outline::touch::meeting;

/// Largest turn of a corner that a band goes round, radians.
const CORNER: f64 = 140.0 / 180.0 * std::f64::consts::PI;

/// Layers that the body's local width must be able to hold.
const WIDTHS: f64 = 4.0;

/// Places at which the band's inner edge passes a node.
#[derive(Clone, Copy)]
enum Inner {
    /// In a node of the ring: the band tapers or ends there.
    Node(usize),
    /// Beside the node.
    Beside(Point),
}

/// Ring of the inner polygon: its points, and the chord that each of its edges belongs to.
pub(super) struct InnerRing {
    /// Points by name.
    pub(super) polygon: Vec<usize>,
    /// Chord of each edge.
    pub(super) chords: Vec<usize>,
}

/// Band along the rings: the pieces that have one.
pub(super) struct Band<'a> {
    rings: &'a [Vec<Chord>],
    flags: Vec<Vec<bool>>,
    layer: f64,
}

impl<'a> Band<'a> {
    /// Plans a band that is `layer` wide wherever it fits; none if no width is given.
    pub(super) fn plan(rings: &'a [Vec<Chord>], layer: Option<f64>) -> Band<'a> {
        let none = || rings.iter().map(|ring| vec![false; ring.len()]).collect();
        let mut band = Band { rings, flags: none(), layer: layer.unwrap_or(0.0) };
        let Some(layer) = layer else { return band };
        for (r, ring) in rings.iter().enumerate() {
            for (k, chord) in ring.iter().enumerate() {
                band.flags[r][k] = chord.layered && band.width(r, k) >= WIDTHS * layer;
            }
        }
        let pieces: usize = rings.iter().map(Vec::len).sum();
        for _ in 0..=pieces {
            if !band.drop_folded() && !band.drop_crossing() {
                return band;
            }
        }
        band.flags = none();
        band
    }

    /// Tells whether a piece has a band.
    pub(super) fn has(&self, ring: usize, chord: usize) -> bool {
        self.flags[ring][chord]
    }

    /// Lists the band's inner rings; puts the points that they need behind those that stand.
    pub(super) fn inner_rings(&self, points: &mut Vec<Point>, names: &[Vec<usize>]) -> Vec<InnerRing> {
        let mut rings = Vec::with_capacity(self.rings.len());
        for (r, ring) in self.rings.iter().enumerate() {
            let mut inner = InnerRing { polygon: Vec::new(), chords: Vec::new() };
            for k in (0..ring.len()).filter(|k| !self.is_cut(r, *k)) {
                inner.chords.push(k);
                inner.polygon.push(match self.inner(r, k) {
                    Inner::Node(node) => names[r][node],
                    Inner::Beside(point) => {
                        points.push(point);
                        points.len() - 1
                    }
                });
            }
            rings.push(inner);
        }
        rings
    }

    fn node(&self, r: usize, k: usize) -> Point {
        self.rings[r][k % self.rings[r].len()].from
    }

    fn next(&self, r: usize, k: usize) -> usize {
        (k + 1) % self.rings[r].len()
    }

    fn previous(&self, r: usize, k: usize) -> usize {
        (k + self.rings[r].len() - 1) % self.rings[r].len()
    }

    /// Tells whether a piece is the end of a neighbour's band.
    fn is_cut(&self, r: usize, k: usize) -> bool {
        let chord = &self.rings[r][k];
        let near = if chord.span[0] == 0.0 { self.previous(r, k) } else { self.next(r, k) };
        chord.slide && self.flags[r][near]
    }

    /// Tells where the band's inner edge passes a node.
    fn inner(&self, r: usize, k: usize) -> Inner {
        let before = self.previous(r, k);
        let [coming, going] = [self.flags[r][before], self.flags[r][k]];
        if coming && going {
            let a = between(self.node(r, before), self.node(r, k));
            let b = between(self.node(r, k), self.node(r, k + 1));
            let turn = angle(a, b);
            if turn.abs() > CORNER {
                return Inner::Node(k);
            }
            let (a, b) = (unit(a), unit(b));
            let way = unit([-a[1] - b[1], a[0] + b[0]]);
            let far = self.layer / (0.5 * turn).cos();
            let at = self.node(r, k);
            return Inner::Beside([at[0] + far * way[0], at[1] + far * way[1]]);
        }
        if coming && self.is_cut(r, k) {
            return Inner::Node(self.next(r, k));
        }
        Inner::Node(if going && self.is_cut(r, before) { before } else { k })
    }

    fn inner_point(&self, r: usize, k: usize) -> Point {
        match self.inner(r, k) {
            Inner::Node(node) => self.node(r, node),
            Inner::Beside(point) => point,
        }
    }

    /// Gives the body's width across a piece, metres.
    fn width(&self, r: usize, k: usize) -> f64 {
        let ends = [self.node(r, k), self.node(r, k + 1)];
        let way = unit(between(ends[0], ends[1]));
        let (from, inward) = (mix(ends[0], ends[1], 0.5), [-way[1], way[0]]);
        let mut width = f64::INFINITY;
        for (other, ring) in self.rings.iter().enumerate() {
            for at in 0..ring.len() {
                let (a, b) = (between(from, self.node(other, at)), between(from, self.node(other, at + 1)));
                let (left, right) = (cross(inward, a), cross(inward, b));
                if (other, at) != (r, k) && left * right <= 0.0 && left != right {
                    let hit = mix(a, b, left / (left - right));
                    let far = hit[0] * inward[0] + hit[1] * inward[1];
                    width = if far > 0.0 { width.min(far) } else { width };
                }
            }
        }
        width
    }

    /// Drops the pieces whose element would fold; tells whether there were any.
    fn drop_folded(&mut self) -> bool {
        let mut folded = Vec::new();
        for (r, ring) in self.rings.iter().enumerate() {
            for k in (0..ring.len()).filter(|k| self.flags[r][*k]) {
                let next = self.next(r, k);
                let tapers = |node: usize| matches!(self.inner(r, node), Inner::Node(at) if at == node);
                let (a, b) = (self.node(r, k), self.node(r, next));
                let (c, d) = (self.inner_point(r, next), self.inner_point(r, k));
                let way = between(a, b);
                let least = 1e-3 * self.layer * distance(a, b);
                let along = way[0] * (c[0] - d[0]) + way[1] * (c[1] - d[1]);
                let first = tapers(next) || cross(way, between(a, c)) > least;
                let second = tapers(k) || cross(way, between(a, d)) > least;
                let middle = tapers(k) || tapers(next) || cross(between(a, c), between(a, d)) > 0.0;
                let both = tapers(k) && tapers(next);
                if both || !first || !second || !middle || along <= 0.0 {
                    folded.push((r, k));
                }
            }
        }
        folded.iter().for_each(|&(r, k)| self.flags[r][k] = false);
        !folded.is_empty()
    }

    /// Drops the pieces whose inner edge crosses another edge; tells whether there were any.
    fn drop_crossing(&mut self) -> bool {
        let mut edges = Vec::new();
        for (r, ring) in self.rings.iter().enumerate() {
            let begin = edges.len();
            let kept: Vec<usize> = (0..ring.len()).filter(|k| !self.is_cut(r, *k)).collect();
            for (place, &k) in kept.iter().enumerate() {
                let ends = [self.inner_point(r, k), self.inner_point(r, kept[(place + 1) % kept.len()])];
                let neighbours = [begin + (place + 1) % kept.len(), begin + (place + kept.len() - 1) % kept.len()];
                edges.push((r, k, ends, neighbours));
            }
        }
        let mut crossing = Vec::new();
        for (first, &(r, k, ends, neighbours)) in edges.iter().enumerate() {
            for (second, &(other, at, far, _)) in edges.iter().enumerate().skip(first + 1) {
                let banded = self.flags[r][k] || self.flags[other][at];
                if !banded || neighbours.contains(&second) || apart(ends, far) {
                    continue;
                }
                if meeting(ends, far, 1e-3 * self.layer).is_some() {
                    crossing.extend([(r, k), (other, at)]);
                }
            }
        }
        crossing.iter().for_each(|&(r, k)| self.flags[r][k] = false);
        !crossing.is_empty()
    }
}

/// Tells whether the upright rectangles around two edges lie apart.
pub(super) fn apart(a: [Point; 2], b: [Point; 2]) -> bool {
    (0..2).any(|axis| {
        let (low, high) = (a[0][axis].min(a[1][axis]), a[0][axis].max(a[1][axis]));
        b[0][axis].max(b[1][axis]) < low || b[0][axis].min(b[1][axis]) > high
    })
}

/// Makes the triangles between a piece from `a` to `b` and the band's inner edge beside it, whose
/// points are given from that beside `a` to that beside `b`.
pub(super) fn strip(a: usize, b: usize, inner: &[usize], triangles: &mut Vec<[usize; 3]>) {
    let last = inner.len() - 1;
    let middle = if inner[0] == a {
        1
    } else if inner[last] == b {
        last - 1
    } else {
        inner.len() / 2
    };
    for k in 0..last {
        let corner = if k < middle { a } else { b };
        if k == middle {
            triangles.push([a, b, inner[middle]]);
        }
        if corner != inner[k] && corner != inner[k + 1] {
            triangles.push([corner, inner[k + 1], inner[k]]);
        }
    }
    if middle == last {
        triangles.push([a, b, inner[middle]]);
    }
}
