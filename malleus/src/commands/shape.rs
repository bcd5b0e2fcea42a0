//! `malleus shape`: outline, thickness and material become the table of a body.

use std::path::{Path, PathBuf};

use ::fit::table::{CYCLES_A_MODE, modes_within};
use ::shape::file::{FileError, ShapeFile};
use ::shape::outline::Outline;
use ::shape::solve::{self, Geometry, HIGHEST_HZ, SolveError, Solved, Wanted};
use ::shape::surface::Surface;
use ::shape::table::kept_decay_per_s;
use kit::counting::counted;
use serde::Serialize;

use super::error::CommandError;
use super::output::{print, print_json, progress};
use super::shape_outputs::Outputs;
use super::shape_undercut::{self, UndercutReport};
use crate::arguments::ShapeArguments;

/// Number of modes if none is asked for.
const MODES: usize = 32;
/// Maximum number of modes of a table.
const MOST_MODES: usize = dsp_core::table::range::MODES_PER_BANK;
/// Steps of the progress bar.
pub(super) const STEPS: u64 = 100;

/// Failure of `malleus shape`, with the file in which it lies.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ShapeError {
    #[error("{}: {error}", path.display())]
    File { path: PathBuf, error: FileError },
    #[error("{}: {error}", path.display())]
    Solve { path: PathBuf, error: solve::SolveError },
    #[error("{}: {cause}; the shape file names it", path.display())]
    Read { path: PathBuf, cause: std::io::Error },
    #[error("{}: the file is no text in UTF-8; give a shape file", path.display())]
    NoText { path: PathBuf },
    #[error("{}: the outline is no .svg or .png file; draw it as a closed path of an SVG file or as a dark shape of a PNG file, or give polygon_m", path.display())]
    Outline { path: PathBuf },
    #[error("{}: the surface is no .stl or .obj file", path.display())]
    Surface { path: PathBuf },
    #[error("{}: the table that damping names has no modes", path.display())]
    NoDecays { path: PathBuf },
    #[error("{}: {error}", path.display())]
    Tune { path: PathBuf, error: ::shape::tune::TuneError },
    #[error("{value} {option} is asked for; it must be {range}")]
    Range { option: &'static str, value: f64, range: String },
    #[error("{}: is a file, and --report writes a page into a folder; give a folder", path.display())]
    ReportIsFile { path: PathBuf },
    #[error("{}: is the page of something else and would be lost; give --report another folder", path.display())]
    OtherPage { path: PathBuf },
    #[error(transparent)]
    Benchmark(#[from] solve::SolveError),
}

/// Report that `--json` prints (docs/json.md).
#[derive(Debug, Serialize)]
struct ShapeReport<'a> {
    input: &'a Path,
    table: &'a Path,
    /// Path of the page, if one was asked for.
    page: Option<&'a Path>,
    /// Mass of the body, kg.
    mass_kg: f64,
    /// Number of unknowns, and of triangles or cells, of the finest mesh.
    unknowns: usize,
    elements: usize,
    /// Number of rigid motions, which are left out.
    rigid: usize,
    /// Number of modes, rigid ones too, up to `counted_to_hz` by the inertia of K - ω² M.
    counted: usize,
    counted_to_hz: f64,
    /// True if the number of modes leaves out the next one though it has the last one's frequency.
    cut_pair: bool,
    modes: Vec<ModeReport<'a>>,
    /// Tuned bar of `--undercut`.
    #[serde(skip_serializing_if = "Option::is_none")]
    undercut: Option<UndercutReport>,
}

#[derive(Debug, Serialize)]
struct ModeReport<'a> {
    frequency_hz: f64,
    /// Estimated error of the frequency, as a share of it.
    error: f64,
    decay_per_s: f64,
    gain_sine: Vec<f64>,
    gain_cosine: Vec<f64>,
    #[serde(skip)]
    mode: &'a solve::Mode,
}

