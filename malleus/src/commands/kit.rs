//! `malleus kit build` and `show`; what all of `malleus kit` share.

use std::path::Path;

use dsp_core::table::Kit;
use kit::{BankStatistics, Loaded};
use malleus::plot::{self, KitPicture, ObjectPicture};
use serde::Serialize;
use virtual_board::Board;

use super::{CommandError, kit_check, kit_new, left_out, print, print_json};
use crate::KitCommand;

pub(crate) fn run(command: &KitCommand) -> Result<(), CommandError> {
    match command {
        KitCommand::New { tables, output, first_note } => kit_new::run(tables, output.as_deref(), *first_note),
        KitCommand::Build { kit, output } => build(kit, output),
        KitCommand::Check { kit, rate, json } => kit_check::run(kit, *rate, *json),
        KitCommand::Show { kit, plot, json } => show(kit, plot.as_deref(), *json),
    }
}

fn build(name: &str, output: &Path) -> Result<(), CommandError> {
    let loaded = open(name)?;
    let boards = on_boards(name, &loaded)?;
    kit::file::write_whole(output, &loaded.binary)?;
    let statistics = loaded.statistics();
    print(&format!("{}: {} bytes, {}\n{boards}", output.display(), statistics.bytes, counts(&loaded)))
}

/// What each board would leave out of a kit, in lines; tables without pads are for no board.
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
        plot::kit(path, &picture_of(&loaded))?;
        eprintln!("malleus: {} drawn", path.display());
    }
    match json {
        true => print_json(&KitReport::of(name, &loaded)),
        false => print(&kit::text::write(&loaded.kit)),
    }
}

pub(super) fn open(name: &str) -> Result<Loaded, CommandError> {
    let loaded = kit::open(name)?;
    for tag in &loaded.skipped_sections {
        eprintln!("malleus: {name}: section {tag} is unknown to this version and was left out");
    }
    Ok(loaded)
}

pub(super) fn counts(loaded: &Loaded) -> String {
    let statistics = loaded.statistics();
    let modes: usize = statistics.objects.iter().chain(&statistics.strikers).map(|bank| bank.modes).sum();
    let kit = &loaded.kit;
    let (pads, objects, strikers) = (kit.pads.len(), kit.objects.len(), kit.strikers.len());
    let mut counts = format!("{pads} pads, {objects} objects, {strikers} strikers, {modes} modes");
    let all = |count: fn(&BankStatistics) -> usize| statistics.objects.iter().map(count).sum::<usize>();
    for (count, what) in [
        (all(|object| usize::from(object.breakpoints > 0)), "dynamic filters"),
        (all(|object| object.loops), "loops"),
        (all(|object| object.biquads), "biquads"),
    ] {
        if count > 0 {
            counts += &format!(", {count} {what}");
        }
    }
    counts
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

/// |F| at each breakpoint.
fn filter_curves(filter: &kit::DynamicFilter) -> Vec<Vec<(f64, f64)>> {
    let rate_hz = f64::from(filter.rate_hz);
    filter.path.iter().map(|point| curve(rate_hz, |hz| point.magnitude(hz, rate_hz))).collect()
}

/// A magnitude in dB at 24 frequencies an octave from 20 Hz up to half the rate.
fn curve(rate_hz: f64, magnitude: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let frequencies = (0..).map(|step| 20.0 * 2f64.powf(f64::from(step) / 24.0)).take_while(|&hz| hz < rate_hz / 2.0);
    frequencies.map(|hz| (hz, 20.0 * magnitude(hz).max(1e-12).log10())).collect()
}

#[derive(Debug, Serialize)]
pub(super) struct KitReport<'a> {
    kit: &'a str,
    name: &'a str,
    binary_bytes: usize,
    modes_bytes: usize,
    pads: Vec<&'a str>,
    objects: Vec<BankReport>,
    strikers: Vec<BankReport>,
    skipped_sections: &'a [String],
}

#[derive(Debug, Serialize)]
struct BankReport {
    name: String,
    modes: usize,
    positions: usize,
    lowest_frequency_hz: Option<f32>,
    highest_frequency_hz: Option<f32>,
    shortest_t60_s: Option<f32>,
    longest_t60_s: Option<f32>,
    breakpoints: usize,
    loops: usize,
    biquads: usize,
}

impl<'a> KitReport<'a> {
    pub(super) fn of(kit: &'a str, loaded: &'a Loaded) -> Self {
        let statistics = loaded.statistics();
        Self {
            kit,
            name: &loaded.kit.name,
            binary_bytes: statistics.bytes,
            modes_bytes: statistics.mode_bytes,
            pads: loaded.kit.pads.iter().map(|pad| pad.name.as_str()).collect(),
            objects: statistics.objects.iter().map(BankReport::of).collect(),
            strikers: statistics.strikers.iter().map(BankReport::of).collect(),
            skipped_sections: &loaded.skipped_sections,
        }
    }
}

impl BankReport {
    fn of(bank: &BankStatistics) -> Self {
        Self {
            name: bank.name.clone(),
            modes: bank.modes,
            positions: bank.positions,
            lowest_frequency_hz: bank.frequency_hz.map(|(lowest, _)| lowest),
            highest_frequency_hz: bank.frequency_hz.map(|(_, highest)| highest),
            shortest_t60_s: bank.t60_s.map(|(shortest, _)| shortest),
            longest_t60_s: bank.t60_s.map(|(_, longest)| longest),
            breakpoints: bank.breakpoints,
            loops: bank.loops,
            biquads: bank.biquads,
        }
    }
}
