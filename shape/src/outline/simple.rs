//! Polygons of few corners near rings of many points.

use super::Point;
use super::side::{between, cross, distance};

/// Distance of points from a corner within which they do not tell how a side runs: the corners of
/// a traced border are cut.
const CUT: f64 = 1.5;
/// Maximum distance of a corner, where two fitted sides cross, from the ring.
const FARTHEST: f64 = 1.3;
/// Number of points before and after a break among which that nearest to the corner is sought.
const NEAR: usize = 8;

/// Replaces a ring of points by a polygon with few corners: the breaks of Douglas and Peucker, then
/// the line of least squares through the points of each side. Corners lie where these lines cross,
/// also where a short side cuts off a corner. Points are at most a little more than the tolerance
/// away from the polygon.
pub(super) fn simplified(ring: &[Point], tolerance: f64) -> Vec<Point> {
    let mut breaks = breaks(ring, tolerance);
    if breaks.len() < 3 {
        return ring.to_vec();
    }
    drop_needless(ring, &mut breaks, tolerance);
    let count = breaks.len();
    let lines: Vec<Option<Line>> = (0..count).map(|k| side(ring, breaks[k], breaks[(k + 1) % count])).collect();
    let begin = |k: usize| ring[breaks[k % count]];
    let near = |k: usize, crossing: &Point| {
        let first = breaks[k % count] + ring.len() - NEAR.min(ring.len());
        let mut points = (first..=first + 2 * NEAR).map(|index| ring[index % ring.len()]);
        points.any(|point| distance(point, *crossing) < FARTHEST)
    };
    let crossing = |before: usize, after: usize| {
        lines[before % count].zip(lines[after % count]).and_then(|(before, after)| meet(before, after))
    };
    // Corner at which the sides before and after a short one cross.
    let cut = |k: usize| {
        let is_short = count > 3 && lines[k % count].is_none();
        let crossing = if is_short { crossing(k + count - 1, k + 1) } else { None };
        crossing.filter(|at| near(k, at) && near(k + 1, at))
    };
    let mut corners = Vec::with_capacity(count);
    for k in 0..count {
        if let Some(corner) = cut(k) {
            corners.push(corner);
        } else if cut(k + count - 1).is_none() {
            corners.push(crossing(k + count - 1, k).filter(|at| near(k, at)).unwrap_or(begin(k)));
        }
    }
    corners
}

/// Drops the breaks without which all points stay near the polygon.
fn drop_needless(ring: &[Point], breaks: &mut Vec<usize>, tolerance: f64) {
    let count = ring.len();
    let mut k = 0;
    while k < breaks.len() && breaks.len() > 3 {
        let [from, to] = [(k + breaks.len() - 1) % breaks.len(), (k + 1) % breaks.len()].map(|k| breaks[k]);
        let to = if to > from { to } else { to + count };
        let chord = [ring[from], ring[to % count]];
        if (from + 1..to).all(|index| away(ring[index % count], chord) <= tolerance) {
            breaks.remove(k);
        } else {
            k += 1;
        }
    }
}

/// Line through a point, along a unit vector.
type Line = [Point; 2];

/// Indices of the points at which a ring is broken, in order.
fn breaks(ring: &[Point], tolerance: f64) -> Vec<usize> {
    let count = ring.len();
    let farthest = |from: usize| {
        (0..count).max_by(|&a, &b| distance(ring[from], ring[a]).total_cmp(&distance(ring[from], ring[b]))).unwrap_or(0)
    };
    // The ends of the longest way across lie at corners, as a rule.
    let first = farthest(farthest(0));
    let second = farthest(first);
    let [low, high] = [first.min(second), first.max(second)];
    let mut kept = vec![low, high];
    let mut open = vec![[low, high], [high, low + count]];
    while let Some([from, to]) = open.pop() {
        let chord = [ring[from % count], ring[to % count]];
        let far = |index: usize| away(ring[index % count], chord);
        let Some(middle) = (from + 1..to).max_by(|&a, &b| far(a).total_cmp(&far(b))) else { continue };
        if far(middle) > tolerance {
            kept.push(middle % count);
            open.extend([[from, middle], [middle, to]]);
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// Distance of a point from a chord.
fn away(at: Point, [from, to]: [Point; 2]) -> f64 {
    let along = between(from, to);
    let square = along[0] * along[0] + along[1] * along[1];
    let to_point = between(from, at);
    let share = ((to_point[0] * along[0] + to_point[1] * along[1]) / square.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    distance(at, [from[0] + share * along[0], from[1] + share * along[1]])
}

/// Line of least squares through the points of a ring between two breaks; `None` if they are few.
fn side(ring: &[Point], from: usize, to: usize) -> Option<Line> {
    let count = ring.len();
    let to = if to > from { to } else { to + count };
    let ends = [ring[from], ring[to % count]];
    let is_clear = |at: &Point| ends.iter().all(|&end| distance(end, *at) > CUT);
    let points: Vec<Point> = (from..=to).map(|index| ring[index % count]).filter(is_clear).collect();
    if points.len() < 2 {
        return None;
    }
    let mean = [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64);
    let sum = |a: usize, b: usize| points.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b])).sum::<f64>();
    let angle = 0.5 * (2.0 * sum(0, 1)).atan2(sum(0, 0) - sum(1, 1));
    Some([mean, [angle.cos(), angle.sin()]])
}

/// Point at which two lines cross; `None` if they are nearly parallel.
fn meet([at, along]: Line, [other, other_along]: Line) -> Option<Point> {
    let sine = cross(along, other_along);
    let share = cross(between(at, other), other_along) / sine;
    (sine.abs() > 1e-3).then_some([at[0] + share * along[0], at[1] + share * along[1]])
}
