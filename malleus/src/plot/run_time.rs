//! Picture of run time against error: the cycles of kernels and their signal-to-noise ratios.

use std::path::Path;

use super::canvas::{Area, Canvas};
use super::colour::{Colour, DRIVEN, FRAME, MUTED, PAGE, WAVEFORM};
use super::error::PlotError;
use super::page;
use super::panel::{LABEL_TEXT, Panel, REMARK_TEXT, TITLE_TEXT, push_apart};
use super::scale::Scale;
use super::text::{Anchor, CAPITAL_HEIGHT, TextStyle};

/// Content of the picture of run time against error.
#[derive(Clone, Debug)]
pub struct RunTimePicture {
    /// Title above the diagram.
    pub title: String,
    /// Remark in a line below the title.
    pub remark: String,
    /// Kernels that are compared.
    pub kernels: Vec<KernelMark>,
}

/// Run time and error of one kernel.
#[derive(Clone, Debug)]
pub struct KernelMark {
    /// Name of the kernel.
    pub label: String,
    /// True if the kernel is this project's, and is drawn in the project's colour.
    pub ours: bool,
    /// Cycles per mode and sample: while ringing freely, and while driven by a force.
    pub cycles: (f64, f64),
    /// Signal-to-noise ratio in dB: the worst and the median.
    pub snr_db: (f64, f64),
}

const SIZE: (u32, u32) = (1300, 760);
const AREA: Area = Area { left: 90.0, top: 130.0, width: 800.0, height: 550.0 };
/// Distance of the kernels' names from the left of the page, in pixels.
const NAMES_PX: f32 = 935.0;
/// Least distance between the baselines of two names, in pixels.
const NAME_RISE_PX: f32 = 24.0;
const FREE_RADIUS_PX: f32 = 4.0;
const DRIVEN_RADIUS_PX: f32 = 6.5;
const MEDIAN_RADIUS_PX: f32 = 4.5;

/// Draws signal-to-noise ratio over cycles into a PNG file.
///
/// # Errors
/// [`PlotError`] with the path of the file, also for a picture without kernels.
pub fn run_time(path: &Path, picture: &RunTimePicture) -> Result<(), PlotError> {
    if picture.kernels.is_empty() {
        return Err(PlotError::Nothing { path: path.to_owned(), what: "kernel" });
    }
    let mut kernels: Vec<&KernelMark> = picture.kernels.iter().collect();
    // From the top down, and kernels of about equal height from right to left, so that few of the
    // lines to their names cross.
    let rounded_db = |kernel: &KernelMark| kernel.snr_db.0.round();
    kernels.sort_by(|a, b| rounded_db(b).total_cmp(&rounded_db(a)).then(b.cycles.1.total_cmp(&a.cycles.1)));
    let cycles = || kernels.iter().flat_map(|kernel| [kernel.cycles.0, kernel.cycles.1]);
    let low = cycles().fold(f64::INFINITY, f64::min);
    let high = cycles().fold(0.0, f64::max);
    let top = kernels.iter().map(|kernel| kernel.snr_db.1).fold(0.0, f64::max);
    let panel = Panel {
        area: AREA,
        x: Scale::logarithmic(low * 0.8, high * 1.15),
        y: Scale::linear(kernels.iter().map(|kernel| kernel.snr_db.0).fold(0.0, f64::min), top + 8.0),
    };
    let mut canvas = page::blank(path, SIZE.0, SIZE.1)?;
    canvas.text(&picture.title, (AREA.left, 46.0), Anchor::Start, TITLE_TEXT);
    canvas.text(&picture.remark, (AREA.left, 74.0), Anchor::Start, REMARK_TEXT);
    draw_key(&mut canvas);
    let (x_ticks, y_ticks) = (panel.x.ticks(AREA.width, 40.0), panel.y.ticks(AREA.height, 50.0));
    panel.vertical_grid(&mut canvas, &x_ticks);
    panel.horizontal_grid(&mut canvas, &y_ticks);
    for (kernel, name_px) in kernels.iter().zip(name_places(&panel, &kernels)) {
        draw_name(&mut canvas, &panel, kernel, name_px);
    }
    for kernel in &kernels {
        draw_kernel(&mut canvas, &panel, kernel);
    }
    panel.ticks_left(&mut canvas, &y_ticks);
    panel.ticks_below(&mut canvas, &x_ticks);
    panel.label_left(&mut canvas, "signal-to-noise ratio against f64 (dB)", 52.0);
    panel.label_below(&mut canvas, "cycles a mode and sample (Cortex-M4F, nominal)");
    panel.frame(&mut canvas);
    page::write(path, &canvas)
}

