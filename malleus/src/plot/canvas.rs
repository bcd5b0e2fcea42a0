//! The opaque page on which pictures are drawn: areas, lines, discs, text and single pixels.

use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8, Rect, Stroke, StrokeDash,
    Transform,
};

use super::colour::{Colour, PAGE};
use super::text::{Anchor, TextStyle, Typeface};

/// Rectangle of the page, in pixels from the top left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    /// Distance of the left edge from the left of the page, in pixels.
    pub(super) left: f32,
    /// Distance of the top edge from the top of the page, in pixels.
    pub(super) top: f32,
    /// Width in pixels.
    pub(super) width: f32,
    /// Height in pixels.
    pub(super) height: f32,
}

impl Area {
    /// Distance of the right edge from the left of the page, in pixels.
    pub(super) fn right(&self) -> f32 {
        self.left + self.width
    }

    /// Distance of the bottom edge from the top of the page, in pixels.
    pub(super) fn bottom(&self) -> f32 {
        self.top + self.height
    }

    /// Lane `index`, counted from the top, when the area is divided into `count` lanes of equal
    /// height.
    pub(super) fn lane(&self, index: usize, count: usize) -> Self {
        let height = self.height / count as f32;
        Self { top: self.top + height * index as f32, height, ..*self }
    }
}

/// Reason for which a page cannot be made.
#[derive(Clone, Copy, Debug)]
pub(super) enum CanvasError {
    /// The font's bytes are damaged.
    Font,
    /// The page has no pixels, or more than fit into memory.
    Surface,
}

/// Page of pixels on which shapes and text are drawn.
pub(super) struct Canvas {
    pixels: Pixmap,
    typeface: Typeface,
}

impl Canvas {
    /// Creates a blank page.
    ///
    /// # Errors
    /// [`CanvasError`] if the page has no pixels or more than fit into memory, or the font is
    /// damaged.
    pub(super) fn new(width: u32, height: u32) -> Result<Self, CanvasError> {
        let typeface = Typeface::built_in().ok_or(CanvasError::Font)?;
        let mut pixels = Pixmap::new(width, height).ok_or(CanvasError::Surface)?;
        pixels.fill(tiny_skia::Color::from_rgba8(PAGE.red, PAGE.green, PAGE.blue, 255));
        Ok(Self { pixels, typeface })
    }

    /// Width of the page in pixels.
    pub(super) fn width(&self) -> u32 {
        self.pixels.width()
    }

    /// Height of the page in pixels.
    pub(super) fn height(&self) -> u32 {
        self.pixels.height()
    }

    /// Red, green and blue of each pixel, row by row from the top.
    pub(super) fn rgb(&self) -> Vec<u8> {
        self.pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect()
    }

    /// Fills an area. Edges that fall between pixels are blended.
    pub(super) fn rectangle(&mut self, area: Area, colour: Colour) {
        if let Some(rect) = Rect::from_xywh(area.left, area.top, area.width, area.height) {
            self.pixels.fill_rect(rect, &paint(colour), Transform::identity(), None);
        }
    }

    /// Draws a horizontal line one pixel thick in the row of pixels that holds `y`.
    pub(super) fn horizontal(&mut self, left: f32, right: f32, y: f32, colour: Colour) {
        self.rectangle(Area { left, top: y.floor(), width: right - left, height: 1.0 }, colour);
    }

    /// Draws a vertical line one pixel thick in the column of pixels that holds `x`.
    pub(super) fn vertical(&mut self, x: f32, top: f32, bottom: f32, colour: Colour) {
        self.rectangle(Area { left: x.floor(), top, width: 1.0, height: bottom - top }, colour);
    }

    /// Draws a line through `points`, `width` pixels thick.
    ///
    /// `dash` gives the lengths of its strokes and of the gaps between them, in pixels.
    pub(super) fn line(&mut self, points: &[(f32, f32)], width: f32, dash: Option<[f32; 2]>, colour: Colour) {
        let stroke = Stroke {
            width,
            line_cap: LineCap::Butt,
            line_join: LineJoin::Bevel,
            dash: dash.and_then(|lengths| StrokeDash::new(lengths.to_vec(), 0.0)),
            ..Stroke::default()
        };
        if let Some(path) = path(points, false) {
            self.pixels.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
        }
    }

    /// Draws a filled disc.
    pub(super) fn disc(&mut self, (x, y): (f32, f32), radius: f32, colour: Colour) {
        if let Some(path) = PathBuilder::from_circle(x, y, radius) {
            self.pixels.fill_path(&path, &paint(colour), FillRule::Winding, Transform::identity(), None);
        }
    }

    /// Lays a colour over one pixel. Pixels outside the page are ignored.
    pub(super) fn pixel(&mut self, x: u32, y: u32, colour: Colour) {
        self.blend(i64::from(x), i64::from(y), colour, 1.0);
    }

