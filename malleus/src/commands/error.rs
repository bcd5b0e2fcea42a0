//! Failures of the commands, as the user reads them.

use std::io;
use std::path::PathBuf;

use kit::counting::counted;
use malleus::events::EventsError;
use malleus::plot::PlotError;
use malleus::render::instrument::RenderError;
use malleus::render::parts::PartsError;
use malleus::report::ReportError;
use malleus::wave::WaveError;

use super::separate_labels::LabelsError;
use super::separate_tables::KnownError;

/// Failure of a command. Its message says what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CommandError {
    #[error(transparent)]
    Kit(#[from] ::kit::KitError),
    #[error("{kit}: {error}")]
    Table { kit: String, error: dsp_core::table::TableError },
    #[error(transparent)]
    Events(#[from] EventsError),
    #[error(transparent)]
    Wave(#[from] WaveError),
    #[error(transparent)]
    File(#[from] ::kit::file::FileError),
    #[error(transparent)]
    Plot(#[from] PlotError),
    #[error(transparent)]
    Report(#[from] ReportError),
    #[error("{kit}: {error}")]
    Render { kit: String, error: RenderError },
    #[error("{kit}: object {object:?} at {rate}: {what}")]
    Filters { kit: String, object: String, rate: dsp_core::SampleRate, what: String },
    #[error("{kit}: the reference cannot play it: {error}")]
    Reference { kit: String, error: reference::Error },
    #[error("{kit}: there is no pad {name:?}; the kit has {pads}")]
    UnknownPad { kit: String, name: String, pads: String },
    #[error(
        "{kit}: the kit has no pads, so that nothing can be played; bind its objects to pads, such as by malleus kit new"
    )]
    NoPads { kit: String },
    #[error(
        "{file}: the file's rate is {file_rate}, but --rate or --board asks for {rate}; a force is not resampled: leave that option out, or convert the file"
    )]
    RateMismatch { file: String, file_rate: dsp_core::SampleRate, rate: dsp_core::SampleRate },
    #[error(
        "{file}: it would play for {seconds:.0} s, and at most {longest:.0} s are rendered at once; play a part of it, or give a shorter --tail"
    )]
    TooLong { file: String, seconds: f64, longest: f64 },
    #[error(transparent)]
    Board(#[from] virtual_board::BoardError),
    #[error(transparent)]
    BoardInput(#[from] super::board_inputs::BoardInputError),
    #[error(transparent)]
    Cable(#[from] cable::HostError),
    #[error("{kit}: {board} cannot load it: {error}")]
    NotLoadable { kit: String, board: &'static str, error: dsp_core::engine::LoadError },
    #[cfg(not(feature = "usb-midi"))]
    #[error(
        "this malleus was built without USB-MIDI; install one that has it by `cargo install --locked --path malleus --features usb-midi` (on Linux after `apt install libasound2-dev`)"
    )]
    NoUsbMidi,
    #[cfg(feature = "usb-midi")]
    #[error(
        "{problem} has a name with {wanted:?}; the ports are: {found}; connect one board, or name its port with --port"
    )]
    Port { problem: &'static str, wanted: String, found: String },
    #[cfg(feature = "usb-midi")]
    #[error("{what}; close other programs that use the board, and plug it in again")]
    Midi { what: &'static str },
    #[error("{}: is read by this command and would be lost; write to another file", output.display())]
    OutputIsInput { output: PathBuf },
    #[error("{}: is named for two outputs, and one would be lost; give each a file of its own", output.display())]
    SameOutput { output: PathBuf },
    #[error(
        "{}: exists already, and without -o the first path is the kit to write; give the kit to write behind -o",
        output.display()
    )]
    KitExists { output: PathBuf },
    #[error(
        "{}: kit build writes the binary form of a kit, and .toml files are text; name it .bin, or print the text by malleus kit show",
        output.display()
    )]
    BinaryAsText { output: PathBuf },
    #[error(
        "no table has an object, so that the kit would have no pad; give one that has, such as malleus fit or malleus shape writes, beside strikers and surfaces"
    )]
    NoObject,
    #[error(
        "no table has a striker, so that nothing would strike its objects; give one that has, such as tables/strikers.toml"
    )]
    NoStriker,
    #[error(
        "--first-note {first_note}: MIDI notes end at 127, which is enough for {}, and the tables have more; give a lower first note, or fewer tables",
        counted(*pads, "pads")
    )]
    NotesEnd { first_note: u8, pads: usize },
    #[error("{file}: cannot be read: {error}")]
    Unreadable { file: String, error: io::Error },
    #[error("{}: one table cannot hold {inputs} recordings; give -o a folder", output.display())]
    OneTable { output: PathBuf, inputs: usize },
    #[error(
        "{}: is a file, and no table to write: give -o a .toml file, or a folder for a table of each recording",
        output.display()
    )]
    NoTable { output: PathBuf },
    #[error("--render takes one recording at a time, not {inputs}; fit them one by one")]
    OneRendering { inputs: usize },
    #[error("--events writes the strikes of one recording, and {inputs} are given: fit that one alone")]
    OneEvents { inputs: usize },
    #[error(
        "{file}: strikes with a force of their own at several positions or with several strikers are played in parts that add up: leave out --board, --budget-mhz, --log and --limit"
    )]
    PartsOnBoard { file: String },
    #[error("{file}: strikes with a force of their own cannot be played beside a motion: play them alone, and mix")]
    OwnForceWithMotion { file: String },
    #[error(transparent)]
    MotionFile(#[from] malleus::motion::MotionError),
    #[error("{kit}: {error}")]
    Scraped { kit: String, error: malleus::render::scraped::ScrapedError },
    #[error("{kit}: {error}")]
    Parts { kit: String, error: PartsError },
    #[error(
        "--estimator descent fits all strikes of a recording together: give --events OUT.csv, too, or choose modal or bins"
    )]
    DescentWithoutEvents,
    #[error("--steps is the number of steps of a descent: give --estimator descent, too, or leave --steps out")]
    StepsWithoutDescent,
    #[error(transparent)]
    Labels(#[from] LabelsError),
    #[error(transparent)]
    Known(#[from] KnownError),
    #[error(transparent)]
    Materials(#[from] ::fit::material::UnknownMaterial),
    #[error(transparent)]
    Surface(#[from] ::fit::surface::SurfaceError),
    #[error(transparent)]
    Shape(#[from] super::shape::ShapeError),
    #[error(transparent)]
    Trial(#[from] malleus::motion::trials::TrialError),
    /// The demo piece cannot be made.
    #[error(transparent)]
    Demo(#[from] malleus::demo::DemoError),
    /// A study was not made.
    #[error(transparent)]
    Study(#[from] malleus::study::StudyError),
    #[error("{0}")]
    Recording(String),
    #[error("{failed} of {} could not be fitted{}", counted(*of, "recordings"),
        if failed < of { "; the tables of the others are written" } else { "" })]
    FitsFailed { failed: usize, of: usize },
    #[error("no worker threads can be started to fit recordings; close other programs and try again")]
    Workers(#[source] rayon::ThreadPoolBuildError),
    #[error("the report cannot be printed: {0}")]
    Print(#[from] io::Error),
    #[error("the report cannot be written as JSON; leave --json out, and tell the developers")]
    Json(#[from] serde_json::Error),
}