pub(crate) fn run(arguments: &ShapeArguments) -> Result<(), CommandError> {
    let (Some(input), Some(output)) = (&arguments.input, &arguments.output) else {
        return match arguments.materials {
            true => super::shape_materials::run(arguments.json),
            false => super::shape_benchmarks::run(arguments.error, arguments.json),
        };
    };
    let outputs = Outputs::check(arguments, input, output)?;
    let wanted = wanted(arguments)?;
    let bytes = ::kit::file::read_whole(input)?;
    let text = String::from_utf8(bytes).map_err(|_| ShapeError::NoText { path: input.clone() })?;
    let undercut = shape_undercut::find(input, &text, arguments)?;
    let text = undercut.as_ref().map_or(text, |tuned| tuned.text.clone());
    let file = ShapeFile::parse(&text).map_err(|error| ShapeError::File { path: input.clone(), error })?;
    outputs.refuse_named(input, &file)?;
    let body = body(input, &file)?;
    let measured = decays(input, &file)?;
    let bar = progress(STEPS, "finding the modes");
    let solved = solve::solve(&file, body.geometry(), measured, wanted, arguments.error, &mut |step| {
        bar.set_position(step as u64);
    });
    bar.finish_and_clear();
    let mut solved = solved.map_err(|error| ShapeError::Solve { path: input.clone(), error })?;
    // Report and page tell the decays that the table has.
    solved.modes.iter_mut().for_each(|mode| mode.decay_per_s = kept_decay_per_s(mode.decay_per_s));
    // The tuned bar's own file is what its table can be made from again.
    let source = arguments.tuned.as_ref().unwrap_or(input).file_name().unwrap_or_default().to_string_lossy();
    let table = ::shape::table::of(&solved, &file, &format!("{source} (malleus shape)"), &arguments.licence);
    ::kit::binary::build(&table)?;
    let positions = solved.modes.first().map_or(1, |mode| mode.gains.len());
    let of_tuned = arguments.tuned.as_ref().map(|tuned| (tuned.as_path(), text.into_bytes()));
    let mut files: Vec<(&Path, Vec<u8>)> = of_tuned.into_iter().collect();
    files.push((output, ::kit::text::write(&table).into_bytes()));
    if let Some(sound) = &arguments.render {
        files.push((sound, super::shape_sound::file(sound, output, table.clone(), positions)?));
    }
    if let Some(page) = &outputs.page {
        files.push((page, super::shape_report::page(page, arguments, &file, table, &solved)?.into_bytes()));
    }
    outputs.write(&files)?;
    let page = outputs.page.as_deref();
    let mut report = report(input, output, page, &solved);
    report.undercut = undercut.as_ref().map(UndercutReport::of);
    if arguments.json { print_json(&report) } else { print(&as_text(&report)) }
}

fn wanted(arguments: &ShapeArguments) -> Result<Wanted, ShapeError> {
    let refused = |option, value, range: String| Err(ShapeError::Range { option, value, range });
    Ok(match (arguments.max_hz, arguments.budget, arguments.modes) {
        (Some(frequency_hz), _, _) if frequency_hz > 0.0 && frequency_hz <= HIGHEST_HZ => Wanted::Below(frequency_hz),
        (Some(frequency_hz), _, _) => {
            let range = format!("above 0 and at most {HIGHEST_HZ}, half the sample rate of boards");
            return refused("--max-hz", frequency_hz, range);
        }
        (None, Some(cycles), _) if (1..=MOST_MODES).contains(&modes_within(cycles)) => {
            Wanted::Lowest(modes_within(cycles))
        }
        (None, Some(cycles), _) => {
            let range = format!(
                "at least {CYCLES_A_MODE}, the cycles a sample of one mode, and enough for at most the {MOST_MODES} modes \
                 that a table holds"
            );
            return refused("--budget", cycles, range);
        }
        (None, None, Some(count)) if !(1..=MOST_MODES).contains(&count) => {
            return refused("--modes", count as f64, format!("1 to {MOST_MODES}, as many as a table holds"));
        }
        (None, None, count) => Wanted::Lowest(count.unwrap_or(MODES)),
    })
}

/// Outline or surface that a file gives or names.
enum Body {
    Outline(Outline),
    Surface(Surface),
}

impl Body {
    fn geometry(&self) -> Geometry<'_> {
        match self {
            Self::Outline(outline) => outline.into(),
            Self::Surface(surface) => surface.into(),
        }
    }
}

