//! A kit's modes: for each object, gain over frequency, coloured by how long they ring.

use std::path::Path;

use super::canvas::{Area, Canvas};
use super::colour::{FRAME, VIRIDIS};
use super::error::PlotError;
use super::page;
use super::panel::{Panel, REMARK_TEXT, TICK_TEXT, TITLE_TEXT, heading, outline};
use super::scale::{Scale, Spacing};
use super::text::Anchor;

/// What is drawn.
#[derive(Clone, Debug)]
pub struct KitPicture {
    /// Title of the picture.
    pub title: String,
    /// The objects.
    pub objects: Vec<ObjectPicture>,
}

/// One object.
#[derive(Clone, Debug)]
pub struct ObjectPicture {
    /// Its name.
    pub name: String,
    /// Its modes: (frequency in Hz, T60 in s, gain in dB).
    pub modes: Vec<(f64, f64, f64)>,
}

const COLUMNS: usize = 3;
const WIDTH: u32 = 1500;
const LEFT: f32 = 80.0;
const TOP: f32 = 120.0;
const CELL: (f32, f32) = (450.0, 280.0);
const PANEL: (f32, f32) = (360.0, 190.0);
/// Modes more than this below an object's loudest end at the bottom of its panel.
const RANGE_DB: f64 = 80.0;

/// Draws the modes of a kit's objects, three panels a row.
///
/// # Errors
/// [`PlotError`], naming the file.
pub fn kit(path: &Path, picture: &KitPicture) -> Result<(), PlotError> {
    let t60: Vec<f64> = picture.objects.iter().flat_map(|object| object.modes.iter().map(|mode| mode.1)).collect();
    if t60.is_empty() {
        return Err(PlotError::Nothing { path: path.to_owned(), what: "mode" });
    }
    let (shortest, longest) =
        t60.iter().fold((f64::INFINITY, 0.0f64), |(low, high), &t60| (low.min(t60), high.max(t60)));
    let t60 = Scale::logarithmic_round(shortest, longest);
    let rows = picture.objects.len().div_ceil(COLUMNS);
    let mut canvas = page::blank(path, WIDTH, (TOP + rows as f32 * CELL.1 + 20.0) as u32)?;
    canvas.text(&picture.title, (LEFT, 46.0), Anchor::Start, TITLE_TEXT);
    canvas.text(
        "modes: gain relative to the loudest (dB) over frequency (Hz)",
        (LEFT, 72.0),
        Anchor::Start,
        REMARK_TEXT,
    );
    draw_colours(&mut canvas, t60);
    for (index, object) in picture.objects.iter().enumerate() {
        let area = Area {
            left: LEFT + (index % COLUMNS) as f32 * CELL.0 + 20.0,
            top: TOP + (index / COLUMNS) as f32 * CELL.1 + 20.0,
            width: PANEL.0,
            height: PANEL.1,
        };
        draw_object(&mut canvas, area, object, t60);
    }
    page::write(path, &canvas)
}

fn draw_object(canvas: &mut Canvas, area: Area, object: &ObjectPicture, t60: Scale) {
    let panel = Panel { area, x: Scale::logarithmic(20.0, 20_000.0), y: Scale::linear(-RANGE_DB, 5.0) };
    let range =
        object.modes.iter().fold((f64::INFINITY, 0.0f64), |(low, high), mode| (low.min(mode.1), high.max(mode.1)));
    let remark = match object.modes.len() {
        0 => "no modes".to_owned(),
        count => format!("{count} modes, T60 {:.2} to {:.2} s", range.0, range.1),
    };
    heading(canvas, area, &object.name, &remark);
    let (x_ticks, y_ticks) = (panel.x.ticks(area.width, 60.0), panel.y.ticks(area.height, 40.0));
    panel.vertical_grid(canvas, &x_ticks);
    panel.horizontal_grid(canvas, &y_ticks);
    let loudest = object.modes.iter().map(|mode| mode.2).fold(f64::NEG_INFINITY, f64::max);
    for &(frequency_hz, mode_t60, gain_db) in &object.modes {
        if !(20.0..=20_000.0).contains(&frequency_hz) {
            continue;
        }
        let colour = VIRIDIS.colour(t60.share(mode_t60) as f32);
        let (x, y) = (panel.x_px(frequency_hz), panel.y_px((gain_db - loudest).max(-RANGE_DB)));
        canvas.rectangle(Area { left: x - 1.0, top: y, width: 2.0, height: area.bottom() - y }, colour);
        canvas.disc((x, y), 3.5, colour);
    }
    panel.ticks_left(canvas, &y_ticks);
    panel.ticks_below(canvas, &x_ticks);
    panel.frame(canvas);
}

/// The colours of T60, at the top right.
fn draw_colours(canvas: &mut Canvas, t60: Scale) {
    let bar = Area { left: WIDTH as f32 - 420.0, top: 40.0, width: 340.0, height: 14.0 };
    for column in 0..bar.width as usize {
        let colour = VIRIDIS.colour(column as f32 / bar.width);
        canvas.rectangle(Area { left: bar.left + column as f32, width: 1.0, ..bar }, colour);
    }
    outline(canvas, bar, FRAME);
    debug_assert_eq!(t60.spacing, Spacing::Logarithmic);
    let panel = Panel { area: bar, x: t60, y: Scale::linear(0.0, 1.0) };
    panel.ticks_below(canvas, &t60.ticks(bar.width, 50.0));
    canvas.text("T60 (s)", (bar.left - 12.0, bar.bottom() - 2.0), Anchor::End, TICK_TEXT);
}
