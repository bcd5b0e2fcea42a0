//! Diagrams of measurements: curves in panels side by side.

use std::path::Path;

use super::canvas::{Area, Canvas};
use super::colour::{ACCELERATION, Colour, DIRECT, DRIVEN, STRIKER, WAVEFORM};
use super::error::PlotError;
use super::page;
use super::panel::{BUILT_DASH, LABEL_TEXT, Panel, REMARK_TEXT, TITLE_TEXT, heading};
use super::scale::Scale;
use super::text::{Anchor, CAPITAL_HEIGHT};

/// Picture of panels with curves, two panels per row.
#[derive(Clone, Debug)]
pub struct CurvesPicture {
    /// Title above the panels.
    pub title: String,
    /// Remark in a line below the title.
    pub remark: String,
    /// Panels from left to right and from top to bottom.
    pub panels: Vec<CurvesPanel>,
}

/// One diagram of curves.
#[derive(Clone, Debug)]
pub struct CurvesPanel {
    /// Title above the diagram.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves, drawn in this order.
    pub curves: Vec<Curve>,
}

/// Axis of a diagram.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name of the quantity along the axis, with its unit.
    pub label: String,
    /// Lowest and highest value, in this order; both are positive on a logarithmic axis.
    ///
    /// Curves are cut at them.
    pub range: [f64; 2],
    /// True if the axis is logarithmic, false if it is linear.
    pub logarithmic: bool,
}

/// Curve of a diagram.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Name in the legend; a curve with an empty name has no entry there.
    pub name: String,
    /// Index of one of the picture's five colours, counted from 0; after the last the first
    /// follows.
    pub colour: usize,
    /// Kind of stroke.
    pub stroke: StrokeKind,
    /// Points `[x, y]`; the curve has a gap at each point that is not finite.
    pub points: Vec<[f64; 2]>,
}

/// Kind of stroke with which a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrokeKind {
    /// A solid line.
    Solid,
    /// A dashed line.
    Dashed,
    /// Dots at the points, joined by a thin line.
    Dots,
}

const COLOURS: [Colour; 5] = [WAVEFORM, DRIVEN, ACCELERATION, STRIKER, DIRECT];
const WIDTH: u32 = 1400;
const TOP_PX: f32 = 130.0;
const PANEL_PX: (f32, f32) = (570.0, 330.0);
const LEFT_PX: f32 = 95.0;
const COLUMN_PX: f32 = 690.0;
const ROW_PX: f32 = 455.0;
const DOT_PX: f32 = 3.2;

/// Draws a picture of curves into a PNG file.
///
/// # Errors
/// [`PlotError`] with the path of the file, also for a picture without panels.
pub fn curves(path: &Path, picture: &CurvesPicture) -> Result<(), PlotError> {
    if picture.panels.is_empty() {
        return Err(PlotError::Nothing { path: path.to_owned(), what: "panel" });
    }
    let rows = picture.panels.len().div_ceil(2);
    let height = TOP_PX + ROW_PX * rows as f32 - 40.0;
    let mut canvas = page::blank(path, WIDTH, height as u32)?;
    canvas.text(&picture.title, (LEFT_PX, 46.0), Anchor::Start, TITLE_TEXT);
    canvas.text(&picture.remark, (LEFT_PX, 74.0), Anchor::Start, REMARK_TEXT);
    for (index, panel) in picture.panels.iter().enumerate() {
        let (row, column) = (index / 2, index % 2);
        let area = Area {
            left: LEFT_PX + COLUMN_PX * column as f32,
            top: TOP_PX + ROW_PX * row as f32,
            width: PANEL_PX.0,
            height: PANEL_PX.1,
        };
        draw_panel(&mut canvas, area, panel);
    }
    page::write(path, &canvas)
}