    /// Draws a text on a horizontal baseline.
    pub(super) fn text(&mut self, text: &str, (x, baseline): (f32, f32), anchor: Anchor, style: TextStyle) {
        let start = x - self.before_anchor(text, anchor, style);
        let mut covered = Vec::new();
        self.typeface.cover(text, style, (start, baseline), |x, y, share| {
            covered.push((x, y, share));
        });
        for (x, y, share) in covered {
            self.blend(i64::from(x), i64::from(y), style.colour, share);
        }
    }

    /// Draws a text that runs upwards on a vertical baseline; the feet of its letters point right.
    pub(super) fn text_upwards(&mut self, text: &str, (baseline, y): (f32, f32), anchor: Anchor, style: TextStyle) {
        let start = -y - self.before_anchor(text, anchor, style);
        let mut covered = Vec::new();
        self.typeface.cover(text, style, (start, baseline), |along, across, share| {
            covered.push((across, -1 - along, share));
        });
        for (x, y, share) in covered {
            self.blend(i64::from(x), i64::from(y), style.colour, share);
        }
    }

    /// Length of a text in pixels.
    pub(super) fn length_px(&self, text: &str, style: TextStyle) -> f32 {
        self.typeface.length_px(text, style)
    }

    /// The text, cut before an ellipsis if it is longer than `room_px` pixels.
    pub(super) fn shortened(&self, text: &str, style: TextStyle, room_px: f32) -> String {
        self.typeface.shortened(text, style, room_px)
    }

    fn before_anchor(&self, text: &str, anchor: Anchor, style: TextStyle) -> f32 {
        match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => self.typeface.length_px(text, style) / 2.0,
            Anchor::End => self.typeface.length_px(text, style),
        }
    }

    /// Lays a colour over one pixel, with `share` (0 to 1) of the colour's opacity.
    fn blend(&mut self, x: i64, y: i64, colour: Colour, share: f32) {
        let (width, height) = (i64::from(self.width()), i64::from(self.height()));
        if !(0..width).contains(&x) || !(0..height).contains(&y) {
            return;
        }
        let share = share.clamp(0.0, 1.0) * f32::from(colour.opacity) / 255.0;
        let over =
            |below: u8, above: u8| (f32::from(below) + (f32::from(above) - f32::from(below)) * share).round() as u8;
        if let Some(pixel) = self.pixels.pixels_mut().get_mut((y * width + x) as usize) {
            let blended = PremultipliedColorU8::from_rgba(
                over(pixel.red(), colour.red),
                over(pixel.green(), colour.green),
                over(pixel.blue(), colour.blue),
                255,
            );
            *pixel = blended.unwrap_or(*pixel);
        }
    }
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(colour.red, colour.green, colour.blue, colour.opacity);
    paint
}

/// Path through `points`; `None` if they are fewer than two or not finite.
fn path(points: &[(f32, f32)], closed: bool) -> Option<Path> {
    let (first, rest) = points.split_first()?;
    let mut builder = PathBuilder::with_capacity(points.len() + 1, points.len());
    builder.move_to(first.0, first.1);
    for point in rest {
        builder.line_to(point.0, point.1);
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::colour::INK;

    fn darkness(canvas: &Canvas, columns: std::ops::Range<u32>, rows: std::ops::Range<u32>) -> u64 {
        let rgb = canvas.rgb();
        rows.flat_map(|row| columns.clone().map(move |column| (row, column)))
            .map(|(row, column)| u64::from(255 - rgb[((row * canvas.width() + column) * 3) as usize]))
            .sum()
    }

    #[test]
    fn page_of_no_pixels_is_refused() {
        assert!(matches!(Canvas::new(0, 10), Err(CanvasError::Surface)));
    }

    #[test]
    fn text_ends_at_its_end_anchor() {
        let mut canvas = Canvas::new(200, 40).expect("page");
        let style = TextStyle::regular(16.0, INK);
        canvas.text("strike", (100.0, 25.0), Anchor::End, style);
        assert!(darkness(&canvas, 40..100, 0..40) > 1000);
        assert_eq!(darkness(&canvas, 101..200, 0..40), 0);
    }

    #[test]
    fn upward_text_lies_above_its_start_and_left_of_its_baseline() {
        let mut canvas = Canvas::new(60, 200).expect("page");
        let style = TextStyle::regular(16.0, INK);
        canvas.text_upwards("modes", (30.0, 150.0), Anchor::Start, style);
        assert!(darkness(&canvas, 0..31, 90..151) > 1000);
        assert_eq!(darkness(&canvas, 0..60, 151..200), 0);
        assert_eq!(darkness(&canvas, 31..60, 0..200), 0);
    }

    #[test]
    fn drawing_outside_the_page_changes_nothing() {
        let mut canvas = Canvas::new(20, 20).expect("page");
        canvas.pixel(20, 3, INK);
        canvas.disc((-50.0, 10.0), 5.0, INK);
        canvas.text("far", (500.0, 10.0), Anchor::Start, TextStyle::regular(12.0, INK));
        assert_eq!(darkness(&canvas, 0..20, 0..20), 0);
    }
}
