//! Picture of a kit: for each object, the gains of its modes over frequency and the responses of
//! its filters. The colour of a mode is its T60.

use std::path::Path;

use kit::counting::counted;

use super::canvas::{Area, Canvas};
use super::colour::{Colour, DRIVEN, FRAME, VIRIDIS, WAVEFORM};
use super::error::PlotError;
use super::page;
use super::panel::{Panel, REMARK_TEXT, TICK_TEXT, TITLE_TEXT, heading, outline};
use super::scale::{Scale, Spacing};
use super::text::Anchor;

/// Picture of a kit, with one panel per object.
#[derive(Clone, Debug)]
pub struct KitPicture {
    /// Title above the panels.
    pub title: String,
    /// Objects, three panels per row.
    pub objects: Vec<ObjectPicture>,
}

/// Modes and filters of one object.
#[derive(Clone, Debug)]
pub struct ObjectPicture {
    /// Name of the object, the title of its panel.
    pub name: String,
    /// Modes as (frequency in Hz, T60 in s, gain in dB).
    pub modes: Vec<(f64, f64, f64)>,
    /// Response |F| of the dynamic filter at each breakpoint, as (frequency in Hz, dB).
    pub filter: Vec<Vec<(f64, f64)>>,
    /// Frequencies of the loops round the dynamic filter, in Hz.
    pub loops_hz: Vec<f64>,
    /// Response |H| of the biquads, as (frequency in Hz, dB).
    pub biquads: Vec<(f64, f64)>,
}

const COLUMNS: usize = 3;
const WIDTH: u32 = 1500;
const LEFT: f32 = 80.0;
const TOP: f32 = 120.0;
const CELL: (f32, f32) = (450.0, 280.0);
const PANEL: (f32, f32) = (360.0, 190.0);
/// Range of gains in a panel, in dB below the object's loudest mode; softer modes lie at its
/// bottom.
const RANGE_DB: f64 = 80.0;

/// Draws the modes and filters of a kit's objects into a PNG file, three panels per row.
///
/// # Errors
/// [`PlotError`] with the path of the file, also for a kit without modes and filters.
pub fn kit(path: &Path, picture: &KitPicture) -> Result<(), PlotError> {
    let t60: Vec<f64> = picture.objects.iter().flat_map(|object| object.modes.iter().map(|mode| mode.1)).collect();
    let is_empty = |object: &ObjectPicture| object.filter.is_empty() && object.biquads.is_empty();
    if t60.is_empty() && picture.objects.iter().all(is_empty) {
        return Err(PlotError::Nothing { path: path.to_owned(), what: "mode or filter" });
    }
    let (shortest, longest) =
        t60.iter().fold((f64::INFINITY, 0.0f64), |(low, high), &t60| (low.min(t60), high.max(t60)));
    let (shortest, longest) = if t60.is_empty() { (0.1, 10.0) } else { (shortest, longest) };
    let t60 = Scale::logarithmic_round(shortest, longest);
    let rows = picture.objects.len().div_ceil(COLUMNS);
    let mut canvas = page::blank(path, WIDTH, (TOP + rows as f32 * CELL.1 + 20.0) as u32)?;
    canvas.text(&picture.title, (LEFT, 46.0), Anchor::Start, TITLE_TEXT);
    let has_filters = !picture.objects.iter().all(is_empty);
    let more = match has_filters {
        true => "; blue: |F| of dynamic filters, darkest at the strike, loops as dotted lines; red: |H| of biquads",
        false => "",
    };
    canvas.text(
        &format!("modes: gain relative to the loudest (dB) over frequency (Hz){more}"),
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
        count => format!("{}, T60 {:.2} to {:.2} s", counted(count, "modes"), range.0, range.1),
    };
    let remark = format!("{remark}{}", filters_remark(object));
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
    draw_filters(canvas, &panel, object);
    panel.ticks_left(canvas, &y_ticks);
    panel.ticks_below(canvas, &x_ticks);
    panel.frame(canvas);
}

fn filters_remark(object: &ObjectPicture) -> String {
    let mut remark = String::new();
    match (object.filter.len(), object.loops_hz.len()) {
        (0, _) => {}
        (_, 0) => remark += ", dynamic filter",
        (_, loops) => remark += &format!(", dynamic filter with {}", counted(loops, "loops")),
    }
    if !object.biquads.is_empty() {
        remark += ", biquads";
    }
    remark
}

/// Draws the responses of the filters, those of each kind relative to the largest value of the
/// kind.
fn draw_filters(canvas: &mut Canvas, panel: &Panel, object: &ObjectPicture) {
    let largest =
        |curves: &[Vec<(f64, f64)>]| curves.iter().flatten().map(|point| point.1).fold(f64::NEG_INFINITY, f64::max);
    let line = |curve: &[(f64, f64)], top: f64| -> Vec<(f32, f32)> {
        let seen = curve.iter().filter(|(hz, _)| (20.0..=20_000.0).contains(hz));
        seen.map(|&(hz, db)| (panel.x_px(hz), panel.y_px((db - top).clamp(-RANGE_DB, 5.0)))).collect()
    };
    for &hz in object.loops_hz.iter().filter(|hz| (20.0..=20_000.0).contains(*hz)) {
        let x = panel.x_px(hz);
        canvas.line(&[(x, panel.area.top), (x, panel.area.bottom())], 1.0, Some([2.0, 3.0]), WAVEFORM);
    }
    let top = largest(&object.filter);
    for (index, curve) in object.filter.iter().enumerate().rev() {
        // A filter with b0 = 0 is silent and has no response to draw.
        if largest(std::slice::from_ref(curve)) > top - RANGE_DB {
            let share = index as f32 / object.filter.len() as f32;
            let colour = Colour { opacity: (255.0 - 190.0 * share) as u8, ..WAVEFORM };
            canvas.line(&line(curve, top), 1.6, None, colour);
        }
    }
    let biquads = std::slice::from_ref(&object.biquads);
    canvas.line(&line(&object.biquads, largest(biquads)), 1.6, None, DRIVEN);
}

/// Draws the scale of the colours of T60 at the top right.
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
