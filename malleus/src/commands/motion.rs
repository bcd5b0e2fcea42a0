//! `malleus motion`: writes the motions of the paper's experiments.

use std::path::Path;

use kit::counting::counted;
use malleus::motion::trials::{Shape, Trial};
use serde::Serialize;

use super::error::CommandError;
use super::output::{print, print_json};
use crate::arguments::{MotionCommand, MotionFileArguments};

/// Report that `--json` prints (docs/json.md).
#[derive(Debug, Serialize)]
struct MotionReport<'a> {
    output: &'a Path,
    motion: &'static str,
    pad: &'a str,
    /// Striker's name, if one was given.
    striker: Option<&'a str>,
    #[serde(flatten)]
    parameters: Parameters,
    seed: u32,
    start_s: f64,
    end_s: f64,
    at_m: [f64; 2],
    contacts: usize,
    lines: usize,
    /// Length of the whole path.
    way_m: f64,
    fastest_m_per_s: f64,
}

/// Parameters of the path as it was drawn, with its variations.
#[derive(Debug, Default, Serialize)]
struct Parameters {
    length_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    period_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    strokes: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    speed_m_per_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    incline_deg: Option<f64>,
}

pub(crate) fn run(command: &MotionCommand) -> Result<(), CommandError> {
    let (name, shape, file) = shape_of(command);
    let given = Trial { shape, start_s: file.start, place_m: file.at };
    let trial = if file.vary { given.varied(file.seed) } else { given };
    let drawing = trial.draw()?;
    let motion = drawing.motion().map_err(malleus::motion::trials::TrialError::from)?;
    ::kit::file::write_whole(&file.output, drawing.csv(&file.pad, &file.striker).as_bytes())?;
    let (way_m, fastest_m_per_s) = motion.way();
    let report = MotionReport {
        output: &file.output,
        motion: name,
        pad: &file.pad,
        striker: Some(file.striker.as_str()).filter(|name| !name.is_empty()),
        parameters: parameters(trial.shape),
        seed: file.seed,
        start_s: motion.contacts()[0].touch_s,
        end_s: motion.end_s(),
        at_m: trial.place_m,
        contacts: drawing.contacts(),
        lines: drawing.lines(),
        way_m,
        fastest_m_per_s,
    };
    if file.json { print_json(&report) } else { print(&as_text(&report)) }
}

/// Name of the path, the path, and the arguments that all paths have.
fn shape_of(command: &MotionCommand) -> (&'static str, Shape, &MotionFileArguments) {
    match command {
        MotionCommand::BackAndForth(strokes) => {
            let (length_m, period_s, strokes, file) = (strokes.length, strokes.period, strokes.strokes, &strokes.file);
            ("back-and-forth", Shape::BackAndForth { length_m, period_s, strokes }, file)
        }
        MotionCommand::FourStrokes(strokes) => {
            let (length_m, period_s, strokes, file) = (strokes.length, strokes.period, strokes.strokes, &strokes.file);
            ("four-strokes", Shape::FourStrokes { length_m, period_s, strokes }, file)
        }
        MotionCommand::Circle(steady) => {
            let shape = Shape::Circle { length_m: steady.length, speed_m_per_s: steady.speed };
            ("circle", shape, &steady.file)
        }
        MotionCommand::Line(steady) => {
            let shape = Shape::Line { length_m: steady.length, speed_m_per_s: steady.speed };
            ("line", shape, &steady.file)
        }
        MotionCommand::Scribble(scribble) => {
            let (length_m, speed_m_per_s, seed) = (scribble.length, scribble.speed, scribble.file.seed);
            ("scribble", Shape::Scribble { length_m, speed_m_per_s, seed }, &scribble.file)
        }
        MotionCommand::Roll(roll) => {
            let (length_m, speed_m_per_s, incline_deg) = (roll.length, roll.speed, roll.incline);
            ("roll", Shape::Roll { length_m, speed_m_per_s, incline_deg }, &roll.file)
        }
    }
}

fn parameters(shape: Shape) -> Parameters {
    match shape {
        Shape::BackAndForth { length_m, period_s, strokes } | Shape::FourStrokes { length_m, period_s, strokes } => {
            Parameters { length_m, period_s: Some(period_s), strokes: Some(strokes), ..Parameters::default() }
        }
        Shape::Circle { length_m, speed_m_per_s }
        | Shape::Line { length_m, speed_m_per_s }
        | Shape::Scribble { length_m, speed_m_per_s, .. } => {
            Parameters { length_m, speed_m_per_s: Some(speed_m_per_s), ..Parameters::default() }
        }
        Shape::Roll { length_m, speed_m_per_s, incline_deg } => Parameters {
            length_m,
            speed_m_per_s: Some(speed_m_per_s),
            incline_deg: Some(incline_deg),
            ..Parameters::default()
        },
    }
}

fn as_text(report: &MotionReport<'_>) -> String {
    format!(
        "{}: {} on pad {}, {}, {}, {:.3} to {:.3} s\nway {:.4} m, at most {:.4} m/s\n",
        report.output.display(),
        report.motion,
        report.pad,
        counted(report.contacts, "contacts"),
        counted(report.lines, "lines"),
        report.start_s,
        report.end_s,
        report.way_m,
        report.fastest_m_per_s
    )
}
