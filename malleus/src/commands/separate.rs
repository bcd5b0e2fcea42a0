//! `malleus separate`: recordings of strikers on things become the sounds of each.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use ::fit::audio::{self, Recording};
use ::fit::material::{self, Identified, Material, RingingMode};
use ::fit::modes::Settings;
use ::fit::separate::{self, Blow, Clip, Known, PartMode, STEPS, SeparateError, Separation, Stems};
use ::fit::table::Provenance;
use kit::counting::counted;
use malleus::wave::write_mono;
use serde::Serialize;

use super::error::CommandError;
use super::fit_job::with_file;
use super::fit_names;
use super::output::{print, print_json, progress, refuse_input};
use super::separate_labels::{self as labels, Labels};
use super::separate_tables::{self as tables, Kind};
use crate::arguments::SeparateArguments;

/// Thing or striker, as it is known after the separation.
#[derive(Clone, Debug, Serialize)]
struct PartReport {
    /// Name in the labels.
    name: String,
    /// Path of its table.
    table: PathBuf,
    /// Number of its modes.
    modes: usize,
    #[serde(flatten)]
    identified: Option<Identified>,
}

/// Paths of a recording's stems.
#[derive(Clone, Debug, Serialize)]
struct StemFiles {
    object: PathBuf,
    striker: PathBuf,
    rest: PathBuf,
}

/// One recording, a row of the report.
#[derive(Debug, Serialize)]
struct Row<'a> {
    input: &'a Path,
    notes: Vec<String>,
    stems: StemFiles,
    left_db: f64,
    blows: &'a [Blow],
    object: &'a PartReport,
    striker: &'a PartReport,
}

pub(crate) fn run(arguments: &SeparateArguments) -> Result<(), CommandError> {
    let materials = material::named(&arguments.materials)?;
    let (inputs, names): (Vec<PathBuf>, Vec<String>) = fit_names::of_inputs(&arguments.input).into_iter().unzip();
    let labels = labels::parse(&::kit::file::read_whole(&arguments.labels)?, &arguments.labels, &inputs)?;
    let known = Known {
        objects: tables::known(Kind::Object, &arguments.object, &labels.objects)?,
        strikers: tables::known(Kind::Striker, &arguments.striker, &labels.strikers)?,
    };
    let files: Vec<StemFiles> = names.iter().map(|name| stem_files(&arguments.output, name)).collect();
    for path in files.iter().flat_map(|files| [&files.object, &files.striker, &files.rest]) {
        refuse_input(path, inputs.iter().map(PathBuf::as_path))?;
    }
    let written = [(Kind::Object, &labels.objects), (Kind::Striker, &labels.strikers)];
    for path in written.into_iter().flat_map(|(kind, names)| tables::written(&arguments.output, kind, names)) {
        let known = arguments.object.iter().chain(&arguments.striker).map(|option| tables::path_of(option));
        refuse_input(&path, known.chain([arguments.labels.as_path()]))?;
    }
    let recordings: Vec<Recording> = inputs
        .iter()
        .map(|input| audio::read(input, None).map_err(|error| CommandError::Recording(with_file(input, error))))
        .collect::<Result<_, _>>()?;
    let separation = separated(arguments, &inputs, &recordings, &labels, &known)?;
    // Everything is known before the first file is written.
    std::fs::create_dir_all(&arguments.output).map_err(|cause| {
        CommandError::File(::kit::file::FileError { action: "made", path: arguments.output.clone(), cause })
    })?;
    for ((stems, recording), files) in separation.stems.iter().zip(&recordings).zip(&files) {
        write_stems(stems, recording, files)?;
    }
    let objects = write_tables(arguments, &labels, &separation, Kind::Object, &materials)?;
    let strikers = write_tables(arguments, &labels, &separation, Kind::Striker, &materials)?;
    let rows: Vec<Row<'_>> = inputs
        .iter()
        .zip(&recordings)
        .zip(files)
        .zip(separation.stems.iter().zip(&labels.of_recording))
        .map(|(((input, recording), stems), (separated, &[object, striker]))| Row {
            input,
            notes: notes(recording, separated, [&objects[object].name, &strikers[striker].name]),
            stems,
            left_db: separated.left_db,
            blows: &separated.blows,
            object: &objects[object],
            striker: &strikers[striker],
        })
        .collect();
    if arguments.json { print_json(&rows) } else { print(&as_text(&rows, &objects, &strikers)) }
}

/// Share of a recording in dB from which on what is left of it is told: half of its energy.
const MUCH_LEFT_DB: f64 = -3.0;

/// Notes on how a recording was read, on clipped blows, and on a recording of which much is left.
fn notes(recording: &Recording, stems: &Stems, [object, striker]: [&str; 2]) -> Vec<String> {
    let mut notes: Vec<String> = recording.notes.iter().map(ToString::to_string).collect();
    let clipped = separate::clipped_at_s(&recording.samples, recording.rate_hz, &stems.blows);
    if stems.left_db > MUCH_LEFT_DB {
        notes.push(format!(
            "more than half of its energy belongs to neither part: look whether it is {striker} on {object}, as the labels say"
        ));
    }
    if !clipped.is_empty() {
        let times: Vec<String> = clipped.iter().map(|at_s| format!("{at_s:.3}")).collect();
        notes.push(format!("clipped blows, whose parts are uncertain: {} s", times.join(", ")));
    }
    notes
}

fn stem_files(folder: &Path, name: &str) -> StemFiles {
    let of = |stem: &str| folder.join(format!("{name}-{stem}.wav"));
    StemFiles { object: of("object"), striker: of("striker"), rest: of("rest") }
}