fn draw_panel(canvas: &mut Canvas, area: Area, content: &CurvesPanel) {
    let panel = Panel { area, x: scale_of(&content.x), y: scale_of(&content.y) };
    let (x_ticks, y_ticks) = (panel.x.ticks(area.width, 60.0), panel.y.ticks(area.height, 40.0));
    panel.vertical_grid(canvas, &x_ticks);
    panel.horizontal_grid(canvas, &y_ticks);
    for curve in &content.curves {
        draw_curve(canvas, &panel, curve);
    }
    panel.ticks_left(canvas, &y_ticks);
    panel.ticks_below(canvas, &x_ticks);
    panel.label_left(canvas, &content.y.label, 56.0);
    panel.label_below(canvas, &content.x.label);
    panel.frame(canvas);
    heading(canvas, area, &content.title, "");
    draw_names(canvas, area, &content.curves);
}

/// Scale of an axis.
pub(super) fn scale_of(axis: &Axis) -> Scale {
    let [low, high] = axis.range;
    if axis.logarithmic { Scale::logarithmic(low, high) } else { Scale::linear(low, high) }
}

/// Colour of a curve.
pub(super) fn colour_of(curve: &Curve) -> Colour {
    COLOURS[curve.colour % COLOURS.len()]
}

/// Draws the parts of a curve that lie within a panel.
pub(super) fn draw_curve(canvas: &mut Canvas, panel: &Panel, curve: &Curve) {
    let colour = colour_of(curve);
    let inside = |[x, y]: &[f64; 2]| {
        let seen = |share: f64| (-1e-9..=1.0 + 1e-9).contains(&share);
        seen(panel.x.share(*x)) && seen(panel.y.share(*y))
    };
    for stretch in curve.points.split(|point| !inside(point)).filter(|stretch| !stretch.is_empty()) {
        let places: Vec<(f32, f32)> = stretch.iter().map(|[x, y]| (panel.x_px(*x), panel.y_px(*y))).collect();
        match curve.stroke {
            StrokeKind::Solid => canvas.line(&places, 2.0, None, colour),
            StrokeKind::Dashed => canvas.line(&places, 2.0, Some(BUILT_DASH), colour),
            StrokeKind::Dots => {
                canvas.line(&places, 1.0, None, colour);
                places.iter().for_each(|place| canvas.disc(*place, DOT_PX, colour));
            }
        }
    }
}

/// Draws the names of the curves in a line above the panel that ends at its right edge.
fn draw_names(canvas: &mut Canvas, area: Area, curves: &[Curve]) {
    let baseline = area.top - 8.0;
    let middle = baseline - LABEL_TEXT.size_px * CAPITAL_HEIGHT / 2.0;
    let mut right = area.right();
    for curve in curves.iter().rev().filter(|curve| !curve.name.is_empty()) {
        let colour = colour_of(curve);
        canvas.text(&curve.name, (right, baseline), Anchor::End, LABEL_TEXT);
        let end = right - canvas.length_px(&curve.name, LABEL_TEXT) - 6.0;
        let line = [(end - 20.0, middle), (end, middle)];
        canvas.line(&line, 2.0, (curve.stroke == StrokeKind::Dashed).then_some(BUILT_DASH), colour);
        if curve.stroke == StrokeKind::Dots {
            canvas.disc((end - 10.0, middle), DOT_PX, colour);
        }
        right = end - 36.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn picture_without_panels_is_refused_and_one_with_a_gap_is_drawn() {
        let picture = CurvesPicture { title: String::new(), remark: String::new(), panels: Vec::new() };
        assert!(matches!(curves(Path::new("none.png"), &picture), Err(PlotError::Nothing { .. })));
        let axis = |range| Axis { label: "x".into(), range, logarithmic: false };
        let curve = Curve {
            name: "gap".into(),
            colour: 7,
            stroke: StrokeKind::Solid,
            points: vec![[0.0, 0.0], [1.0, 1.0], [2.0, f64::NAN], [3.0, 1.0], [4.0, 0.5]],
        };
        let panel = CurvesPanel { title: "p".into(), x: axis([0.0, 4.0]), y: axis([0.0, 1.0]), curves: vec![curve] };
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("gap.png");
        curves(&path, &CurvesPicture { panels: vec![panel], ..picture }).expect("drawn");
        assert!(path.exists());
    }
}