fn body(input: &Path, file: &ShapeFile) -> Result<Body, ShapeError> {
    let in_file = |error| ShapeError::Solve { path: input.to_owned(), error };
    if file.shape.outline.is_none() && file.shape.surface.is_none() {
        let corners = file.corners_m().unwrap_or(&[]);
        let outline = Outline::polygon(corners, &file.shape.holes_m).map_err(SolveError::from);
        return outline.map(Body::Outline).map_err(in_file);
    }
    let name = file.shape.outline.as_ref().or(file.shape.surface.as_ref());
    let path = input.parent().unwrap_or(Path::new("")).join(name.map_or(Path::new(""), PathBuf::as_path));
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let bytes = std::fs::read(&path).map_err(|cause| ShapeError::Read { path: path.clone(), cause })?;
    let unit_m = file.shape.unit_m.unwrap_or(1.0);
    let read = match (file.shape.outline.is_some(), ending.to_str()) {
        (true, Some("svg")) => {
            Outline::from_svg(&String::from_utf8_lossy(&bytes), unit_m).map(Body::Outline).map_err(SolveError::from)
        }
        (true, Some("png")) => Outline::from_png(&bytes, unit_m).map(Body::Outline).map_err(SolveError::from),
        (true, _) => return Err(ShapeError::Outline { path }),
        (false, Some("stl")) => Surface::from_stl(&bytes, unit_m).map(Body::Surface).map_err(SolveError::from),
        (false, Some("obj")) => Surface::from_obj(&bytes, unit_m).map(Body::Surface).map_err(SolveError::from),
        (false, _) => return Err(ShapeError::Surface { path }),
    };
    read.map_err(|error| ShapeError::Solve { path, error })
}

/// Frequency and decay of the modes of the table that `damping` names.
fn decays(input: &Path, file: &ShapeFile) -> Result<Vec<[f64; 2]>, CommandError> {
    let Some(name) = &file.material.damping else { return Ok(vec![]) };
    let path = input.parent().unwrap_or(Path::new("")).join(name);
    let loaded = ::kit::load(&path)?;
    let modes = loaded.kit.objects.iter().flat_map(|object| &object.modes);
    let decays: Vec<[f64; 2]> = modes.map(|mode| [f64::from(mode.frequency_hz), f64::from(mode.decay_per_s)]).collect();
    if decays.is_empty() { Err(ShapeError::NoDecays { path }.into()) } else { Ok(decays) }
}

fn report<'a>(input: &'a Path, table: &'a Path, page: Option<&'a Path>, solved: &'a Solved) -> ShapeReport<'a> {
    let mode = |mode: &'a solve::Mode| ModeReport {
        frequency_hz: mode.frequency_hz,
        error: mode.error,
        decay_per_s: mode.decay_per_s,
        gain_sine: mode.gains.iter().map(|gain| gain.sine).collect(),
        gain_cosine: mode.gains.iter().map(|gain| gain.cosine).collect(),
        mode,
    };
    ShapeReport {
        input,
        table,
        page,
        mass_kg: solved.mass_kg,
        unknowns: solved.unknowns,
        elements: solved.elements,
        rigid: solved.rigid,
        counted: solved.counted,
        counted_to_hz: solved.counted_to_hz,
        cut_pair: solved.cut_pair,
        modes: solved.modes.iter().map(mode).collect(),
        undercut: None,
    }
}

fn as_text(shown: &ShapeReport<'_>) -> String {
    let mut text = format!(
        "{}: {} of a body of {:.3} g; {} in {}; {} below {:.1} Hz by inertia, {} of them rigid\n",
        shown.table.display(),
        counted(shown.modes.len(), "modes"),
        1e3 * shown.mass_kg,
        counted(shown.unknowns, "unknowns"),
        counted(shown.elements, "elements"),
        counted(shown.counted, "modes"),
        shown.counted_to_hz,
        shown.rigid
    );
    text += &shown.undercut.as_ref().map_or_else(String::new, UndercutReport::as_text);
    text += "mode  frequency Hz  error %  decay 1/s  largest gain\n";
    for (number, mode) in shown.modes.iter().enumerate() {
        let largest = mode.mode.gains.iter().map(|gain| gain.sine.hypot(gain.cosine)).fold(0.0, f64::max);
        text += &format!(
            "{:4}  {:12.3}  {:7.4}  {:9.3}  {:12.4}\n",
            number + 1,
            mode.frequency_hz,
            100.0 * mode.error,
            mode.decay_per_s,
            largest
        );
    }
    if shown.cut_pair {
        let count = shown.modes.len();
        text += &format!(
            "the next mode has the frequency of the last one and is left out: half a pair beats otherwise; give --modes {}{}\n",
            count + 1,
            if count > 1 { format!(" or {}", count - 1) } else { String::new() }
        );
    }
    if let Some(page) = shown.page {
        text += &format!("page: {}\n", page.display());
    }
    text
}
