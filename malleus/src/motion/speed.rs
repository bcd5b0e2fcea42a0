//! Limit of the speed, anywhere on the path.

use super::path::{Knot, Piece};

/// Highest speed of a motion in metres per second.
pub const MOST_SPEED_M_PER_S: f64 = 10.0;

/// Ratio to the limit that a speed may reach.
///
/// Cubic pieces stand for the arcs of a circle. If it is drawn at the limit, the pieces are up to
/// 0.002 % faster between lines of the file. An engine allows 0.005 %.
const MARGIN: f64 = 1.0 + 4e-5;

/// Number of times that a piece is halved in search of a speed above the limit. The bound that is
/// left is then above the piece's speeds by less than 4^-20 of their spread.
const HALVINGS: u32 = 20;
/// Number of equal parts of a piece at whose ends the highest speed is looked for.
const PARTS: u32 = 64;

/// Time in seconds and speed at which a piece is fastest, if it is above the limit anywhere.
pub(super) fn too_fast(from: &Knot, to: &Knot) -> Option<(f64, f64)> {
    let controls = Piece::between(from, to).velocity_controls(from, to);
    let first = first_above(controls, 0.0, 1.0, HALVINGS)?;
    let speed = |u: f64| {
        let [a, b, c] = controls;
        let at = |axis: usize| (1.0 - u) * ((1.0 - u) * a[axis] + 2.0 * u * b[axis]) + u * u * c[axis];
        at(0).hypot(at(1))
    };
    let places = (0..=PARTS).map(|part| f64::from(part) / f64::from(PARTS)).chain([first]);
    let fastest = places.max_by(|a, b| speed(*a).total_cmp(&speed(*b)))?;
    Some((from.time_s + fastest * (to.time_s - from.time_s), speed(fastest)))
}

/// First place in a piece, from u = `begin` to `end`, with a speed above the limit.
///
/// The velocity is a parabola, which stays within the triangle of its control points. A triangle
/// that reaches beyond the limit is halved (de Casteljau).
fn first_above(controls: [[f64; 2]; 3], begin: f64, end: f64, halvings: u32) -> Option<f64> {
    let [a, b, c] = controls;
    // Written so that a speed that is not a number is above the limit.
    let is_within = |velocity: [f64; 2]| velocity[0].hypot(velocity[1]) <= MOST_SPEED_M_PER_S * MARGIN;
    if !is_within(a) {
        return Some(begin);
    }
    if is_within(b) && is_within(c) {
        return None;
    }
    if halvings == 0 {
        return (!is_within(c)).then_some(end);
    }
    let mean = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|axis| 0.5 * (a[axis] + b[axis]));
    let (left, right) = (mean(a, b), mean(b, c));
    let (middle, half) = (mean(left, right), 0.5 * (begin + end));
    first_above([a, left, middle], begin, half, halvings - 1)
        .or_else(|| first_above([middle, right, c], half, end, halvings - 1))
}
