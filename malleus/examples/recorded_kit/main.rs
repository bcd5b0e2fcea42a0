//! Makes the shipped kit `recorded` anew from its recordings.
//!
//! ```text
//! cargo run --release -p malleus --example recorded_kit -- \
//!     --recordings ../shared/data/recordings --out tables [--before OTHER_TABLES] [--measure]
//! ```
//!
//! Each instrument is fitted as `malleus fit` does, modes and noise together, then made playable:
//! no mode rings longer than the recording shows, and all strikes at velocity 1 have one peak. Two
//! printed tables say how near the new tables are to their recordings, and how near the tables in
//! the folder `--before` are. Without `--before` the old tables in `--out` are compared. If a
//! recording is absent, its table is not changed. With `--measure` nothing is fitted or written:
//! the printed figures are those of the tables in `--out` as they are.

mod decay;
mod failure;
mod gain;
mod instruments;
mod manifest;
mod nearness;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use failure::Failure;
use fit::recording::{Options, fit_file};
use fit::render::by_instrument;
use fit::score::quantile;
use instruments::{INSTRUMENTS, Instrument};
use kit::{Kit, Pad};
use nearness::Nearness;
use rayon::prelude::*;

/// Peak in dBFS of a strike at velocity 1 in the louder channel, with a pad's level of 0 dB.
const PEAK_DBFS: f64 = -10.0;
/// Stack of a worker thread in bytes: the engine that renders tables is built on it.
const STACK_BYTES: usize = 64 << 20;

fn main() -> ExitCode {
    let Some(folders) = arguments() else {
        eprintln!("usage: recorded_kit --recordings DIR --out DIR [--before DIR] [--measure]");
        return ExitCode::from(2);
    };
    match make(&folders) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("recorded_kit: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Folders that the program reads and writes.
struct Folders {
    recordings: PathBuf,
    /// Folder of the tables to be written.
    out: PathBuf,
    /// Folder of the tables with which those written are compared.
    before: PathBuf,
    /// True if the tables in `out` are measured as they are, and nothing is written.
    only_measures: bool,
}

fn arguments() -> Option<Folders> {
    let (mut recordings, mut out, mut before, mut only_measures) = (None, None, None, false);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--recordings" => recordings = words.next().map(PathBuf::from),
            "--out" => out = words.next().map(PathBuf::from),
            "--before" => before = words.next().map(PathBuf::from),
            "--measure" => only_measures = true,
            _ => return None,
        }
    }
    let out = out?;
    Some(Folders { recordings: recordings?, before: before.unwrap_or_else(|| out.clone()), out, only_measures })
}

/// Outcome of making an instrument.
enum Made {
    /// A table, with its figures.
    Table(Box<Figures>),
    /// None: a sentence says why.
    Nothing(String),
}

/// Figures of an instrument's table.
struct Figures {
    name: &'static str,
    modes: usize,
    /// Number of residual bands that sound.
    bands: usize,
    /// Nearness of the table before, if there is one.
    before: Option<Nearness>,
    now: Nearness,
    /// Nearness of the table's modes without its noise, as a board without memory for it plays
    /// them.
    modes_alone: Nearness,
    /// Log-spectral distance of the fit, before the table was made playable, in dB; NaN if nothing
    /// was fitted.
    fitted_lsd_db: f64,
    /// Row of the second printed table.
    play: String,
}

