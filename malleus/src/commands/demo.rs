//! `malleus demo`: the demo piece as sound and picture, and each pad against the `f64` reference.

use std::path::Path;
use std::time::Instant;

use dsp_core::engine::{Setup, Skipping, TickReport};
use dsp_core::fixed::{FULL_SCALE_24_BIT, ONE_Q27};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit;
use dsp_core::voice::{PadTables, VoiceSize};
use kit::Loaded;
use malleus::demo::{self, RATE};
use malleus::plot::{self, StrikeMark, TickRow};
use malleus::render::instrument::{Output, RenderError, Settings};
use malleus::render::{Performance, instrument, reference};
use malleus::wave;
use serde::Serialize;

use super::error::CommandError;
use super::output::{peak_dbfs, print, print_json, progress};
use crate::arguments::DemoArguments;

const SETTINGS: Settings = Settings { setup: Setup::new(RATE), block: 128, budget_cycles: None };

pub(crate) fn run(arguments: &DemoArguments) -> Result<(), CommandError> {
    let loaded = kit::open(demo::KIT)?;
    let table = Kit::parse(&loaded.binary).map_err(|error| CommandError::Table { kit: demo::KIT.to_owned(), error })?;
    let performance = demo::piece(&table, &loaded.kit)?;
    std::fs::create_dir_all(&arguments.out).map_err(|cause| {
        CommandError::File(kit::file::FileError { action: "made", path: arguments.out.clone(), cause })
    })?;
    let [sound, picture] = ["demo.wav", "demo.png"].map(|name| arguments.out.join(name));
    [&sound, &picture].into_iter().try_for_each(|path| kit::file::check_writable(path))?;
    let bar = progress(2 + loaded.kit.pads.len() as u64, "demo");

    let started = Instant::now();
    let mut ticks = Vec::new();
    let frames = instrument::render(&table, &performance, SETTINGS, Output::Samples24, |report| {
        ticks.push(*report);
    })
    .map_err(refused)?;
    let render_s = started.elapsed().as_secs_f64();
    let sound_bytes = wave::stereo_bytes(&sound, RATE.hz(), &frames)?;
    bar.inc(1);
    let picture_bytes = draw(&picture, &loaded, &performance, &frames, &ticks)?;
    kit::file::write_together(&[(&sound, &sound_bytes), (&picture, &picture_bytes)])?;
    bar.inc(1);

    let mut rows = Vec::new();
    for pad in (0u8..=254).take(loaded.kit.pads.len()) {
        bar.set_message("against the reference");
        rows.push(row(&loaded, &table, &performance, pad)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let duration_s = performance.frames as f64 / RATE.hz();
    let report = DemoReport {
        sound: &sound,
        picture: &picture,
        rate_hz: RATE.hz(),
        duration_s,
        peak_dbfs: peak_dbfs(&frames),
        times_real_time_on_one_core: duration_s / render_s,
        pads: rows,
    };
    if arguments.json { print_json(&report) } else { print(&report.text()) }
}

fn refused(error: RenderError) -> CommandError {
    CommandError::Render { kit: demo::KIT.to_owned(), error }
}

#[derive(Debug, Serialize)]
struct DemoReport<'a> {
    sound: &'a Path,
    picture: &'a Path,
    rate_hz: f64,
    duration_s: f64,
    peak_dbfs: Option<f64>,
    times_real_time_on_one_core: f64,
    pads: Vec<PadRow>,
}

#[derive(Debug, Serialize)]
struct PadRow {
    pad: String,
    modes: usize,
    shortest_t60_s: f64,
    longest_t60_s: f64,
    peak_dbfs: Option<f64>,
    /// SNR of the bus against the `f64` reference in dB, with skipping off.
    snr_db: f64,
    /// Largest difference on the bus that skipping makes; `None` if it makes none.
    skipping_error_dbfs: Option<f64>,
    skipped_share_of_work: f64,
}

impl DemoReport<'_> {
    fn text(&self) -> String {
        let mut text = format!(
            "{:<14} {:>5} {:>17} {:>10} {:>14} {:>14} {:>13}\n",
            "pad", "modes", "T60", "peak", "to reference", "skipping adds", "work skipped"
        );
        for row in &self.pads {
            let dbfs = |level: Option<f64>| level.map_or("none".to_owned(), |level| format!("{level:.1} dBFS"));
            text.push_str(&format!(
                "{:<14} {:>5} {:>17} {:>10} {:>14} {:>14} {:>12.1}%\n",
                row.pad,
                row.modes,
                format!("{:.2} to {:.2} s", row.shortest_t60_s, row.longest_t60_s),
                dbfs(row.peak_dbfs),
                format!("{:.1} dB", row.snr_db),
                dbfs(row.skipping_error_dbfs),
                100.0 * row.skipped_share_of_work,
            ));
        }
        text.push_str(&format!(
            "\n{}: {:.1} s, rendered at {:.0} times real time on one core\n{}: waveform, spectrogram, modes and stages over time\n",
            self.sound.display(),
            self.duration_s,
            self.times_real_time_on_one_core,
            self.picture.display()
        ));
        text
    }
}

