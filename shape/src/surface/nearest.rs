//! Nearest point of a surface.

use super::{Point, Surface, cross, dot, minus, unit};

/// Point of a surface next to another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Place on the surface, metres.
    pub at_m: Point,
    /// Unit normal there, out of the body.
    pub normal: Point,
    /// Distance, metres.
    pub distance_m: f64,
}

impl Surface {
    /// Finds the point of the surface that is nearest to a point, metres.
    pub fn nearest(&self, point: Point) -> Option<Foot> {
        let foot = |corners: [Point; 3]| {
            let at_m = nearest_of(corners, point);
            let far = minus(point, at_m);
            let [a, b, c] = corners;
            Foot { at_m, normal: unit(cross(minus(b, a), minus(c, a))), distance_m: dot(far, far).sqrt() }
        };
        self.corners().map(foot).min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
    }

    /// Finds where a ray from a point last leaves the body; the direction is a unit vector.
    pub fn last_exit(&self, from: Point, direction: Point) -> Option<Foot> {
        let exit = |corners: [Point; 3]| {
            let [a, b, c] = corners;
            let [ab, ac] = [minus(b, a), minus(c, a)];
            let plane = cross(ab, ac);
            let steepness = dot(plane, direction);
            if steepness <= 0.0 {
                return None;
            }
            let distance_m = dot(plane, minus(a, from)) / steepness;
            let at_m = [0, 1, 2].map(|axis| from[axis] + distance_m * direction[axis]);
            let inside = minus(nearest_of(corners, at_m), at_m);
            let is_hit = dot(inside, inside) <= 1e-18 * dot(plane, plane).sqrt();
            is_hit.then_some(Foot { at_m, normal: unit(plane), distance_m })
        };
        self.corners().filter_map(exit).max_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
    }
}

/// Nearest point of a triangle.
fn nearest_of([a, b, c]: [Point; 3], point: Point) -> Point {
    let [ab, ac, ap] = [minus(b, a), minus(c, a), minus(point, a)];
    let normal = cross(ab, ac);
    let square = dot(normal, normal);
    if square > 0.0 {
        // Barycentric coordinates of the foot in the plane.
        let second = dot(cross(ap, ac), normal) / square;
        let third = dot(cross(ab, ap), normal) / square;
        if second >= 0.0 && third >= 0.0 && second + third <= 1.0 {
            return [0, 1, 2].map(|axis| a[axis] + second * ab[axis] + third * ac[axis]);
        }
    }
    let along = |from: Point, to: Point| {
        let way = minus(to, from);
        let share = (dot(minus(point, from), way) / dot(way, way).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        [0, 1, 2].map(|axis| from[axis] + share * way[axis])
    };
    let far = |at: &Point| dot(minus(point, *at), minus(point, *at));
    let edges = [along(a, b), along(b, c), along(c, a)];
    edges.into_iter().min_by(|one, other| far(one).total_cmp(&far(other))).unwrap_or(a)
}
