//! Circles in drawings: their cubics are 0.03 % off, and are replaced by shorter ones.

use super::{Point, Side};

/// Largest angle of a cubic that stands for a part of a circle: off by 1e-7 of the radius.
const MOST_RAD: f64 = std::f64::consts::PI / 8.0;
/// Differences from a circle, as a share of the radius, below which a cubic is a part of one.
const SAME: f64 = 2e-3;

/// Least radius of a circle whose cubics are replaced, as a share of the ring's extent: the corners
/// of a rounded rectangle stay.
const LARGE: f64 = 0.25;

/// Replaces the cubics of a ring that stand for parts of large circles by shorter ones.
pub(super) fn with_round_arcs(ring: &[Side]) -> Vec<Side> {
    let extent = |axis: usize| {
        let along = ring.iter().filter_map(|side| side.from.get(axis).copied());
        along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
    };
    let least = LARGE * extent(0).max(extent(1));
    let ends = ring.iter().cycle().skip(1);
    ring.iter().zip(ends).flat_map(|(side, next)| arcs(side, next.from, least).unwrap_or_else(|| vec![*side])).collect()
}

/// Short cubics in place of one that stands for a part of a circle; `None` if it stands for none.
fn arcs(side: &Side, to: Point, least_m: f64) -> Option<Vec<Side>> {
    let (from, [first, second]) = (side.from, side.curve?);
    let [begin, end] = [[first[0] - from[0], first[1] - from[1]], [to[0] - second[0], to[1] - second[1]]];
    let (cross, dot) = (begin[0] * end[1] - begin[1] * end[0], begin[0] * end[0] + begin[1] * end[1]);
    let angle = cross.atan2(dot);
    // The circle through both ends with the first tangent: its centre lies on the tangent's normal.
    let chord = [to[0] - from[0], to[1] - from[1]];
    let normal = [-begin[1], begin[0]];
    let along = 2.0 * (chord[0] * normal[0] + chord[1] * normal[1]);
    let share = (chord[0] * chord[0] + chord[1] * chord[1]) / along;
    let centre = [from[0] + share * normal[0], from[1] + share * normal[1]];
    let radius = (from[0] - centre[0]).hypot(from[1] - centre[1]);
    let arm = 4.0 / 3.0 * (angle.abs() / 4.0).tan() * radius;
    let is_arm = |way: [f64; 2]| (way[0].hypot(way[1]) - arm).abs() < SAME * radius;
    let radial = [to[0] - centre[0], to[1] - centre[1]];
    let leans = (radial[0] * end[0] + radial[1] * end[1]).abs() / radius;
    if !(radius.is_finite()
        && radius >= least_m
        && radius > 0.0
        && is_arm(begin)
        && is_arm(end)
        && leans < SAME * radius)
    {
        return None;
    }
    let count = (angle.abs() / MOST_RAD * (1.0 - 1e-6)).ceil().max(1.0);
    let (step, start) = (angle / count, (from[1] - centre[1]).atan2(from[0] - centre[0]));
    let arm = 4.0 / 3.0 * (step / 4.0).tan() * radius;
    let point = |number: f64| {
        let (sine, cosine) = (start + step * number).sin_cos();
        ([centre[0] + radius * cosine, centre[1] + radius * sine], [-sine * arm, cosine * arm])
    };
    let piece = |number: usize| {
        let number = number as f64;
        let ((a, leaves), (b, arrives)) = (point(number), point(number + 1.0));
        let a = if number == 0.0 { from } else { a };
        Side { from: a, curve: Some([[a[0] + leaves[0], a[1] + leaves[1]], [b[0] - arrives[0], b[1] - arrives[1]]]) }
    };
    Some((0..count as usize).map(piece).collect())
}
