//! One diagram of curves that cross: each curve named at its right end, crossings and levels
//! marked.

use std::path::Path;

use super::canvas::{Area, Canvas};
use super::colour::{Colour, FRAME, INK, MUTED, PAGE};
use super::curves::{Axis, Curve, colour_of, draw_curve, scale_of};
use super::error::PlotError;
use super::page;
use super::panel::{LABEL_TEXT, Panel, REMARK_TEXT, TITLE_TEXT, push_apart};
use super::text::{Anchor, CAPITAL_HEIGHT, TextStyle};

/// Picture of curves that cross.
#[derive(Clone, Debug)]
pub struct CrossingsPicture {
    /// Title above the diagram.
    pub title: String,
    /// Remark in a line below the title.
    pub remark: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves, drawn in this order; a name stands at the right of its curve's last point.
    pub curves: Vec<Curve>,
    /// Horizontal lines across the diagram.
    pub levels: Vec<Level>,
    /// Marked points.
    pub marks: Vec<Mark>,
}

/// Horizontal line across the diagram.
#[derive(Clone, Debug)]
pub struct Level {
    /// Value of the vertical axis.
    pub value: f64,
    /// Name that stands on the line's left end.
    pub name: String,
}

/// Point that is marked by a ring.
#[derive(Clone, Debug)]
pub struct Mark {
    /// Point `[x, y]`.
    pub place: [f64; 2],
    /// Name that stands below the ring, to its right.
    pub name: String,
}

const SIZE: (u32, u32) = (1200, 760);
const AREA: Area = Area { left: 95.0, top: 110.0, width: 830.0, height: 570.0 };
/// Distance of the curves' names from the left of the page, in pixels.
const NAMES_PX: f32 = 960.0;
/// Least distance between the baselines of two names, in pixels.
const NAME_RISE_PX: f32 = 20.0;
const MARK_RADIUS_PX: f32 = 6.0;

/// Draws curves that cross into a PNG file.
///
/// # Errors
/// [`PlotError`] with the path of the file, also for a picture without curves.
pub fn crossings(path: &Path, picture: &CrossingsPicture) -> Result<(), PlotError> {
    if picture.curves.is_empty() {
        return Err(PlotError::Nothing { path: path.to_owned(), what: "curve" });
    }
    let panel = Panel { area: AREA, x: scale_of(&picture.x), y: scale_of(&picture.y) };
    let mut canvas = page::blank(path, SIZE.0, SIZE.1)?;
    canvas.text(&picture.title, (AREA.left, 46.0), Anchor::Start, TITLE_TEXT);
    canvas.text(&picture.remark, (AREA.left, 74.0), Anchor::Start, REMARK_TEXT);
    let (x_ticks, y_ticks) = (panel.x.ticks(AREA.width, 40.0), panel.y.ticks(AREA.height, 40.0));
    panel.vertical_grid(&mut canvas, &x_ticks);
    panel.horizontal_grid(&mut canvas, &y_ticks);
    for level in &picture.levels {
        draw_level(&mut canvas, &panel, level);
    }
    for curve in &picture.curves {
        draw_curve(&mut canvas, &panel, curve);
    }
    draw_names(&mut canvas, &panel, &picture.curves);
    for mark in &picture.marks {
        draw_mark(&mut canvas, &panel, mark);
    }
    panel.ticks_left(&mut canvas, &y_ticks);
    panel.ticks_below(&mut canvas, &x_ticks);
    panel.label_left(&mut canvas, &picture.y.label, 60.0);
    panel.label_below(&mut canvas, &picture.x.label);
    panel.frame(&mut canvas);
    page::write(path, &canvas)
}

fn draw_level(canvas: &mut Canvas, panel: &Panel, level: &Level) {
    let y = panel.y_px(level.value);
    canvas.line(&[(AREA.left, y), (AREA.right(), y)], 1.5, Some([9.0, 4.0]), FRAME);
    let style = TextStyle { colour: MUTED, ..LABEL_TEXT };
    canvas.text(&level.name, (AREA.left + 12.0, y - 6.0), Anchor::Start, style);
}

fn draw_mark(canvas: &mut Canvas, panel: &Panel, mark: &Mark) {
    let [x, y] = mark.place;
    let place = (panel.x_px(x), panel.y_px(y));
    ring(canvas, place, INK);
    let style = TextStyle::bold(LABEL_TEXT.size_px, INK);
    let below = place.1 + MARK_RADIUS_PX + LABEL_TEXT.size_px;
    canvas.text(&mark.name, (place.0 + MARK_RADIUS_PX, below), Anchor::Start, style);
}

fn ring(canvas: &mut Canvas, place: (f32, f32), colour: Colour) {
    canvas.disc(place, MARK_RADIUS_PX, colour);
    canvas.disc(place, MARK_RADIUS_PX - 2.0, PAGE);
}

/// Draws the names of the curves beside their last points, from the top down.
fn draw_names(canvas: &mut Canvas, panel: &Panel, curves: &[Curve]) {
    let end = |curve: &Curve| curve.points.last().map(|[x, y]| (panel.x_px(*x), panel.y_px(*y)));
    let mut named: Vec<_> = curves
        .iter()
        .filter(|curve| !curve.name.is_empty())
        .filter_map(|curve| end(curve).map(|end| (curve, end)))
        .collect();
    named.sort_by(|(_, a), (_, b)| a.1.total_cmp(&b.1));
    let mut places: Vec<f32> = named.iter().map(|(_, end)| end.1).collect();
    push_apart(&mut places, NAME_RISE_PX, AREA.bottom());
    for ((curve, end), name_px) in named.into_iter().zip(places) {
        canvas.line(&[end, (AREA.right() + 8.0, name_px), (NAMES_PX - 6.0, name_px)], 1.0, None, FRAME);
        let style = TextStyle { colour: colour_of(curve), ..LABEL_TEXT };
        let baseline = name_px + LABEL_TEXT.size_px * CAPITAL_HEIGHT / 2.0;
        canvas.text(&curve.name, (NAMES_PX, baseline), Anchor::Start, style);
    }
}

#[cfg(test)]
mod tests {
    use super::super::StrokeKind;
    use super::*;

    #[test]
    fn picture_without_curves_is_refused_and_one_with_a_mark_is_drawn() {
        let axis = |range| Axis { label: "x".into(), range, logarithmic: true };
        let picture = CrossingsPicture {
            title: String::new(),
            remark: String::new(),
            x: axis([1.0, 10.0]),
            y: axis([1.0, 10.0]),
            curves: Vec::new(),
            levels: vec![Level { value: 5.0, name: "half".into() }],
            marks: vec![Mark { place: [2.0, 2.0], name: "two".into() }],
        };
        assert!(matches!(crossings(Path::new("none.png"), &picture), Err(PlotError::Nothing { .. })));
        let points = vec![[1.0, 1.0], [10.0, 9.0]];
        let curve = Curve { name: "rising".into(), colour: 0, stroke: StrokeKind::Solid, points };
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("crossing.png");
        crossings(&path, &CrossingsPicture { curves: vec![curve], ..picture }).expect("drawn");
        assert!(path.exists());
    }
}
