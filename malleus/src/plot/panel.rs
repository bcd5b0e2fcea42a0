//! One diagram of a picture: an area with two scales, its frame, grid, ticks and labels.

use super::canvas::{Area, Canvas};
use super::colour::{Colour, FRAME, GRID, INK, MUTED};
use super::scale::{Scale, Tick};
use super::text::{Anchor, CAPITAL_HEIGHT, TextStyle};

/// Style of tick labels.
pub(super) const TICK_TEXT: TextStyle = TextStyle::regular(12.5, MUTED);
/// Style of the names of axes, lanes and legend entries.
pub(super) const LABEL_TEXT: TextStyle = TextStyle::regular(13.5, INK);
/// Style of remarks beside a title.
pub(super) const REMARK_TEXT: TextStyle = TextStyle::regular(13.5, MUTED);
/// Style of a panel's title.
pub(super) const HEADING_TEXT: TextStyle = TextStyle::bold(15.0, INK);
/// Style of a picture's title.
pub(super) const TITLE_TEXT: TextStyle = TextStyle::bold(24.0, INK);

/// Distance from a heading's baseline down to its panel, in pixels.
const HEADING_RISE_PX: f32 = 8.0;
/// Length of a labelled tick, in pixels.
const TICK_PX: f32 = 5.0;
/// Length of a tick without a label, in pixels.
const MINOR_TICK_PX: f32 = 3.0;
/// Distance from a tick to its label, in pixels.
const TICK_LABEL_GAP_PX: f32 = 5.0;

/// Area of the page with a scale along its width and one along its height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panel {
    /// Area in which the data is drawn.
    pub(super) area: Area,
    /// Scale of the width, from left to right.
    pub(super) x: Scale,
    /// Scale of the height, from bottom to top.
    pub(super) y: Scale,
}

impl Panel {
    /// Distance of `value` from the left of the page, in pixels.
    pub(super) fn x_px(&self, value: f64) -> f32 {
        self.area.left + (self.x.share(value) * f64::from(self.area.width)) as f32
    }

    /// Distance of `value` from the top of the page, in pixels.
    pub(super) fn y_px(&self, value: f64) -> f32 {
        self.area.bottom() - (self.y.share(value) * f64::from(self.area.height)) as f32
    }

    /// Draws faint vertical lines at the labelled ticks.
    pub(super) fn vertical_grid(&self, canvas: &mut Canvas, ticks: &[Tick]) {
        for tick in ticks.iter().filter(|tick| !tick.label.is_empty()) {
            let x = self.x_px(tick.value).min(self.area.right() - 1.0);
            canvas.vertical(x, self.area.top, self.area.bottom(), GRID);
        }
    }

    /// Draws faint horizontal lines at the labelled ticks.
    pub(super) fn horizontal_grid(&self, canvas: &mut Canvas, ticks: &[Tick]) {
        for tick in ticks.iter().filter(|tick| !tick.label.is_empty()) {
            let y = self.y_px(tick.value).min(self.area.bottom() - 1.0);
            canvas.horizontal(self.area.left, self.area.right(), y, GRID);
        }
    }

    /// Draws ticks and their labels to the left of the area.
    pub(super) fn ticks_left(&self, canvas: &mut Canvas, ticks: &[Tick]) {
        for tick in ticks {
            let y = self.y_px(tick.value).min(self.area.bottom() - 1.0);
            let length = tick_length(tick);
            canvas.horizontal(self.area.left - length, self.area.left, y, FRAME);
            let baseline = y + TICK_TEXT.size_px * CAPITAL_HEIGHT / 2.0;
            let x = self.area.left - TICK_PX - TICK_LABEL_GAP_PX;
            canvas.text(&tick.label, (x, baseline), Anchor::End, TICK_TEXT);
        }
    }

    /// Draws ticks and their labels below the area.
    pub(super) fn ticks_below(&self, canvas: &mut Canvas, ticks: &[Tick]) {
        for tick in ticks {
            let x = self.x_px(tick.value).min(self.area.right() - 1.0);
            let bottom = self.area.bottom();
            canvas.vertical(x, bottom, bottom + tick_length(tick), FRAME);
            let baseline = bottom + TICK_PX + TICK_LABEL_GAP_PX + TICK_TEXT.size_px * CAPITAL_HEIGHT;
            canvas.text(&tick.label, (x, baseline), Anchor::Middle, TICK_TEXT);
        }
    }

