//! Side of an outline with both its ends, and what can be asked about it.

use super::Point;

/// Depth to which a curve is halved in search of its crossings with a ray.
const DEPTH: usize = 48;

/// Side of an outline with both its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatSide {
    /// Ring of the outline.
    pub ring: usize,
    /// Begin, metres.
    pub from: Point,
    /// End, metres.
    pub to: Point,
    /// Control points of a cubic Bézier curve; `None` for a straight side.
    pub curve: Option<[Point; 2]>,
}

/// Gives the point at a share of the way between two points.
pub(crate) fn mix(a: Point, b: Point, share: f64) -> Point {
    [a[0] * (1.0 - share) + b[0] * share, a[1] * (1.0 - share) + b[1] * share]
}

/// Gives the cross product of two vectors.
pub(crate) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Gives the vector from one point to another.
pub(crate) fn between(a: Point, b: Point) -> Point {
    [b[0] - a[0], b[1] - a[1]]
}

/// Gives the distance of two points.
pub(crate) fn distance(a: Point, b: Point) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

impl FlatSide {
    /// Gives the four control points, those of a straight side on its thirds.
    pub fn controls(&self) -> [Point; 4] {
        let [a, b] = self.curve.unwrap_or([mix(self.from, self.to, 1.0 / 3.0), mix(self.from, self.to, 2.0 / 3.0)]);
        [self.from, a, b, self.to]
    }

    /// Gives the point at a parameter between 0 and 1, metres.
    pub fn point(&self, t: f64) -> Point {
        if t <= 0.0 {
            return self.from;
        }
        if t >= 1.0 {
            return self.to;
        }
        if self.curve.is_none() { mix(self.from, self.to, t) } else { self.split(t)[0].to }
    }

    /// Gives the derivative of the point by the parameter, metres.
    pub fn derivative(&self, t: f64) -> Point {
        if self.curve.is_none() {
            return between(self.from, self.to);
        }
        let [a, b, c, d] = self.controls();
        let (u, v, w) = (between(a, b), between(b, c), between(c, d));
        let (p, q, r) = (3.0 * (1.0 - t) * (1.0 - t), 6.0 * t * (1.0 - t), 3.0 * t * t);
        [p * u[0] + q * v[0] + r * w[0], p * u[1] + q * v[1] + r * w[1]]
    }

    /// Splits the side in two at a parameter between 0 and 1.
    pub fn split(&self, t: f64) -> [FlatSide; 2] {
        let Some([b, c]) = self.curve else {
            let middle = mix(self.from, self.to, t);
            return [FlatSide { to: middle, ..*self }, FlatSide { from: middle, ..*self }];
        };
        let (ab, bc, cd) = (mix(self.from, b, t), mix(b, c, t), mix(c, self.to, t));
        let (abc, bcd) = (mix(ab, bc, t), mix(bc, cd, t));
        let middle = mix(abc, bcd, t);
        [
            FlatSide { to: middle, curve: Some([ab, abc]), ..*self },
            FlatSide { from: middle, curve: Some([bcd, cd]), ..*self },
        ]
    }

    /// Gives the part of the side between two parameters.
    pub fn part(&self, begin: f64, end: f64) -> FlatSide {
        let head = if end < 1.0 { self.split(end)[0] } else { *self };
        if begin > 0.0 { head.split(begin / end.min(1.0))[1] } else { head }
    }

    /// Gives the signed area between the side and the lines from its ends to an origin, square
    /// metres.
    pub(crate) fn swept_area(&self, origin: Point) -> f64 {
        let [a, b, c, d] = self.controls().map(|p| between(origin, p));
        if self.curve.is_none() {
            return 0.5 * cross(a, d);
        }
        let outer = 6.0 * cross(a, b) + 3.0 * cross(a, c) + cross(a, d);
        (outer + 3.0 * cross(b, c) + 3.0 * cross(b, d) + 6.0 * cross(c, d)) / 20.0
    }

    /// Lists the ends and the points at which a coordinate is largest or smallest.
    pub(super) fn extremes(&self) -> Vec<Point> {
        let mut points = vec![self.from, self.to];
        if self.curve.is_some() {
            let [a, b, c, d] = self.controls();
            for axis in 0..2 {
                let (u, v, w) = (b[axis] - a[axis], c[axis] - b[axis], d[axis] - c[axis]);
                let (square, linear) = (u - 2.0 * v + w, 2.0 * (v - u));
                let root = (linear * linear - 4.0 * square * u).max(0.0).sqrt();
                // Both roots in the form that stays exact if the square term vanishes.
                let sum = -0.5 * (linear + root.copysign(linear));
                let parameters = [sum / square, u / sum];
                points.extend(parameters.iter().filter(|t| (0.0..1.0).contains(*t)).map(|t| self.point(*t)));
            }
        }
        points
    }

    /// Counts the crossings with the ray from a point to the right; only whether the count is odd
    /// is exact.
    pub(super) fn crossings(&self, point: Point) -> usize {
        crossings(self, point, DEPTH)
    }
}

/// Counts a side's crossings with the ray from a point to the right, by halves.
fn crossings(side: &FlatSide, point: Point, depth: usize) -> usize {
    let controls = side.controls();
    let above = controls.map(|c| c[1] > point[1]);
    if above == [true; 4] || above == [false; 4] || controls.iter().all(|c| c[0] <= point[0]) {
        return 0;
    }
    let crosses = above[0] != above[3];
    if side.curve.is_none() {
        let along = (point[1] - side.from[1]) / (side.to[1] - side.from[1]);
        return usize::from(crosses && side.from[0] + along * (side.to[0] - side.from[0]) > point[0]);
    }
    if depth == 0 || controls.iter().all(|c| c[0] > point[0]) {
        return usize::from(crosses);
    }
    side.split(0.5).iter().map(|half| crossings(half, point, depth - 1)).sum()
}
