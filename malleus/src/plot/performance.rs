//! Picture of a performance over time: strikes, waveform, spectrogram, active modes and stages.

use std::path::Path;

use kit::counting::counted;

use super::canvas::{Area, Canvas};
use super::colour::{ACCELERATION, Colour, DIRECT, DRIVEN, FRAME, FREE, INK, LANE, MAGMA, STRIKER, WAVEFORM};
use super::error::PlotError;
use super::page;
use super::panel::{BUILT_DASH, LABEL_TEXT, Panel, REMARK_TEXT, Sign, TICK_TEXT, TITLE_TEXT, heading, legend, outline};
use super::scale::{Scale, in_minutes};
use super::spectrogram::{FLOOR_DB, HIGHEST_HZ, LOWEST_HZ, Spectrogram};
use super::text::Anchor;

/// Content of the picture of a performance.
#[derive(Clone, Copy, Debug)]
pub struct Performance<'a> {
    /// Title above the panels.
    pub title: &'a str,
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// Samples of the left channel, 1.0 = full scale.
    pub left: &'a [f32],
    /// Samples of the right channel, 1.0 = full scale, as many as of the left.
    pub right: &'a [f32],
    /// Length of a tick in seconds.
    pub seconds_per_tick: f64,
    /// Work of each tick, in order.
    pub ticks: &'a [TickRow],
    /// Number of modes that the engine built.
    pub built_modes: u32,
    /// Names of the pads, one lane each.
    pub pads: &'a [String],
    /// Strikes of the performance.
    pub strikes: &'a [StrikeMark],
}

/// Work of one tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct TickRow {
    /// Number of modes that a force drives, mean over the tick.
    pub driven_modes: f32,
    /// Number of modes that ring without a force, mean over the tick.
    pub free_modes: f32,
    /// Number of contacts under way at the end of the tick.
    pub contacts: u32,
    /// True if a contact made a force.
    pub contact: bool,
    /// True if a striker's own bank ran.
    pub striker_bank: bool,
    /// True if an acceleration sound was made.
    pub acceleration: bool,
    /// True if a force drove a pad directly.
    pub direct: bool,
}

/// Mark of one strike.
#[derive(Clone, Copy, Debug)]
pub struct StrikeMark {
    /// Time of the strike in seconds.
    pub time_s: f64,
    /// Index of the struck pad in [`Performance::pads`].
    pub pad: usize,
    /// Velocity of the strike, 0 to 1; the height of its mark.
    pub velocity: f32,
}

const WIDTH: u32 = 1600;
const LEFT: f32 = 120.0;
const PLOT_WIDTH: f32 = 1370.0;
const LANE_PX: f32 = 17.0;
const GAP_PX: f32 = 42.0;

/// Draws a performance and gives the bytes of a PNG file for `path`, 1600 pixels wide and about
/// 1300 high.
///
/// # Errors
/// [`PlotError`] with the path of the file, also for a performance without samples.
pub fn performance_png(path: &Path, performance: &Performance<'_>) -> Result<Vec<u8>, PlotError> {
    let frames = performance.left.len().min(performance.right.len());
    if frames == 0 {
        return Err(PlotError::Nothing { path: path.to_owned(), what: "sample" });
    }
    let duration_s = frames as f64 / performance.rate_hz;
    let lanes_px = LANE_PX * performance.pads.len().max(1) as f32;
    let heights = [lanes_px, 170.0, 330.0, 200.0, LANE_PX * 4.0];
    let height = 100.0 + heights.iter().sum::<f32>() + GAP_PX * 4.0 + 60.0;
    let mut canvas = page::blank(path, WIDTH, height as u32)?;
    canvas.text(performance.title, (LEFT, 46.0), Anchor::Start, TITLE_TEXT);
    let strikes = counted(performance.strikes.len(), "strikes");
    let remark = format!("{duration_s:.1} s at {:.0} Hz, {strikes}", performance.rate_hz);
    canvas.text(&remark, (LEFT + PLOT_WIDTH, 46.0), Anchor::End, REMARK_TEXT);

    let mut top = 100.0;
    let mut areas = heights.map(|height| {
        let area = Area { left: LEFT, top, width: PLOT_WIDTH, height };
        top += height + GAP_PX;
        area
    });
    // The lanes of the lowest panel are drawn pixel by pixel.
    areas[4].top = areas[4].top.round();
    let time = Scale::linear(0.0, duration_s);
    draw_strikes(&mut canvas, areas[0], time, performance);
    draw_waveform(&mut canvas, areas[1], time, performance);
    draw_spectrogram(&mut canvas, areas[2], time, performance);
    draw_modes(&mut canvas, areas[3], time, performance);
    let last = draw_stages(&mut canvas, areas[4], time, performance);
    last.ticks_below(&mut canvas, &time.time_ticks(PLOT_WIDTH, 90.0));
    last.label_below(&mut canvas, if in_minutes(duration_s) { "time (min:s)" } else { "time (s)" });
    page::png(path, &canvas)
}

