//! Points along the sides of an outline.

use super::Sizing;
use crate::outline::side::{cross, distance};
use crate::outline::{FlatSide, Outline, Point};

/// Angle by which a curved side turns along one edge, at most.
pub(super) const TURN: f64 = 22.0 / 180.0 * std::f64::consts::PI;

/// Samples of a curved side's length and turn.
const SAMPLES: usize = 512;

/// Ratio of edges to those next to them on the way to a corner at which stresses have no bound.
const GRADE: f64 = 0.4;

/// Largest count of edges along one side.
const MOST: f64 = 1e6;

/// Piece of a side from its node to the next one's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    /// Begin, metres.
    pub(super) from: Point,
    /// Side, counted through all rings.
    pub(super) side: usize,
    /// Parameters of begin and end.
    pub(super) span: [f64; 2],
    /// True if a layer of elements lies along the side.
    pub(super) layered: bool,
    /// True if the piece is the cut of a neighbour's layer.
    pub(super) slide: bool,
}

/// Places nodes along all sides: evenly by length, closer where a curve turns fast.
pub(super) fn place_nodes(sides: &[FlatSide], outline: &Outline, sizing: &Sizing) -> Vec<Vec<Chord>> {
    let mut rings = Vec::with_capacity(outline.rings.len());
    let mut first = 0;
    for ring in &outline.rings {
        let count = ring.len();
        let mut chords = Vec::new();
        for k in 0..count {
            let side = first + k;
            let near = [first + (k + count - 1) % count, first + (k + 1) % count];
            let cuts = sizing.layer_m.map_or([0.0; 2], |layer| slides(sides, near, side, sizing, layer));
            let corners = [side, near[1]].map(|begin| sizing.corner_m(begin));
            chords.extend(side_chords(sides, side, cuts, corners, sizing));
        }
        first += count;
        rings.push(chords);
    }
    rings
}

/// Gives the lengths, as shares, that the neighbours' layers cut off a straight side without layer.
fn slides(sides: &[FlatSide], near: [usize; 2], side: usize, sizing: &Sizing, layer: f64) -> [f64; 2] {
    let flat = sides[side];
    if sizing.is_layered(side) || flat.curve.is_some() {
        return [0.0; 2];
    }
    let length = distance(flat.from, flat.to);
    let cut = |other: usize, outgoing: bool| {
        if !sizing.is_layered(other) {
            return 0.0;
        }
        let (a, b) = (unit(sides[other].derivative(if outgoing { 1.0 } else { 0.0 })), unit(flat.derivative(0.0)));
        // Sine of the turn at the corner: the layer ends on the side if it turns to the left by
        // between 45 and 135 degrees.
        let sine = if outgoing { cross(a, b) } else { cross(b, a) };
        if sine > std::f64::consts::FRAC_1_SQRT_2 { layer / sine / length } else { 0.0 }
    };
    let cuts = [cut(near[0], true), cut(near[1], false)];
    if cuts[0] + cuts[1] < 0.5 { cuts } else { [0.0; 2] }
}

/// Parts one side into chords.
fn side_chords(
    sides: &[FlatSide],
    side: usize,
    cuts: [f64; 2],
    corners: [Option<f64>; 2],
    sizing: &Sizing,
) -> Vec<Chord> {
    let flat = sides[side];
    let layered = sizing.is_layered(side);
    let mut parameters = if flat.curve.is_some() {
        curve_parameters(&flat, sizing.size_m, sizing.layer_m.filter(|_| layered), None)
    } else {
        let [begin, end] = [cuts[0], 1.0 - cuts[1]];
        let length = distance(flat.from, flat.to) * (end - begin);
        let count = (length / sizing.size_m - 1e-9).ceil().clamp(1.0, MOST);
        (0..=count as usize).map(|k| begin + (end - begin) * (k as f64 / count)).collect()
    };
    if !layered {
        grade(&mut parameters, &flat, corners);
    }
    if cuts[0] > 0.0 {
        parameters.insert(0, 0.0);
    }
    if cuts[1] > 0.0 {
        parameters.push(1.0);
    }
    let last = parameters.len() - 2;
    let slide = |k: usize| (k == 0 && cuts[0] > 0.0) || (k == last && cuts[1] > 0.0);
    let chord = |(k, span): (usize, &[f64])| Chord {
        from: flat.point(span[0]),
        side,
        span: [span[0], span[1]],
        layered,
        slide: slide(k),
    };
    parameters.windows(2).enumerate().map(chord).collect()
}

/// Parts the edges at both ends of a side until those at a corner have the length that it asks for.
fn grade(parameters: &mut Vec<f64>, flat: &FlatSide, corners: [Option<f64>; 2]) {
    if let ([from, to], [Some(_), Some(_)]) = (parameters.as_slice(), corners) {
        let middle = 0.5 * (from + to);
        parameters.insert(1, middle);
    }
    for corner_m in corners {
        if let (Some(length_m), [from, to, ..]) = (corner_m, parameters.as_slice()) {
            let (from, to) = (*from, *to);
            let steps = (distance(flat.point(from), flat.point(to)) / length_m).ln() / -GRADE.ln();
            let part = |step: i32| from + (to - from) * GRADE.powi(step);
            let inner: Vec<f64> = (1..=steps.max(0.0) as i32).rev().map(part).collect();
            parameters.splice(1..1, inner);
        }
        parameters.reverse();
    }
}

/// Gives the parameters of nodes along a curve: as many as length and turn need, or a given count
/// of edges. A curve that bulges into a layer has edges so short that it stays within half of it.
pub(super) fn curve_parameters(flat: &FlatSide, size: f64, layer: Option<f64>, count: Option<usize>) -> Vec<f64> {
    let step = 1.0 / SAMPLES as f64;
    let direction = |k: usize| flat.derivative((k as f64 + 0.5) * step);
    let mut sums = Vec::with_capacity(SAMPLES + 1);
    let mut sum = 0.0;
    for k in 0..SAMPLES {
        sums.push(sum);
        let way = direction(k);
        let length = way[0].hypot(way[1]) * step;
        // Half of the turn from the sample before and half of that to the next one.
        let (before, after) = (direction(k.saturating_sub(1)), direction((k + 1).min(SAMPLES - 1)));
        let shares = if k == 0 || k + 1 == SAMPLES { 1.0 } else { 2.0 };
        let turn = angle(before, after) / shares;
        let bulge = layer.filter(|_| turn < 0.0).map_or(0.0, |layer| (-turn * length / layer).sqrt());
        sum += (length / size).max(turn.abs() / TURN).max(bulge);
    }
    sums.push(sum);
    let count = count.unwrap_or((sum - 1e-6).ceil().clamp(1.0, MOST) as usize);
    let mut parameters = vec![0.0];
    let mut cell = 0;
    for k in 1..count {
        let goal = sum * k as f64 / count as f64;
        while cell + 1 < SAMPLES && sums[cell + 1] < goal {
            cell += 1;
        }
        let share = (goal - sums[cell]) / (sums[cell + 1] - sums[cell]);
        parameters.push((cell as f64 + share) * step);
    }
    parameters.push(1.0);
    parameters
}

/// Gives a vector's direction.
pub(super) fn unit(v: Point) -> Point {
    let length = v[0].hypot(v[1]);
    [v[0] / length, v[1] / length]
}

/// Gives the angle from one vector to another, positive to the left.
pub(super) fn angle(a: Point, b: Point) -> f64 {
    cross(a, b).atan2(a[0] * b[0] + a[1] * b[1])
}