    /// Draws the name of the vertical axis upwards, `distance_px` pixels left of the area.
    pub(super) fn label_left(&self, canvas: &mut Canvas, label: &str, distance_px: f32) {
        let place = (self.area.left - distance_px, self.area.top + self.area.height / 2.0);
        canvas.text_upwards(label, place, Anchor::Middle, LABEL_TEXT);
    }

    /// Draws the name of the horizontal axis under the tick labels.
    pub(super) fn label_below(&self, canvas: &mut Canvas, label: &str) {
        let place = (self.area.left + self.area.width / 2.0, self.area.bottom() + 40.0);
        canvas.text(label, place, Anchor::Middle, LABEL_TEXT);
    }

    /// Draws the outline of the area.
    pub(super) fn frame(&self, canvas: &mut Canvas) {
        outline(canvas, self.area, FRAME);
    }
}

/// Moves places along a column so that neighbours are at least `rise_px` pixels apart, and the last
/// is not far below `bottom_px`. The places run from the top down.
pub(super) fn push_apart(places: &mut [f32], rise_px: f32, bottom_px: f32) {
    let mut above = f32::NEG_INFINITY;
    for place in places.iter_mut() {
        *place = place.max(above + rise_px);
        above = *place;
    }
    let mut below = bottom_px + rise_px / 2.0;
    for place in places.iter_mut().rev() {
        *place = place.min(below - rise_px / 2.0);
        below = *place - rise_px / 2.0;
    }
}

/// Draws an outline one pixel thick just inside an area.
pub(super) fn outline(canvas: &mut Canvas, area: Area, colour: Colour) {
    canvas.horizontal(area.left, area.right(), area.top, colour);
    canvas.horizontal(area.left, area.right(), area.bottom() - 1.0, colour);
    canvas.vertical(area.left, area.top, area.bottom(), colour);
    canvas.vertical(area.right() - 1.0, area.top, area.bottom(), colour);
}

/// Draws a title above `area`, and a remark to the right of the title.
pub(super) fn heading(canvas: &mut Canvas, area: Area, title: &str, remark: &str) {
    let baseline = area.top - HEADING_RISE_PX;
    canvas.text(title, (area.left, baseline), Anchor::Start, HEADING_TEXT);
    let after = area.left + canvas.length_px(title, HEADING_TEXT) + 12.0;
    canvas.text(remark, (after, baseline), Anchor::Start, REMARK_TEXT);
}

/// Sign that stands before the name of a legend entry.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sign {
    /// A filled area.
    Fill(Colour),
    /// A dashed line.
    Dashed(Colour),
}

/// Draws the entries of a legend in a line above `area` that ends at its right edge.
pub(super) fn legend(canvas: &mut Canvas, area: Area, entries: &[(Sign, &str)]) {
    const SIGN_WIDTH_PX: f32 = 18.0;
    const SIGN_HEIGHT_PX: f32 = 10.0;
    let baseline = area.top - HEADING_RISE_PX;
    let middle = baseline - LABEL_TEXT.size_px * CAPITAL_HEIGHT / 2.0;
    let mut right = area.right();
    for (sign, name) in entries.iter().rev() {
        canvas.text(name, (right, baseline), Anchor::End, LABEL_TEXT);
        let end = right - canvas.length_px(name, LABEL_TEXT) - 7.0;
        let swatch = Area {
            left: (end - SIGN_WIDTH_PX).round(),
            top: (middle - SIGN_HEIGHT_PX / 2.0).round(),
            width: SIGN_WIDTH_PX,
            height: SIGN_HEIGHT_PX,
        };
        match *sign {
            Sign::Fill(colour) => canvas.rectangle(swatch, colour),
            Sign::Dashed(colour) => {
                let y = swatch.top + SIGN_HEIGHT_PX / 2.0 + 0.5;
                let ends = [(swatch.left, y), (swatch.right(), y)];
                canvas.line(&ends, 1.5, Some(BUILT_DASH), colour);
            }
        }
        right = swatch.left - 22.0;
    }
}

/// Lengths of the strokes and gaps of every dashed line in the pictures, in pixels.
pub(super) const BUILT_DASH: [f32; 2] = [5.0, 3.0];

fn tick_length(tick: &Tick) -> f32 {
    if tick.label.is_empty() { MINOR_TICK_PX } else { TICK_PX }
}
