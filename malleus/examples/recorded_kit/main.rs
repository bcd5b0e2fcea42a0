//! Makes the shipped kit `recorded` anew from its recordings.
//!
//! ```text
//! cargo run --release -p malleus --example recorded_kit -- \
//!     --recordings ../shared/data/recordings --out tables
//! ```
//!
//! Each instrument is fitted as `malleus fit` does, then made playable: no mode rings longer than
//! the recording shows, and all strikes at velocity 1 have one peak. A row per instrument says how
//! near the shipped table is to its recording. The tables of absent recordings stay as they are.

mod decay;
mod failure;
mod gain;
mod instruments;
mod manifest;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use failure::Failure;
use fit::distance::{log_spectral_distance_db, lsd_window};
use fit::recording::{Options, fit_file};
use fit::render::by_instrument;
use fit::table::Provenance;
use instruments::{INSTRUMENTS, Instrument};
use kit::{Kit, Pad};
use rayon::prelude::*;

/// Peak in dBFS of a strike at velocity 1 in the louder channel, with a pad's level of 0 dB.
const PEAK_DBFS: f64 = -10.0;
/// Stack of a worker thread in bytes: the engine that renders tables is built on it.
const STACK_BYTES: usize = 64 << 20;

fn main() -> ExitCode {
    let Some((recordings, out)) = arguments() else {
        eprintln!("usage: recorded_kit --recordings DIR --out DIR");
        return ExitCode::from(2);
    };
    match make(&recordings, &out) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("recorded_kit: {error}");
            ExitCode::FAILURE
        }
    }
}

fn arguments() -> Option<(PathBuf, PathBuf)> {
    let (mut recordings, mut out) = (None, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--recordings" => recordings = words.next().map(PathBuf::from),
            "--out" => out = words.next().map(PathBuf::from),
            _ => return None,
        }
    }
    Some((recordings?, out?))
}

fn make(recordings: &Path, out: &Path) -> Result<(), Failure> {
    if !recordings.join("MANIFEST.csv").exists() {
        let path = recordings.display();
        return Err(
            format!("{path}: there are no recordings (no MANIFEST.csv), and all tables stay as they are").into()
        );
    }
    std::fs::create_dir_all(out.join("recorded"))?;
    let workers = rayon::ThreadPoolBuilder::new().stack_size(STACK_BYTES).build()?;
    let made: Vec<Result<String, Failure>> =
        workers.install(|| INSTRUMENTS.par_iter().map(|instrument| one(instrument, recordings, out)).collect());
    println!(
        "| table | modes | LSD as fitted, dB | LSD as shipped, dB | longest T60, s | s to -30 dB, recording | table | contact, ms | peak at velocity 0.5, 0.2 |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for row in made {
        println!("{}", row?);
    }
    let path = out.join("recorded.toml");
    kit::file::write_whole(&path, kit_text().as_bytes())?;
    println!("{}", path.display());
    Ok(())
}

/// Fits an instrument and writes its table; returns the instrument's row.
fn one(instrument: &Instrument, recordings: &Path, out: &Path) -> Result<String, Failure> {
    let path = recordings.join(instrument.recording);
    if !path.exists() {
        return Ok(format!("{}: absent; {} stays as it is", path.display(), instrument.name));
    }
    let origin = manifest::origin(recordings, instrument.recording)?;
    let mut options = Options { licence: origin.licence.clone(), ..Options::default() };
    options.strike.modes.most_modes = instrument.modes;
    let fitted = fit_file(&path, &options)?;
    let strike = fitted.fit.strikes.get(fitted.fit.loudest).ok_or("no strike")?;
    let heard = fitted.recording.samples.get(strike.hit.onset..strike.hit.end).ok_or("no sound")?;
    let rate_hz = fitted.recording.rate_hz;

    let source = fitted.table.objects.first().map_or("", |object| object.source.as_str());
    // The table has modes alone: a board has no memory for fourteen residuals.
    let provenance =
        Provenance { name: instrument.name.to_owned(), source: source.to_owned(), licence: origin.licence };
    let mut table = fit::table::of_fit(&fitted.fit, &provenance);
    let limited = table.objects.iter_mut().map(|object| decay::limit(&mut object.modes, heard, rate_hz)).sum::<usize>();
    let moved = match gain::balance(&mut table)? {
        0 => String::new(),
        percent => format!(", its acceleration sound moved by {percent} % toward balance"),
    };
    let wanted = 10f64.powf(PEAK_DBFS / 20.0) / louder_channel(instrument.pan);
    let peak = gain::peak(&table, 1.0)?;
    gain::scale(&mut table, wanted / peak);
    let source = format!(
        "{source}; {}; decays of {limited} modes held to the recording's{moved}, all gains scaled in common",
        origin.source
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
    let file = out.join("recorded").join(format!("{}.toml", instrument.name));
    kit::file::write_whole(&file, kit::text::write(&table).as_bytes())?;

    let sound = by_instrument(&table, 0.0, rate_hz, heard.len())?;
    let window = lsd_window(heard, rate_hz);
    let distance =
        |sound: &[f64]| Some(log_spectral_distance_db(heard.get(window.clone())?, sound.get(window.clone())?));
    let modes = table.objects.iter().flat_map(|object| &object.modes);
    let longest = modes.map(|mode| 1000f64.ln() / f64::from(mode.decay_per_s)).fold(0.0, f64::max);
    let seconds = |sound: &[f64]| {
        decay::fall_time_s(sound, rate_hz, 30.0).map_or_else(|| "longer".to_owned(), |time| format!("{time:.2}"))
    };
    let full = gain::peak(&table, 1.0)?;
    let softer_db = |velocity: f32| Ok::<f64, Failure>(20.0 * (gain::peak(&table, velocity)? / full).log10());
    Ok(format!(
        "| `{}` | {} | {:.2} | {:.2} | {longest:.2} | {} | {} | {:.2} | {:.1}, {:.1} dB |",
        instrument.name,
        fitted.report.modes,
        fitted.report.lsd_db,
        distance(&sound).ok_or("no sound to compare")?,
        seconds(heard),
        seconds(&sound),
        1e3 * strike.contact_time_s,
        softer_db(0.5)?,
        softer_db(0.2)?,
    ))
}

/// Gain of the louder channel relative to the sound of [`by_instrument`].
///
/// A constant-power pan lowers it by 3 dB in the middle, and by nothing at a side.
fn louder_channel(pan: f32) -> f64 {
    let angle = (f64::from(pan.abs()) + 1.0) * std::f64::consts::FRAC_PI_4;
    angle.sin()
}

fn striker_name(instrument: &Instrument) -> String {
    fit::table::item_name(instrument.name, " strike")
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
    };
    let text = kit::text::write(&kit);
    let included: String =
        INSTRUMENTS.iter().map(|instrument| format!("  \"recorded/{}.toml\",\n", instrument.name)).collect();
    let (head, pads) = text.split_once("\n\n").unwrap_or((&text, ""));
    format!("{head}\ninclude = [\n{included}]\n\n{pads}")
}