fn separated(
    arguments: &SeparateArguments,
    inputs: &[PathBuf],
    recordings: &[Recording],
    labels: &Labels,
    known: &Known,
) -> Result<Separation, CommandError> {
    let clips: Vec<Clip<'_>> = recordings
        .iter()
        .zip(&labels.of_recording)
        .map(|(recording, &[object, striker])| Clip {
            samples: &recording.samples,
            rate_hz: recording.rate_hz,
            object,
            striker,
        })
        .collect();
    let settings = Settings { most_modes: arguments.modes, ..Settings::default() };
    let bar = progress(STEPS as u64, "separating");
    let furthest = AtomicUsize::new(0);
    let report = |done: usize| bar.set_position(furthest.fetch_max(done, Ordering::Relaxed).max(done) as u64);
    let separation = separate::separate(&clips, known, settings, &report);
    bar.finish_and_clear();
    separation.map_err(|error| CommandError::Recording(in_words(&error, inputs)))
}

/// Message of an error, which begins with the path of the recording that it is about.
fn in_words(error: &SeparateError, inputs: &[PathBuf]) -> String {
    let clip = match error {
        SeparateError::Rates { clip, .. } | SeparateError::NoBlow { clip } => inputs.get(*clip),
        SeparateError::OnePair | SeparateError::DisjointPairs | SeparateError::Nothing | SeparateError::Unsolved => {
            None
        }
    };
    clip.map_or_else(|| error.to_string(), |path| format!("{}: {error}", path.display()))
}

/// Writes the three stems, whose samples in 32-bit float add up to the recording's.
///
/// The rest is what the rounded stems of thing and striker leave, so that rounding adds up once. A
/// constant offset of the recording is in the rest.
fn write_stems(stems: &Stems, recording: &Recording, files: &StemFiles) -> Result<(), CommandError> {
    let rounded = |samples: &[f64]| samples.iter().map(|x| f64::from(*x as f32)).collect::<Vec<f64>>();
    let (object, striker) = (rounded(&stems.object), rounded(&stems.striker));
    let recorded = recording.samples.iter().map(|x| x + recording.offset);
    let rest: Vec<f64> = recorded.zip(&object).zip(&striker).map(|((x, a), b)| x - a - b).collect();
    for (path, samples) in [(&files.object, &object), (&files.striker, &striker), (&files.rest, &rest)] {
        write_mono(path, recording.rate_hz, samples)?;
    }
    Ok(())
}

fn write_tables(
    arguments: &SeparateArguments,
    labels: &Labels,
    separation: &Separation,
    kind: Kind,
    materials: &[Material],
) -> Result<Vec<PartReport>, CommandError> {
    let (names, parts) = match kind {
        Kind::Object => (&labels.objects, &separation.objects),
        Kind::Striker => (&labels.strikers, &separation.strikers),
    };
    let paths = tables::written(&arguments.output, kind, names);
    let mut reports = Vec::with_capacity(names.len());
    for (index, ((name, modes), path)) in names.iter().zip(parts).zip(paths).enumerate() {
        let place = usize::from(kind == Kind::Striker);
        let own = labels.of_recording.iter().zip(&separation.stems).filter(|(label, _)| label[place] == index);
        let times_s: Vec<f64> = own.clone().filter_map(|(_, stems)| loudest(&stems.blows)).collect();
        let provenance = Provenance {
            name: name.clone(),
            source: format!(
                "{} (malleus separate), {}",
                counted(own.count(), "recordings"),
                counted(modes.len(), "modes")
            ),
            licence: arguments.licence.clone(),
        };
        let contact_time_s = ::fit::score::quantile(&times_s, 0.5).clamp(1e-4, 0.02);
        let table = tables::of_part(kind, modes, contact_time_s, &provenance);
        ::kit::file::write_whole(&path, ::kit::text::write(&table).as_bytes())?;
        let ringing: Vec<RingingMode> = modes.iter().map(PartMode::ringing).collect();
        reports.push(PartReport {
            name: name.clone(),
            table: path,
            modes: modes.len(),
            identified: material::identify(&ringing, materials),
        });
    }
    Ok(reports)
}

/// Contact time in seconds of the loudest blow.
fn loudest(blows: &[Blow]) -> Option<f64> {
    blows.iter().max_by(|a, b| a.level_db.total_cmp(&b.level_db)).map(|blow| blow.contact_time_s)
}

fn as_text(rows: &[Row<'_>], objects: &[PartReport], strikers: &[PartReport]) -> String {
    let mut text = format!("{:40} {:20} {:20} {:>8}\n", "recording", "object", "striker", "left dB");
    for row in rows {
        let name = row.input.file_name().unwrap_or_default().to_string_lossy();
        text += &format!("{name:40} {:20} {:20} {:>8.2}\n", row.object.name, row.striker.name, row.left_db);
        row.notes.iter().for_each(|note| text += &format!("  {note}\n"));
    }
    text += &format!("\n{:20} {:>5}  {:22} Young's modulus, GPa\n", "object or striker", "modes", "material, a guess");
    for part in objects.iter().chain(strikers) {
        let guess = part.identified.as_ref().map_or((String::from("none"), String::new()), |found| {
            let modulus = found.young_modulus_pa;
            let [estimate, low, high] = [modulus.estimate, modulus.low, modulus.high].map(|pascals| pascals / 1e9);
            (
                format!("{}, {:.0} %", found.material.name, 100.0 * found.material.confidence),
                format!("{estimate:.1} ({low:.1} to {high:.1})"),
            )
        });
        text += &format!("{:20} {:>5}  {:22} {}\n", part.name, part.modes, guess.0, guess.1);
    }
    text
}
