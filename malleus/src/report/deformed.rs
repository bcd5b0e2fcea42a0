//! Deformed outlines of sheets and bodies of revolution.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use shape::solve::{Figure, Motion};

use super::plan::{Plan, Point, bounds, drawing};

/// Width of a drawing in its own units.
const WIDTH: f64 = 240.0;
/// Width of the drawing of the waves round an axis.
const ROUND_WIDTH: f64 = 96.0;
/// Largest motion, as a share of the longer extent of a body.
const LARGEST: f64 = 0.08;
/// Radius of the circle that shows the waves, in units of the drawing.
const RADIUS: f64 = 34.0;
/// Height of the waves, as a share of the radius.
const WAVE: f64 = 0.18;
/// Number of points of the circle.
const POINTS: u32 = 144;

/// Draws the outline of a sheet at rest and deformed by a mode.
pub(super) fn sheet(figure: &Figure, motion: &Motion, label: &str) -> String {
    let (plan, factor) = room(figure, motion, [0, 1], bounds(figure.points.iter().copied()));
    let shifted = |at: usize, by: f64| {
        let [x, y, _] = motion.at[at].map(f64::from);
        [figure.points[at][0] + by * x, figure.points[at][1] + by * y]
    };
    let outline = |by: f64| rows(figure).map(|row| plan.along(row.iter().map(|&at| shifted(at, by)))).collect();
    drawing(plan.size, label, &rest_and_deformed(outline(0.0), outline(factor)))
}

/// Draws the section of a body of revolution at rest and deformed by a mode, and beside it the
/// waves round the axis with their nodal meridians.
pub(super) fn revolve(figure: &Figure, motion: &Motion, label: &str) -> String {
    let [low, high] = bounds(figure.points.iter().copied());
    let (plan, factor) = room(figure, motion, [0, 2], [[-high[0], low[1]], high]);
    // The motion at the other end of a diameter has the sign of an even or odd number of waves.
    let opposite = if motion.waves % 2 == 0 { 1.0 } else { -1.0 };
    let shifted = |at: usize, by: f64| {
        let [radial, _, axial] = motion.at[at].map(f64::from);
        [figure.points[at][0] + by * radial, figure.points[at][1] + by * axial]
    };
    let half = |side: f64, by: f64| {
        let place = move |&at: &usize| {
            let [radius, height] = shifted(at, by);
            [side * radius, height]
        };
        rows(figure).map(move |row| plan.along(row.iter().map(place))).collect::<String>()
    };
    let section = |by: f64| half(1.0, by) + &half(-1.0, opposite * by);
    let size = [WIDTH + ROUND_WIDTH, plan.size[1].max(ROUND_WIDTH)];
    let down = (size[1] - plan.size[1]) / 2.0;
    let axis = plan.along([[0.0, low[1]], [0.0, high[1]]]);
    let body = format!(
        "<g transform=\"translate(0 {down:.1})\"><path class=\"upright mark\" d=\"{axis}\"/>{}</g><g transform=\"translate({:.1} {:.1})\">{}</g>",
        rest_and_deformed(section(0.0), section(factor)),
        WIDTH + ROUND_WIDTH / 2.0,
        size[1] / 2.0,
        waves(motion)
    );
    drawing(size, label, &body)
}

/// True if a body of revolution mostly turns round its axis in a mode.
pub(super) fn is_twist(motion: &Motion) -> bool {
    let energy = |axis: usize| motion.at.iter().map(|at| f64::from(at[axis]).powi(2)).sum::<f64>();
    motion.waves == 0 && energy(1) > energy(0) + energy(2)
}

/// Rows of points on the outline, but those along the axis of a body of revolution.
fn rows(figure: &Figure) -> impl Iterator<Item = &Vec<usize>> {
    figure.rim.iter().filter(|row| row.iter().any(|&at| figure.points[at][0] != 0.0))
}

/// Plan with room for the motion, and the factor that makes the motion as large.
fn room(figure: &Figure, motion: &Motion, axes: [usize; 2], [low, high]: [Point; 2]) -> (Plan, f64) {
    let [low_r, high_r] = bounds(figure.points.iter().copied());
    let reach = LARGEST * (high_r[0] - low_r[0]).max(high_r[1] - low_r[1]);
    let size = |at: &[f32; 3]| f64::from(at[axes[0]]).hypot(f64::from(at[axes[1]]));
    let largest = motion.at.iter().map(size).fold(0.0, f64::max);
    // A twist moves no point of the section within it.
    let whole = motion.at.iter().flatten().fold(f64::MIN_POSITIVE, |most, part| most.max(f64::from(part.abs())));
    let factor = if largest > 1e-6 * whole { reach / largest } else { 0.0 };
    let room = [low.map(|x| x - reach), high.map(|x| x + reach)];
    (Plan::new(room, WIDTH, WIDTH), factor)
}

fn rest_and_deformed(rest: String, deformed: String) -> String {
    format!("<path class=\"rim\" d=\"{rest}\"/><path class=\"line wide fit\" d=\"{deformed}\"/>")
}

/// Circle at rest and with its waves, and lines to where it rests.
fn waves(motion: &Motion) -> String {
    let number = f64::from(motion.waves);
    let turn = if motion.is_second { FRAC_PI_2 } else { 0.0 };
    let height = if is_twist(motion) { 0.0 } else { WAVE };
    let at = |radius: f64, angle: f64| format!("{:.1} {:.1}", radius * angle.cos(), -radius * angle.sin());
    let angles = (0..POINTS).map(|step| TAU * f64::from(step) / f64::from(POINTS));
    let circle: Vec<String> =
        angles.map(|angle| at(RADIUS * (1.0 + height * (number * angle - turn).cos()), angle)).collect();
    let meridian = |index: u32| {
        let angle = (turn + FRAC_PI_2 + PI * f64::from(index)) / number;
        format!("<path class=\"line nodal mark\" d=\"M0 0L{}\"/>", at(RADIUS, angle))
    };
    let meridians: String = (0..2 * motion.waves).map(meridian).collect();
    format!(
        "<circle class=\"rim\" cx=\"0\" cy=\"0\" r=\"{RADIUS}\"/>{meridians}<path class=\"line wide fit\" d=\"M{}Z\"/>",
        circle.join("L")
    )
}