/// Draws one lane per pad with a line for each strike, as high as its velocity.
fn draw_strikes(canvas: &mut Canvas, area: Area, time: Scale, performance: &Performance<'_>) {
    let panel = Panel { area, x: time, y: Scale::linear(0.0, 1.0) };
    let count = performance.pads.len().max(1);
    draw_lanes(canvas, area, count);
    heading(canvas, area, "Strikes", "height: velocity");
    for (index, name) in performance.pads.iter().enumerate() {
        let lane = area.lane(index, count);
        let baseline = lane.bottom() - 4.0;
        let name = canvas.shortened(name, LABEL_TEXT, LEFT - 14.0);
        canvas.text(&name, (area.left - 8.0, baseline), Anchor::End, LABEL_TEXT);
    }
    for strike in performance.strikes.iter().filter(|strike| strike.pad < count) {
        let lane = area.lane(strike.pad, count);
        let height = (lane.height - 2.0) * strike.velocity.clamp(0.06, 1.0);
        let mark = Area { left: panel.x_px(strike.time_s), top: lane.bottom() - height, width: 2.0, height };
        canvas.rectangle(mark, DRIVEN);
    }
    outline(canvas, area, FRAME);
}

fn draw_lanes(canvas: &mut Canvas, area: Area, count: usize) {
    for lane in (0..count).step_by(2) {
        canvas.rectangle(area.lane(lane, count), LANE);
    }
}

/// Draws the smallest and largest sample of each column of pixels, the left channel above the
/// right.
fn draw_waveform(canvas: &mut Canvas, area: Area, time: Scale, performance: &Performance<'_>) {
    heading(canvas, area, "Waveform", "");
    for (index, (name, samples)) in [("left", performance.left), ("right", performance.right)].into_iter().enumerate() {
        let panel = Panel { area: area.lane(index, 2), x: time, y: Scale::linear(-1.0, 1.0) };
        let per_column = samples.len() as f64 / f64::from(area.width);
        let middle = panel.y_px(0.0);
        canvas.horizontal(area.left, area.right(), middle, FRAME);
        for column in 0..area.width as usize {
            let from = (column as f64 * per_column) as usize;
            let to = (((column + 1) as f64 * per_column) as usize).clamp(from + 1, samples.len().max(from + 1));
            let span = samples.get(from..to).unwrap_or(&[]);
            let (low, high) =
                span.iter().fold((0.0f32, 0.0f32), |(low, high), &sample| (low.min(sample), high.max(sample)));
            if low != high {
                let top = panel.y_px(f64::from(high));
                let height = (panel.y_px(f64::from(low)) - top).max(1.0);
                canvas.rectangle(Area { left: area.left + column as f32, top, width: 1.0, height }, WAVEFORM);
            }
        }
        outline(canvas, panel.area, FRAME);
        canvas.text(name, (area.left - 8.0, middle + 5.0), Anchor::End, LABEL_TEXT);
        for (value, label) in [(0.9, "1"), (-0.9, "−1")] {
            canvas.text(label, (area.right() + 8.0, panel.y_px(value) + 5.0), Anchor::Start, TICK_TEXT);
        }
    }
}

fn draw_spectrogram(canvas: &mut Canvas, area: Area, time: Scale, performance: &Performance<'_>) {
    let panel = Panel { area, x: time, y: Scale::logarithmic(LOWEST_HZ, HIGHEST_HZ) };
    heading(canvas, area, "Spectrogram", "the louder channel, dB relative to a full-scale sine");
    let (columns, rows) = (area.width as usize, area.height as usize);
    let channels = [performance.left, performance.right];
    let levels = Spectrogram::of(&channels, performance.rate_hz, columns, rows);
    for column in 0..levels.columns() {
        for row in 0..levels.rows() {
            let level = levels.level_db(column, row).unwrap_or(FLOOR_DB);
            let y = (area.bottom() as u32).saturating_sub(1 + row as u32);
            canvas.pixel(area.left as u32 + column as u32, y, MAGMA.colour(1.0 - level / FLOOR_DB));
        }
    }
    panel.ticks_left(canvas, &panel.y.ticks(area.height, 40.0));
    panel.label_left(canvas, "frequency (Hz)", 70.0);
    panel.frame(canvas);
    let bar = Area { left: area.right() + 14.0, width: 16.0, ..area };
    for row in 0..rows {
        let share = 1.0 - row as f32 / rows as f32;
        canvas.rectangle(Area { top: bar.top + row as f32, height: 1.0, ..bar }, MAGMA.colour(share));
    }
    let scale = Panel { area: bar, x: time, y: Scale::linear(f64::from(FLOOR_DB), 0.0) };
    for tick in scale.y.ticks(bar.height, 60.0) {
        let y = scale.y_px(tick.value).clamp(bar.top + 8.0, bar.bottom());
        canvas.text(&tick.label, (bar.right() + 6.0, y + 4.0), Anchor::Start, TICK_TEXT);
    }
    outline(canvas, bar, FRAME);
}

