//! Circles and ellipses in drawings: their cubics are 0.03 % off, and are replaced by shorter ones.

use super::side::{between, cross};
use super::{Point, Side};

/// Largest angle of a cubic that stands for a part of a circle: off by 1e-7 of the radius.
const MOST_RAD: f64 = std::f64::consts::PI / 8.0;
/// Differences from a circle, as a share of the radius, below which a cubic is a part of one.
const SAME: f64 = 2e-3;
/// Differences of the tangents' shares of an arc of any angle, which come from 32 bit alone.
const ROUNDING: f64 = 1e-4;

/// Length of a quarter ellipse's control arms, as a share of the way to where its tangents meet.
const QUARTER_ARM: f64 = 0.552_284_75;
/// Smallest angle of an ellipse's cubic that is replaced: shorter ones are off by 1e-6 of the
/// radius at most.
const LEAST_RAD: f64 = std::f64::consts::PI / 5.0;
/// Largest angle of an ellipse's cubic: readers of drawings part longer arcs.
const QUARTER_RAD: f64 = std::f64::consts::FRAC_PI_2 * (1.0 + 1e-3);

/// Least radius of a circle whose cubics are replaced, as a share of the ring's extent: the corners
/// of a rounded rectangle stay. Of an ellipse its larger radius counts.
const LARGE: f64 = 0.25;

/// Arc of an ellipse: at an angle φ it is `centre + cos φ first + sin φ second`.
struct Arc {
    centre: Point,
    /// Conjugate radii.
    radii: [Point; 2],
    begin_rad: f64,
    sweep_rad: f64,
}

/// Replaces the cubics of a ring that stand for parts of large circles and ellipses by shorter
/// ones. With `has_arcs` the drawing names circles, ellipses or arcs: all cubics that come from
/// such ones are known; without it those of circles and of quarter ellipses.
pub(super) fn with_round_arcs(ring: &[Side], has_arcs: bool) -> Vec<Side> {
    let extent = |axis: usize| {
        let along = ring.iter().filter_map(|side| side.from.get(axis).copied());
        along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
    };
    let least = LARGE * extent(0).max(extent(1));
    let ends = ring.iter().cycle().skip(1);
    let replaced = |(side, next): (&Side, &Side)| {
        let found = circle(side, next.from).or_else(|| ellipse(side, next.from, has_arcs));
        let large = found.filter(|arc| arc.largest_radius() >= least);
        large.map_or_else(|| vec![*side], |arc| arc.sides(side.from))
    };
    ring.iter().zip(ends).flat_map(replaced).collect()
}

impl Arc {
    /// Largest radius of the ellipse.
    fn largest_radius(&self) -> f64 {
        let [[a, b], [c, d]] = self.radii;
        let (sum, product) = (a * a + b * b + c * c + d * d, a * d - b * c);
        (0.5 * (sum + (sum * sum - 4.0 * product * product).max(0.0).sqrt())).sqrt()
    }

    /// Short cubics along the arc, which begins at a point.
    fn sides(&self, from: Point) -> Vec<Side> {
        let count = (self.sweep_rad.abs() / MOST_RAD * (1.0 - 1e-3)).ceil().max(1.0);
        let step = self.sweep_rad / count;
        let arm = 4.0 / 3.0 * (step / 4.0).tan();
        let [first, second] = self.radii;
        let point = |number: f64| {
            let (sine, cosine) = (self.begin_rad + step * number).sin_cos();
            let at = [0, 1].map(|axis| self.centre[axis] + cosine * first[axis] + sine * second[axis]);
            (at, [0, 1].map(|axis| arm * (cosine * second[axis] - sine * first[axis])))
        };
        let piece = |number: usize| {
            let number = number as f64;
            let ((a, leaves), (b, arrives)) = (point(number), point(number + 1.0));
            let a = if number == 0.0 { from } else { a };
            Side {
                from: a,
                curve: Some([[a[0] + leaves[0], a[1] + leaves[1]], [b[0] - arrives[0], b[1] - arrives[1]]]),
            }
        };
        (0..count as usize).map(piece).collect()
    }
}

/// Finds the part of a circle that a cubic stands for; `None` if it stands for none.
fn circle(side: &Side, to: Point) -> Option<Arc> {
    let (from, [first, second]) = (side.from, side.curve?);
    let [begin, end] = [between(from, first), between(second, to)];
    let angle = cross(begin, end).atan2(begin[0] * end[0] + begin[1] * end[1]);
    // The circle through both ends with the first tangent: its centre lies on the tangent's normal.
    let chord = between(from, to);
    let normal = [-begin[1], begin[0]];
    let along = 2.0 * (chord[0] * normal[0] + chord[1] * normal[1]);
    let share = (chord[0] * chord[0] + chord[1] * chord[1]) / along;
    let centre = [from[0] + share * normal[0], from[1] + share * normal[1]];
    let radius = (from[0] - centre[0]).hypot(from[1] - centre[1]);
    let arm = 4.0 / 3.0 * (angle.abs() / 4.0).tan() * radius;
    let is_arm = |way: Point| (way[0].hypot(way[1]) - arm).abs() < SAME * radius;
    let radial = between(centre, to);
    let leans = (radial[0] * end[0] + radial[1] * end[1]).abs() / radius;
    let is_round = is_arm(begin) && is_arm(end) && leans < SAME * radius;
    (radius.is_finite() && radius > 0.0 && is_round).then(|| Arc {
        centre,
        radii: [[radius, 0.0], [0.0, radius]],
        begin_rad: (from[1] - centre[1]).atan2(from[0] - centre[0]),
        sweep_rad: angle,
    })
}

/// Finds the part of an ellipse that a cubic stands for, of a quarter unless `any_angle` is true;
/// `None` if it stands for none.
fn ellipse(side: &Side, to: Point, any_angle: bool) -> Option<Arc> {
    let (from, [first, second]) = (side.from, side.curve?);
    let [begin, end, chord] = [between(from, first), between(second, to), between(from, to)];
    // Shares of the ways to where the tangents meet; an affine map keeps them. Both shares of an
    // arc of the angle 2h are 2/3 (1 - tan² h/2).
    let turn = cross(begin, end);
    let shares = [turn / cross(chord, end), turn / cross(begin, chord)];
    let like = |share: f64, within: f64| shares.iter().all(|other| (other - share).abs() < within);
    let mean = 0.5 * (shares[0] + shares[1]);
    let half = if any_angle && like(mean, ROUNDING) {
        2.0 * (1.0 - 1.5 * mean).max(0.0).sqrt().atan()
    } else if like(QUARTER_ARM, 0.5 * SAME) {
        0.5 * std::f64::consts::FRAC_PI_2
    } else {
        return None;
    };
    if !(LEAST_RAD..=QUARTER_RAD).contains(&(2.0 * half)) {
        return None;
    }
    let meeting = [0, 1].map(|axis| 0.5 * (first[axis] - from[axis] + second[axis] - to[axis]) / mean);
    // The way from the chord's middle to where the tangents meet is sin² h / cos h first radii.
    let (sine, cosine) = half.sin_cos();
    let outwards = meeting.map(|way| way * cosine / (sine * sine));
    let centre = [0, 1].map(|axis| 0.5 * (from[axis] + to[axis]) - cosine * outwards[axis]);
    let across = chord.map(|way| 0.5 * way / sine);
    Some(Arc { centre, radii: [outwards, across], begin_rad: -half, sweep_rad: 2.0 * half })
}