/// Renders one pad's part of the piece by the instrument, with and without skipping, and by the
/// `f64` reference, and compares them.
fn row(loaded: &Loaded, table: &Kit<'_>, performance: &Performance, pad: u8) -> Result<PadRow, CommandError> {
    let solo = demo::solo(performance, pad);
    let render = |skipping, output| {
        let mut work = (0u64, 0u64);
        let settings = Settings { setup: Setup { skipping, ..SETTINGS.setup }, ..SETTINGS };
        let frames = instrument::render(table, &solo, settings, output, |report| {
            let run = u64::from(report.run_mode_frames());
            work.0 += run;
            work.1 += run + u64::from(report.decayed_mode_frames) + u64::from(report.unstruck_mode_frames);
        });
        frames.map(|frames| (frames, work)).map_err(refused)
    };
    let (skipped, (run, _)) = render(Skipping::On, Output::Bus)?;
    let (whole, _) = render(Skipping::Off, Output::Bus)?;
    let (samples, _) = render(Skipping::On, Output::Samples24)?;
    let expected = reference::render(&loaded.kit, &solo, RATE, |_| {})
        .map_err(|error| CommandError::Reference { kit: demo::KIT.to_owned(), error })?;

    let modes = PadTables::new(*table, usize::from(pad))
        .and_then(|tables| VoiceSize::new(&tables, RATE).ok())
        .map_or(0, |size| size.modes());
    let built = (modes * solo.frames) as u64;
    let t60 = t60_range(&loaded.kit, usize::from(pad));
    Ok(PadRow {
        pad: loaded.kit.pads[usize::from(pad)].name.clone(),
        modes,
        shortest_t60_s: t60.0,
        longest_t60_s: t60.1,
        peak_dbfs: peak_dbfs(&samples),
        snr_db: snr_db(&expected, &whole),
        skipping_error_dbfs: largest_difference_dbfs(&whole, &skipped),
        skipped_share_of_work: 1.0 - run as f64 / built.max(1) as f64,
    })
}

fn snr_db(expected: &[[f64; 2]], bus: &[[i32; 2]]) -> f64 {
    let (mut signal, mut noise) = (0.0, 0.0);
    for (expected, &got) in expected.iter().flatten().zip(bus.iter().flatten()) {
        let difference = f64::from(got) / f64::from(ONE_Q27) - expected;
        signal += expected * expected;
        noise += difference * difference;
    }
    10.0 * (signal / noise).log10()
}

fn largest_difference_dbfs(a: &[[i32; 2]], b: &[[i32; 2]]) -> Option<f64> {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    let largest = pairs.map(|(&a, &b)| i64::from(a).abs_diff(i64::from(b))).max().unwrap_or(0);
    (largest > 0).then(|| 20.0 * (largest as f64 / f64::from(ONE_Q27)).log10())
}

/// Shortest and longest T60 of the modes of a pad's object, in seconds.
fn t60_range(kit: &kit::Kit, pad: usize) -> (f64, f64) {
    let object = kit.pads.get(pad).and_then(|pad| kit.objects.iter().find(|object| object.name == pad.object));
    let modes = object.map_or(&[][..], |object| &object.modes);
    let t60 = modes.iter().map(|mode| 1000f64.ln() / f64::from(mode.decay_per_s));
    t60.fold((f64::INFINITY, 0.0), |(shortest, longest): (f64, f64), t60| (shortest.min(t60), longest.max(t60)))
}

/// Draws the piece for the PNG file at a path.
fn draw(
    path: &Path,
    loaded: &Loaded,
    performance: &Performance,
    frames: &[[i32; 2]],
    ticks: &[TickReport],
) -> Result<Vec<u8>, CommandError> {
    let channel = |side: usize| -> Vec<f32> {
        frames.iter().map(|frame| frame[side] as f32 / FULL_SCALE_24_BIT as f32).collect()
    };
    let (left, right) = (channel(0), channel(1));
    let pads: Vec<String> = loaded.kit.pads.iter().map(|pad| pad.name.clone()).collect();
    let strikes: Vec<StrikeMark> = performance
        .events
        .iter()
        .filter(|event| event.action == dsp_core::event::Action::Strike)
        .map(|event| StrikeMark {
            time_s: event.time.first_frame() as f64 / RATE.hz(),
            pad: usize::from(event.pad),
            velocity: event.velocity,
        })
        .collect();
    let built =
        ticks.first().map_or(0, |tick| tick.run_mode_frames() + tick.decayed_mode_frames + tick.unstruck_mode_frames);
    let rows: Vec<TickRow> = ticks.iter().map(tick_row).collect();
    let bytes = plot::performance_png(
        path,
        &plot::Performance {
            title: "malleus demo",
            rate_hz: RATE.hz(),
            left: &left,
            right: &right,
            seconds_per_tick: TICK_FRAMES as f64 / RATE.hz(),
            ticks: &rows,
            built_modes: built / TICK_FRAMES as u32,
            pads: &pads,
            strikes: &strikes,
        },
    )?;
    Ok(bytes)
}

fn tick_row(report: &TickReport) -> TickRow {
    let modes = |mode_frames: u32| mode_frames as f32 / TICK_FRAMES as f32;
    TickRow {
        driven_modes: modes(report.driven_mode_frames),
        free_modes: modes(report.free_mode_frames),
        contacts: report.contacts,
        contact: report.contact_frames > 0,
        striker_bank: report.striker_mode_frames > 0,
        acceleration: report.acceleration_frames > 0,
        direct: report.direct_frames > 0,
    }
}
