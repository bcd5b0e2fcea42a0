//! Places where sides cross or touch: curves are halved until their chords tell.

use super::side::{between, cross, distance, mix};
use super::{FlatSide, Point};

/// Number of times that two pieces with a common end, or a piece that may meet itself, are halved.
const JOINED: usize = 8;
/// Number of times that other pieces are halved: chords of a piece halved so often are within
/// rounding of it.
const APART: usize = 24;
/// Distance that counts as a touch of pieces with a common end, as a share of their length: where
/// they leave it in one direction they are close to each other.
const CLOSE: f64 = 1e-8;

/// Gives a place where two pieces without a common end cross or touch.
pub(super) fn apart(a: &FlatSide, b: &FlatSide, tolerance: f64) -> Option<Point> {
    halved(a, b, tolerance, APART)
}

fn halved(a: &FlatSide, b: &FlatSide, tolerance: f64, depth: usize) -> Option<Point> {
    let [off_a, off_b] = [off_chord(a), off_chord(b)];
    let reach = off_a + off_b + tolerance;
    let chords = [[a.from, a.to], [b.from, b.to]];
    if is_beside(chords, reach) || (meeting(chords[0], chords[1], reach).is_none()) {
        return None;
    }
    if off_a + off_b <= 0.1 * tolerance || depth == 0 {
        return meeting(chords[0], chords[1], tolerance);
    }
    let (longer, other) = if off_a >= off_b { (a, b) } else { (b, a) };
    longer.split(0.5).iter().find_map(|half| halved(half, other, tolerance, depth - 1))
}

/// Gives a place where two pieces, of which the second begins at the end of the first, cross or
/// touch elsewhere.
pub(super) fn joined(a: &FlatSide, b: &FlatSide, tolerance: f64) -> Option<Point> {
    halved_at_end(a, b, tolerance, JOINED)
}

fn halved_at_end(a: &FlatSide, b: &FlatSide, tolerance: f64, depth: usize) -> Option<Point> {
    if depth == 0 {
        return None;
    }
    if a.curve.is_none() && b.curve.is_none() {
        let ends = [(a.from, [b.from, b.to]), (b.to, [a.from, a.to])];
        return ends.into_iter().find(|(point, ends)| gap(*point, *ends) <= tolerance).map(|(point, _)| point);
    }
    let ([a_far, a_near], [b_near, b_far]) = (a.split(0.5), b.split(0.5));
    let tolerance = tolerance.min(CLOSE * distance(a_near.from, a_near.to).min(distance(b_near.from, b_near.to)));
    [(&a_far, &b_near), (&a_far, &b_far), (&a_near, &b_far)]
        .into_iter()
        .find_map(|(a, b)| apart(a, b, tolerance))
        .or_else(|| halved_at_end(&a_near, &b_near, tolerance, depth - 1))
}

/// Gives a place where a piece crosses or touches itself.
pub(super) fn itself(piece: &FlatSide, tolerance: f64) -> Option<Point> {
    looped(piece, tolerance, JOINED)
}

fn looped(piece: &FlatSide, tolerance: f64, depth: usize) -> Option<Point> {
    let controls = piece.controls();
    let chord = between(piece.from, piece.to);
    let along = |pair: &[Point]| {
        let way = between(pair[0], pair[1]);
        way[0] * chord[0] + way[1] * chord[1]
    };
    // A curve that runs forwards all the way does not meet itself.
    if piece.curve.is_none() || depth == 0 || controls.windows(2).all(|pair| along(pair) >= 0.0) {
        return None;
    }
    let [first, second] = piece.split(0.5);
    looped(&first, tolerance, depth - 1)
        .or_else(|| looped(&second, tolerance, depth - 1))
        .or_else(|| joined(&first, &second, tolerance))
}

/// Gives a distance from the chord beyond which a piece does not go.
fn off_chord(piece: &FlatSide) -> f64 {
    let Some([first, second]) = piece.curve else { return 0.0 };
    let third = |share: f64| mix(piece.from, piece.to, share);
    0.75 * distance(first, third(1.0 / 3.0)).max(distance(second, third(2.0 / 3.0)))
}

/// Tells whether the upright rectangles around two chords lie further apart than a distance.
fn is_beside([a, b]: [[Point; 2]; 2], reach: f64) -> bool {
    (0..2).any(|axis| {
        let [a_low, a_high] = [a[0][axis].min(a[1][axis]), a[0][axis].max(a[1][axis])];
        let [b_low, b_high] = [b[0][axis].min(b[1][axis]), b[0][axis].max(b[1][axis])];
        b_low - a_high > reach || a_low - b_high > reach
    })
}

/// Gives the distance of a point from a straight line between two ends.
fn gap(point: Point, ends: [Point; 2]) -> f64 {
    let way = between(ends[0], ends[1]);
    let to = between(ends[0], point);
    let square = way[0] * way[0] + way[1] * way[1];
    let share = if square > 0.0 { ((to[0] * way[0] + to[1] * way[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    distance(point, mix(ends[0], ends[1], share))
}

/// Gives the point in which two straight lines cross or touch.
pub(crate) fn meeting([a, b]: [Point; 2], [c, d]: [Point; 2], tolerance: f64) -> Option<Point> {
    let touch = [(a, [c, d]), (b, [c, d]), (c, [a, b]), (d, [a, b])];
    if let Some((point, _)) = touch.into_iter().find(|(point, ends)| gap(*point, *ends) <= tolerance) {
        return Some(point);
    }
    let side = |p: Point, q: Point, r: Point| cross(between(p, q), between(p, r));
    let (from, to) = (side(c, d, a), side(c, d, b));
    let apart = from * to > 0.0 || side(a, b, c) * side(a, b, d) > 0.0;
    (!apart && from != to).then(|| mix(a, b, from / (from - to)))
}