/// Heights of the kernels' names: the heights of the kernels themselves, pushed apart where they
/// are too close.
fn name_places(panel: &Panel, kernels: &[&KernelMark]) -> Vec<f32> {
    let mut places: Vec<f32> = kernels.iter().map(|kernel| panel.y_px(kernel.snr_db.0)).collect();
    push_apart(&mut places, NAME_RISE_PX, panel.area.bottom());
    places
}

fn draw_name(canvas: &mut Canvas, panel: &Panel, kernel: &KernelMark, name_px: f32) {
    let mark = (panel.x_px(kernel.cycles.1), panel.y_px(kernel.snr_db.0));
    let bend = (panel.area.right() + 8.0, name_px);
    canvas.line(&[mark, bend, (NAMES_PX - 8.0, name_px)], 1.0, None, FRAME);
    let style = TextStyle { colour: colour(kernel), ..LABEL_TEXT };
    let baseline = name_px + LABEL_TEXT.size_px * CAPITAL_HEIGHT / 2.0;
    canvas.text(&kernel.label, (NAMES_PX, baseline), Anchor::Start, style);
}

fn draw_kernel(canvas: &mut Canvas, panel: &Panel, kernel: &KernelMark) {
    let colour = colour(kernel);
    let (free, driven) = (panel.x_px(kernel.cycles.0), panel.x_px(kernel.cycles.1));
    let (worst, median) = (panel.y_px(kernel.snr_db.0), panel.y_px(kernel.snr_db.1));
    canvas.line(&[(free, worst), (driven, worst)], 2.0, None, colour);
    canvas.line(&[(driven, worst), (driven, median)], 1.0, Some([2.0, 3.0]), colour);
    canvas.disc((free, worst), FREE_RADIUS_PX, colour);
    canvas.disc((driven, worst), DRIVEN_RADIUS_PX, colour);
    ring(canvas, (driven, median), colour);
}

fn ring(canvas: &mut Canvas, place: (f32, f32), colour: Colour) {
    canvas.disc(place, MEDIAN_RADIUS_PX, colour);
    canvas.disc(place, MEDIAN_RADIUS_PX - 1.5, PAGE);
}

fn colour(kernel: &KernelMark) -> Colour {
    if kernel.ours { WAVEFORM } else { DRIVEN }
}

/// Draws the meaning of the marks above the diagram.
fn draw_key(canvas: &mut Canvas) {
    let baseline = AREA.top - 14.0;
    let middle = baseline - LABEL_TEXT.size_px * CAPITAL_HEIGHT / 2.0;
    let mut x = AREA.left;
    for (index, text) in
        ["worst SNR, ringing freely", "worst SNR, driven by a force", "median SNR"].into_iter().enumerate()
    {
        let place = (x + DRIVEN_RADIUS_PX, middle);
        match index {
            0 => canvas.disc(place, FREE_RADIUS_PX, MUTED),
            1 => canvas.disc(place, DRIVEN_RADIUS_PX, MUTED),
            _ => ring(canvas, place, MUTED),
        }
        x += 2.0 * DRIVEN_RADIUS_PX + 7.0;
        canvas.text(text, (x, baseline), Anchor::Start, LABEL_TEXT);
        x += canvas.length_px(text, LABEL_TEXT) + 28.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kernels(count: usize) -> Vec<KernelMark> {
        let mark = |_| KernelMark { label: "kernel".into(), ours: true, cycles: (5.0, 8.0), snr_db: (3.0, 60.0) };
        (0..count).map(mark).collect()
    }

    #[test]
    fn names_of_equal_kernels_stand_apart_and_on_the_page() {
        let kernels = kernels(12);
        let panel = Panel { area: AREA, x: Scale::logarithmic(4.0, 60.0), y: Scale::linear(0.0, 120.0) };
        let places = name_places(&panel, &kernels.iter().collect::<Vec<_>>());
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] >= LABEL_TEXT.size_px), "{places:?}");
        assert!(places.iter().all(|place| (0.0..SIZE.1 as f32 - 20.0).contains(place)), "{places:?}");
    }

    #[test]
    fn picture_without_kernels_is_refused() {
        let picture = RunTimePicture { title: String::new(), remark: String::new(), kernels: Vec::new() };
        assert!(matches!(run_time(Path::new("none.png"), &picture), Err(PlotError::Nothing { .. })));
    }
}
