//! `malleus kit new`, `build`, `check` and `show`.

use std::path::{Path, PathBuf};

use dsp_core::SampleRate;
use dsp_core::engine::LoadError;
use dsp_core::table::Kit;
use kit::{BankStatistics, Loaded};
use malleus::plot::{self, KitPicture, ObjectPicture};
use malleus::render::instrument;
use serde::Serialize;
use virtual_board::Board;

use super::{CommandError, left_out, print, print_json};
use crate::KitCommand;

pub(crate) fn run(command: &KitCommand) -> Result<(), CommandError> {
    match command {
        KitCommand::New { output, tables, first_note } => new(output, tables, *first_note),
        KitCommand::Build { kit, output } => build(kit, output),
        KitCommand::Check { kit, rate, json } => check(kit, *rate, *json),
        KitCommand::Show { kit, plot, json } => show(kit, plot.as_deref(), *json),
    }
}

/// One pad for each object of the tables, struck by the strikers of its own table.
fn new(output: &Path, tables: &[PathBuf], first_note: u8) -> Result<(), CommandError> {
    let name = output.file_stem().unwrap_or_default().to_string_lossy();
    let mut kit = kit::Kit {
        name: name.into_owned(),
        objects: vec![],
        strikers: vec![],
        pads: vec![],
        background: None,
        room: vec![],
    };
    let mut notes = (first_note..=127).map(|note| vec![note]);
    for table in tables {
        let loaded = open(&table.display().to_string())?;
        let strikers: Vec<String> = loaded.kit.strikers.iter().take(4).map(|striker| striker.name.clone()).collect();
        for object in &loaded.kit.objects {
            kit.pads.push(kit::Pad {
                name: object.name.clone(),
                object: object.name.clone(),
                strikers: strikers.clone(),
                level_db: 0.0,
                pan: 0.0,
                striker_weight: 1.0,
                choke_t60_s: 0.1,
                midi_notes: notes.next().unwrap_or_default(),
                trigger: None,
            });
        }
        // A table's room is that of its recording; a kit has one.
        match tables.len() {
            1 => kit.room = loaded.kit.room,
            _ if loaded.kit.room.is_empty() => {}
            _ => eprintln!("malleus: {}: the room of its recording is left out", table.display()),
        }
        kit.objects.extend(loaded.kit.objects);
        kit.strikers.extend(loaded.kit.strikers);
    }
    // Judged as a board would, before anything is written.
    let bytes = kit::binary::build(&kit)?.len();
    kit::file::write_whole(output, kit::text::write(&kit).as_bytes())?;
    print(&format!("{}: {} pads, {bytes} bytes in binary\n", output.display(), kit.pads.len()))
}

fn build(name: &str, output: &Path) -> Result<(), CommandError> {
    let loaded = open(name)?;
    let boards = on_boards(name, &loaded)?;
    kit::file::write_whole(output, &loaded.binary)?;
    let statistics = loaded.statistics();
    print(&format!("{}: {} bytes, {}\n{boards}", output.display(), statistics.bytes, counts(&loaded)))
}

fn check(name: &str, rate: SampleRate, json: bool) -> Result<(), CommandError> {
    let loaded = open(name)?;
    check_filters(name, &loaded, rate)?;
    if json {
        return print_json(&KitReport::of(name, &loaded));
    }
    let boards = on_boards(name, &loaded)?;
    print(&format!("{name}: good; {}, {} bytes in binary\n{boards}", counts(&loaded), loaded.binary.len()))
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

/// What only a rate can tell: whether every object's filters are stable, and whether the instrument plays the kit.
fn check_filters(name: &str, loaded: &Loaded, rate: SampleRate) -> Result<(), CommandError> {
    let filtered = |object: &&kit::Object| object.dynamic_filter.is_some() || object.biquads.is_some();
    for object in loaded.kit.objects.iter().filter(filtered) {
        // Alone, so that tables without pads are judged, too.
        let alone = one_object(object);
        let bytes = kit::binary::build(&alone)?;
        let table = Kit::parse(&bytes).map_err(|error| CommandError::Table { kit: name.to_owned(), error })?;
        let what = match instrument::check(&table, rate) {
            Ok(()) => continue,
            Err(LoadError::DynamicFilter { error, .. }) => format!("dynamic filter: {error}"),
            Err(LoadError::Biquads { error, .. }) => format!("biquads: {error}"),
            Err(other) => other.to_string(),
        };
        return Err(CommandError::Filters { kit: name.to_owned(), object: object.name.clone(), rate, what });
    }
    if loaded.kit.pads.is_empty() {
        return Ok(());
    }
    let table = Kit::parse(&loaded.binary).map_err(|error| CommandError::Table { kit: name.to_owned(), error })?;
    if let Err(error) = instrument::check(&table, rate) {
        eprintln!("malleus: {name}: at {rate} it does not play: {error}");
    }
    Ok(())
}

/// The filters of an object, on a pad.
fn one_object(object: &kit::Object) -> kit::Kit {
    let (name, nothing) = ("filters".to_owned(), String::new);
    let striker = kit::Striker {
        name: name.clone(),
        source: nothing(),
        licence: nothing(),
        pulse: kit::Pulse::Hertz,
        peak_force: object.reference_force,
        peak_exponent: 1.0,
        contact_time_s: 0.001,
        contact_exponent: 0.0,
        restitution: kit::Striker::DEFAULT_RESTITUTION,
        modes: vec![],
    };
    let pad = kit::Pad {
        name: name.clone(),
        object: object.name.clone(),
        strikers: vec![name.clone()],
        level_db: 0.0,
        pan: 0.0,
        striker_weight: 1.0,
        choke_t60_s: 0.0,
        midi_notes: vec![],
        trigger: None,
    };
    let object = kit::Object { modes: vec![], residual: None, ..object.clone() };
    kit::Kit { name, objects: vec![object], strikers: vec![striker], pads: vec![pad], background: None, room: vec![] }
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

fn open(name: &str) -> Result<Loaded, CommandError> {
    let loaded = kit::open(name)?;
    for tag in &loaded.skipped_sections {
        eprintln!("malleus: {name}: section {tag} is unknown to this version and was left out");
    }
    Ok(loaded)
}

fn counts(loaded: &Loaded) -> String {
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
struct KitReport<'a> {
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
    fn of(kit: &'a str, loaded: &'a Loaded) -> Self {
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