/// Draws the driven and the free modes of the busiest tick in each column of pixels, stacked, under
/// a line at the number of modes that were built.
fn draw_modes(canvas: &mut Canvas, area: Area, time: Scale, performance: &Performance<'_>) {
    let built = f64::from(performance.built_modes.max(1));
    let panel = Panel { area, x: time, y: Scale::linear(0.0, built * 1.08) };
    heading(canvas, area, "Active modes", "what is below the line was built and did not run");
    let entries = [(Sign::Fill(DRIVEN), "driven"), (Sign::Fill(FREE), "ringing freely"), (Sign::Dashed(INK), "built")];
    legend(canvas, area, &entries);
    let ticks = panel.y.ticks(area.height, 36.0);
    panel.horizontal_grid(canvas, &ticks);
    for column in 0..area.width as usize {
        let Some(busiest) = column_ticks(performance, area, column)
            .iter()
            .max_by(|a, b| (a.driven_modes + a.free_modes).total_cmp(&(b.driven_modes + b.free_modes)))
        else {
            continue;
        };
        let all = panel.y_px(f64::from(busiest.driven_modes + busiest.free_modes));
        let free = panel.y_px(f64::from(busiest.free_modes));
        let left = area.left + column as f32;
        canvas.rectangle(Area { left, top: all, width: 1.0, height: free - all }, DRIVEN);
        canvas.rectangle(Area { left, top: free, width: 1.0, height: area.bottom() - free }, FREE);
    }
    let line = panel.y_px(built);
    canvas.line(&[(area.left, line), (area.right(), line)], 1.5, Some(BUILT_DASH), INK);
    panel.ticks_left(canvas, &ticks);
    panel.label_left(canvas, "modes", 70.0);
    panel.frame(canvas);
}

fn column_ticks<'a>(performance: &Performance<'a>, area: Area, column: usize) -> &'a [TickRow] {
    let seconds = performance.left.len() as f64 / performance.rate_hz;
    let tick_at =
        |column: usize| (column as f64 / f64::from(area.width) * seconds / performance.seconds_per_tick) as usize;
    let from = tick_at(column);
    performance.ticks.get(from..tick_at(column + 1).max(from + 1).min(performance.ticks.len())).unwrap_or(&[])
}

/// Draws one lane per stage, coloured at the times when the stage ran.
fn draw_stages(canvas: &mut Canvas, area: Area, time: Scale, performance: &Performance<'_>) -> Panel {
    type Stage = (&'static str, Colour, fn(&TickRow) -> bool);
    const STAGES: [Stage; 4] = [
        ("contact", DRIVEN, |tick| tick.contact),
        ("striker bank", STRIKER, |tick| tick.striker_bank),
        ("acceleration", ACCELERATION, |tick| tick.acceleration),
        ("direct force", DIRECT, |tick| tick.direct),
    ];
    heading(canvas, area, "Stages", "coloured where they ran");
    draw_lanes(canvas, area, STAGES.len());
    for (index, (name, colour, ran)) in STAGES.into_iter().enumerate() {
        let lane = area.lane(index, STAGES.len());
        canvas.text(name, (area.left - 8.0, lane.bottom() - 4.0), Anchor::End, LABEL_TEXT);
        for column in 0..area.width as usize {
            if column_ticks(performance, area, column).iter().any(ran) {
                let mark = Area {
                    left: lane.left + column as f32,
                    top: lane.top + 3.0,
                    width: 1.0,
                    height: lane.height - 6.0,
                };
                canvas.rectangle(mark, colour);
            }
        }
    }
    let panel = Panel { area, x: time, y: Scale::linear(0.0, 1.0) };
    panel.frame(canvas);
    panel
}