fn make(folders: &Folders) -> Result<(), Failure> {
    if !folders.recordings.join("MANIFEST.csv").exists() {
        let path = folders.recordings.display();
        return Err(
            format!("{path}: there are no recordings (no MANIFEST.csv), and all tables stay as they are").into()
        );
    }
    if !folders.only_measures {
        std::fs::create_dir_all(folders.out.join("recorded"))?;
    }
    let workers = rayon::ThreadPoolBuilder::new().stack_size(STACK_BYTES).build()?;
    let made: Vec<Result<Made, Failure>> =
        workers.install(|| INSTRUMENTS.par_iter().map(|instrument| one(instrument, folders)).collect());
    let mut figures = Vec::new();
    for one in made {
        match one? {
            Made::Table(one) => figures.push(*one),
            Made::Nothing(why) => println!("{why}"),
        }
    }
    print_nearness(&figures);
    println!(
        "\n| table | longest T60, s | s to -30 dB, recording | table | contact, ms | peak at velocity 0.5, 0.2 | peak over the recording's | first 3 ms over the recording's |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    figures.iter().for_each(|one| println!("{}", one.play));
    if folders.only_measures {
        return Ok(());
    }
    let path = folders.out.join("recorded.toml");
    kit::file::write_whole(&path, kit_text().as_bytes())?;
    println!("\n{}", path.display());
    Ok(())
}

/// Prints how near the tables are to their recordings, before and now, with medians.
fn print_nearness(figures: &[Figures]) {
    println!(
        "| table | modes | bands | ERB distance before, dB | now | loudness error before | now | now without noise | LSD before, dB | as fitted | now |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let row = |name: &str, [modes, bands]: [usize; 2], numbers: [f64; 8]| {
        let cells = numbers.into_iter().zip([2, 2, 3, 3, 3, 2, 2, 2]).map(|(number, digits)| {
            // What was not measured is NaN.
            if number.is_nan() { "-".to_owned() } else { format!("{number:.digits$}") }
        });
        println!("| {name} | {modes} | {bands} | {} |", cells.collect::<Vec<_>>().join(" | "));
    };
    let mut all: [Vec<f64>; 8] = Default::default();
    for one in figures {
        let (now, before) = (one.now.scores, one.before.map(|before| before.scores));
        let before = |of: fn(&fit::hearing::Scores) -> f64| before.as_ref().map_or(f64::NAN, of);
        let numbers = [
            before(|scores| scores.erb_db),
            now.erb_db,
            before(|scores| scores.loudness_error),
            now.loudness_error,
            one.modes_alone.scores.loudness_error,
            before(|scores| scores.lsd_db),
            one.fitted_lsd_db,
            now.lsd_db,
        ];
        row(&format!("`{}`", one.name), [one.modes, one.bands], numbers);
        all.iter_mut().zip(numbers).for_each(|(column, number)| column.push(number));
    }
    let modes = figures.iter().map(|one| one.modes).sum();
    let bands = figures.iter().map(|one| one.bands).sum();
    row("all modes and bands, median", [modes, bands], all.map(|column| quantile(&column, 0.5)));
}

/// Makes an instrument's table, if that is asked for, and measures it.
fn one(instrument: &Instrument, folders: &Folders) -> Result<Made, Failure> {
    let path = folders.recordings.join(instrument.recording);
    if !path.exists() {
        return Ok(Made::Nothing(format!("{}: absent; {} stays as it is", path.display(), instrument.name)));
    }
    let file = Path::new("recorded").join(format!("{}.toml", instrument.name));
    let before = match kit::load(&folders.before.join(&file)) {
        Ok(before) => Some(nearness::of(&before.kit, &folders.recordings)?),
        Err(_) => None,
    };
    let file = folders.out.join(file);
    let fitted_lsd_db = if folders.only_measures { f64::NAN } else { fit_and_write(instrument, folders, &file)? };
    let table = kit::load(&file)?.kit;
    Ok(Made::Table(Box::new(figures(instrument, folders, &table, before, fitted_lsd_db)?)))
}

/// Fits an instrument and writes its table to a file; returns the fit's log-spectral distance in
/// dB.
fn fit_and_write(instrument: &Instrument, folders: &Folders, file: &Path) -> Result<f64, Failure> {
    let origin = manifest::origin(&folders.recordings, instrument.recording)?;
    let mut options = Options { licence: origin.licence.clone(), ..Options::default() };
    options.strike.modes.most_modes = instrument.modes;
    let fitted = fit_file(&folders.recordings.join(instrument.recording), &options)?;
    let strike = fitted.fit.strikes.get(fitted.fit.loudest).ok_or("no strike")?;
    let heard = fitted.recording.samples.get(strike.hit.onset..strike.hit.end).ok_or("no sound")?;

    let mut table = fitted.table.clone();
    if !table.room.is_empty() {
        return Err(format!("{}: the fit has a room, which a kit of many objects has not", instrument.name).into());
    }
    let object = table.objects.first_mut().ok_or("the fit has no object")?;
    let source = object.source.clone();
    let limited = decay::limit(object, heard, fitted.recording.rate_hz);
    let moved = match gain::balance(&mut table)? {
        0 => String::new(),
        percent => format!(", its acceleration sound moved by {percent} % toward balance"),
    };
    let wanted = 10f64.powf(PEAK_DBFS / 20.0) / louder_channel(instrument.pan);
    let peak = gain::peak(&table, 1.0)?;
    gain::scale(&mut table, wanted / peak);
    let source = format!(
        "{source}; {}; decays of {} modes and {} noise bands held to the recording's{moved}, its force scaled to a common peak",
        origin.source, limited.modes, limited.bands
    );
    table.name = instrument.name.to_owned();
    for object in &mut table.objects {
        object.name = instrument.name.to_owned();
        object.source.clone_from(&source);
    }
    for striker in &mut table.strikers {
        striker.name = striker_name(instrument);
        striker.source.clone_from(&source);
    }
    kit::binary::build(&table)?; // refuses what a board would refuse
    kit::file::write_whole(file, kit::text::write(&table).as_bytes())?;
    Ok(fitted.report.hearing.lsd_db)
}

/// Figures of an instrument's table.
fn figures(
    instrument: &Instrument,
    folders: &Folders,
    table: &Kit,
    before: Option<Nearness>,
    fitted_lsd_db: f64,
) -> Result<Figures, Failure> {
    let (recording, hit) = nearness::recorded(table, &folders.recordings)?;
    let (heard, rate_hz) = (recording.samples.get(hit.onset..hit.end).ok_or("no sound")?, recording.rate_hz);
    let now = nearness::of(table, &folders.recordings)?;
    let mut without_noise = table.clone();
    without_noise.objects.iter_mut().for_each(|object| object.residual = None);
    let modes_alone = nearness::of(&without_noise, &folders.recordings)?;
    let sound = by_instrument(table, 0.0, rate_hz, heard.len())?;
    let modes = table.objects.iter().flat_map(|object| &object.modes);
    let longest = modes.map(|mode| 1000f64.ln() / f64::from(mode.decay_per_s)).fold(0.0, f64::max);
    let seconds = |sound: &[f64]| {
        decay::fall_time_s(sound, rate_hz, 30.0).map_or_else(|| "longer".to_owned(), |time| format!("{time:.2}"))
    };
    let full = gain::peak(table, 1.0)?;
    let softer_db = |velocity: f32| Ok::<f64, Failure>(20.0 * (gain::peak(table, velocity)? / full).log10());
    let play = format!(
        "| `{}` | {longest:.2} | {} | {} | {:.2} | {:.1}, {:.1} dB | {:+.1} dB | {:+.1} dB |",
        instrument.name,
        seconds(heard),
        seconds(&sound),
        1e3 * table.strikers.first().ok_or("the table has no striker")?.contact_time_s,
        softer_db(0.5)?,
        softer_db(0.2)?,
        now.peak_db,
        now.attack_db,
    );
    let residuals = table.objects.iter().filter_map(|object| object.residual.as_ref());
    Ok(Figures {
        name: instrument.name,
        modes: table.objects.iter().map(|object| object.modes.len()).sum(),
        bands: residuals.map(|residual| residual.weight.iter().filter(|weight| **weight > 0.0).count()).sum(),
        before,
        now,
        modes_alone,
        fitted_lsd_db,
        play,
    })
}

/// Gain of the louder channel relative to the sound of [`by_instrument`].
///
/// A constant-power pan lowers it by 3 dB in the middle, and by nothing at a side.
fn louder_channel(pan: f32) -> f64 {
    let angle = (f64::from(pan.abs()) + 1.0) * std::f64::consts::FRAC_PI_4;
    angle.sin()
}

fn striker_name(instrument: &Instrument) -> String {
    kit::item_name(instrument.name, " strike")
}

/// Text of the kit's own file, which includes the tables and has the pads.
fn kit_text() -> String {
    let pads = INSTRUMENTS.iter().map(|instrument| Pad {
        name: instrument.name.to_owned(),
        object: instrument.name.to_owned(),
        strikers: vec![striker_name(instrument)],
        level_db: instrument.level_db,
        pan: instrument.pan,
        striker_weight: 1.0,
        choke_t60_s: instrument.choke_t60_s,
        midi_notes: instrument.midi_notes.to_vec(),
        note_off: kit::NoteOff::Nothing,
        trigger: None,
    });
    let kit = Kit {
        name: "recorded".to_owned(),
        objects: Vec::new(),
        strikers: Vec::new(),
        pads: pads.collect(),
        background: None,
        room: Vec::new(),
        headphone_db: None,
        surfaces: Vec::new(),
    };
    let text = kit::text::write(&kit);
    let included: String =
        INSTRUMENTS.iter().map(|instrument| format!("  \"recorded/{}.toml\",\n", instrument.name)).collect();
    let (head, pads) = text.split_once("\n\n").unwrap_or((&text, ""));
    format!("{head}\ninclude = [\n{included}]\n\n{pads}")
}
