//! Rings of triangles around a centre, which a turn by one part of [`TURNS`] maps onto themselves.

use std::f64::consts::TAU;

use super::Mesh;
use crate::outline::Point;

/// Number of equal parts of each ring. Two modes with m waves round the axis have one frequency on
/// such a mesh, unless 2 m is a multiple of this number.
pub(super) const TURNS: usize = 24;

/// Distance of neighbours on a ring, as a share of the longest edge; with `ROW` the diagonals
/// between two rings stay below that edge wherever their points lie.
const STEP: f64 = 0.75;

/// Distance of two rings, as a share of the longest edge.
const ROW: f64 = 0.64;

/// Distance of a circle, whose own edges may be the longest ones, from the ring beside it, as a
/// share of the longest edge.
const RIM_ROW: f64 = 0.48;

/// Growth of the distance of neighbours on a ring with the ring's distance from the inner circle:
/// around a small hole each row of triangles is about 1.4 times as wide as the one before.
const GROWTH: f64 = 0.5;

/// Number of samples along the radius.
const SAMPLES: usize = 2048;

/// Ring of points, a multiple of [`TURNS`], evenly around the centre and counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    /// Name of the first point.
    pub(super) first: usize,
    /// Number of points.
    pub(super) count: usize,
    /// Angle of the first point, in steps from one point to the next.
    pub(super) begin: f64,
}

/// Space between two circles of one centre, or within one circle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Centre.
    pub(super) centre: Point,
    /// Angle from which rings count theirs, radians.
    pub(super) angle: f64,
    /// Radii of the inner circle, 0 for none, and of the outer one, metres.
    pub(super) radii: [f64; 2],
    /// Distance of neighbours on the inner circle, metres; `None` without one.
    pub(super) inner_step: Option<f64>,
    /// Longest edge, metres.
    pub(super) size_m: f64,
}

impl Span {
    /// Gives the distance that neighbours on a ring may have.
    fn step(&self, radius: f64) -> f64 {
        let [low, _] = self.radii;
        let most = STEP * self.size_m;
        self.inner_step.map_or(most, |step| most.min(step + GROWTH * (radius - low)))
    }

    /// Gives the number of points of a ring.
    fn count(&self, radius: f64) -> usize {
        let parts = TAU * radius / (TURNS as f64 * self.step(radius));
        TURNS * (parts - 1e-9).ceil().max(1.0) as usize
    }

    /// Gives the distance of two rings near a radius.
    fn row(&self, radius: f64) -> f64 {
        let [low, high] = self.radii;
        let is_rim = |end: f64| end > 0.0 && (radius - end).abs() < RIM_ROW * self.size_m;
        let most = if is_rim(low) || is_rim(high) { RIM_ROW } else { ROW } * self.size_m;
        most.min(self.step(radius))
    }

    /// Gives the radii of the rings between the circles, from the outermost to the innermost.
    fn rings(&self) -> Vec<f64> {
        let [low, high] = self.radii;
        let radius = |sample: usize| high - (high - low) * ((sample as f64 + 0.5) / SAMPLES as f64);
        let part = |sample: usize| (high - low) / SAMPLES as f64 / self.row(radius(sample));
        let all: f64 = (0..SAMPLES).map(part).sum();
        let rows = (all - 1e-9).ceil().max(1.0);
        let (mut sum, mut radii) = (0.0, Vec::new());
        for sample in 0..SAMPLES {
            sum += part(sample);
            if sum * rows > all * (radii.len() + 1) as f64 && radii.len() + 1 < rows as usize {
                radii.push(radius(sample));
            }
        }
        radii
    }

    /// Fills the space between the outer circle's ring and the inner one's, or the centre.
    pub(super) fn fill(&self, mesh: &mut Mesh, outer: Ring, inner: Option<Ring>) {
        let mut last = outer;
        for (number, radius) in self.rings().into_iter().enumerate() {
            let count = self.count(radius);
            // Rings that turn by half a step have triangles of nearly equal sides between them.
            let begin = if number % 2 == 0 { 0.5 } else { 0.0 };
            let ring = Ring { first: mesh.points.len(), count, begin };
            mesh.points.extend((0..count).map(|k| {
                let turn = self.angle + TAU * (k as f64 + begin) / count as f64;
                [self.centre[0] + radius * turn.cos(), self.centre[1] + radius * turn.sin()]
            }));
            mesh.join(last, ring);
            last = ring;
        }
        if let Some(inner) = inner {
            mesh.join(last, inner);
            return;
        }
        let centre = mesh.points.len();
        mesh.points.push(self.centre);
        let name = |k: usize| last.first + k % last.count;
        mesh.triangles.extend((0..last.count).map(|k| [name(k), name(k + 1), centre]));
    }
}

impl Mesh {
    /// Adds the triangles between two rings, alike in each part.
    pub(super) fn join(&mut self, outer: Ring, inner: Ring) {
        let name = |ring: Ring, k: usize| ring.first + k % ring.count;
        let angle = |ring: Ring, k: usize| (k as f64 + ring.begin) / ring.count as f64;
        let far = |k: usize| (angle(inner, k) - angle(outer, 0)).abs();
        let nearest = (0..2).min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(0);
        for part in 0..TURNS {
            let begin = [part * outer.count / TURNS, part * inner.count / TURNS + nearest];
            let end = [begin[0] + outer.count / TURNS, begin[1] + inner.count / TURNS];
            let [mut k, mut i] = begin;
            while k < end[0] || i < end[1] {
                // The shorter diagonal: from the next point of one ring to this one of the other.
                let outwards = (angle(outer, k + 1) - angle(inner, i)).abs();
                let inwards = (angle(inner, i + 1) - angle(outer, k)).abs();
                if i == end[1] || (k < end[0] && outwards <= inwards + 1e-9) {
                    self.triangles.push([name(outer, k), name(outer, k + 1), name(inner, i)]);
                    k += 1;
                } else {
                    self.triangles.push([name(outer, k), name(inner, i + 1), name(inner, i)]);
                    i += 1;
                }
            }
        }
    }
}
