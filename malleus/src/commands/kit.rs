//! `malleus kit`: which command is run, and the commands `build` and `show`.

use std::path::Path;

use dsp_core::table::Kit;
use kit::Loaded;
use malleus::plot::{self, KitPicture, ObjectPicture};
use virtual_board::Board;

use super::error::CommandError;
use super::kit_report::{KitReport, counts, open};
use super::left_out::left_out;
use super::output::{has_extension, print, print_json, refuse_input};
use super::{kit_check, kit_new};
use crate::arguments::KitCommand;

pub(crate) fn run(command: &KitCommand) -> Result<(), CommandError> {
    match command {
        KitCommand::New { tables, output, first_note } => kit_new::run(tables, output.as_deref(), *first_note),
        KitCommand::Build { kit, output } => build(kit, output),
        KitCommand::Check { kit, rate, board, json } => kit_check::run(kit, *rate, *board, *json),
        KitCommand::Show { kit, plot, json } => show(kit, plot.as_deref(), *json),
    }
}

fn build(name: &str, output: &Path) -> Result<(), CommandError> {
    refuse_input(output, [Path::new(name)])?;
    if has_extension(output, "toml") {
        return Err(CommandError::BinaryAsText { output: output.to_owned() });
    }
    let loaded = open(name)?;
    let boards = on_boards(name, &loaded)?;
    kit::file::write_whole(output, &loaded.binary)?;
    let statistics = loaded.statistics();
    print(&format!("{}: {} bytes, {}\n{boards}", output.display(), statistics.bytes, counts(&loaded)))
}

/// Lines that say what each board would leave out of a kit; none for a table without pads, which no
/// board plays.
fn on_boards(name: &str, loaded: &Loaded) -> Result<String, CommandError> {
    if loaded.kit.pads.is_empty() {
        return Ok(String::new());
    }
    let table = Kit::parse(&loaded.binary).map_err(|error| CommandError::Table { kit: name.to_owned(), error })?;
    let lines = Board::ALL.into_iter().flat_map(|board| left_out(name, board, &table));
    Ok(lines.map(|line| line + "\n").collect())
}

fn show(name: &str, picture: Option<&Path>, json: bool) -> Result<(), CommandError> {
    let loaded = open(name)?;
    if let Some(path) = picture {
        refuse_input(path, [Path::new(name)])?;
        plot::kit(path, &picture_of(&loaded))?;
        eprintln!("malleus: {} drawn", path.display());
    }
    match json {
        true => print_json(&KitReport::of(name, &loaded)),
        false => print(&kit::text::write(&loaded.kit)),
    }
}

fn picture_of(loaded: &Loaded) -> KitPicture {
    let objects = loaded.kit.objects.iter().map(|object| ObjectPicture {
        name: object.name.clone(),
        modes: object
            .modes
            .iter()
            .map(|mode| {
                let loudest = mode.gains.iter().map(|gain| gain.sine.hypot(gain.cosine)).fold(0.0, f32::max);
                let t60_s = 1000f64.ln() / f64::from(mode.decay_per_s);
                (f64::from(mode.frequency_hz), t60_s, 20.0 * f64::from(loudest.max(1e-12)).log10())
            })
            .collect(),
        filter: object.dynamic_filter.as_ref().map_or(vec![], filter_curves),
        loops_hz: object
            .dynamic_filter
            .iter()
            .flat_map(|filter| &filter.loops)
            .map(|own| own.frequency_hz.into())
            .collect(),
        biquads: object.biquads.as_ref().map_or(vec![], |bank| curve(f64::from(bank.rate_hz), |hz| bank.magnitude(hz))),
    });
    KitPicture { title: loaded.kit.name.clone(), objects: objects.collect() }
}

/// Response |F| of the filter at each breakpoint, as (frequency in Hz, dB).
fn filter_curves(filter: &kit::DynamicFilter) -> Vec<Vec<(f64, f64)>> {
    let rate_hz = f64::from(filter.rate_hz);
    filter.path.iter().map(|point| curve(rate_hz, |hz| point.magnitude(hz, rate_hz))).collect()
}

/// Response as (frequency in Hz, dB), at 24 frequencies per octave from 20 Hz to half the rate.
fn curve(rate_hz: f64, magnitude: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let frequencies = (0..).map(|step| 20.0 * 2f64.powf(f64::from(step) / 24.0)).take_while(|&hz| hz < rate_hz / 2.0);
    frequencies.map(|hz| (hz, 20.0 * magnitude(hz).max(1e-12).log10())).collect()
}
