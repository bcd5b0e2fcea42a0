//! Command line of the program: commands, options, and the checks of their values.

mod motion;
mod separate;
mod shape;
mod study;
mod surface;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use dsp_core::SampleRate;
use dsp_core::limiter::LOWEST_CEILING_DB;
use fit::material::solid::Solid;
use virtual_board::Board;

pub(crate) use self::motion::{MotionCommand, MotionFileArguments};
pub(crate) use self::separate::SeparateArguments;
pub(crate) use self::shape::ShapeArguments;
pub(crate) use self::study::StudyCommand;
pub(crate) use self::surface::SurfaceArguments;
use crate::commands::board::{BoardCommand, parse_board};

/// Physically modelled percussion, rendered by exactly the code that a board runs.
///
/// Without a command, plays the demo.
#[derive(Debug, Parser)]
#[command(version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

/// Commands of the program.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Play a short piece on the shipped kit: writes demo.wav and demo.png, prints one row per pad
    Demo(DemoArguments),
    /// Play a kit from events or from a measured force, and write the sound as 24-bit stereo WAV
    Play(PlayArguments),
    /// Fit recordings of struck objects, and write one table per recording
    Fit(FitArguments),
    /// Separate recordings of strikers on things into the sound of the thing, that of the striker,
    /// and the rest
    Separate(SeparateArguments),
    /// Make the table of a measured surface
    Surface(SurfaceArguments),
    /// Make the table of a body from its outline, thickness and material
    Shape(ShapeArguments),
    /// Write a motion of a tool over a pad: strokes, a circle, a line, a scribble, a rolling ball
    #[command(subcommand)]
    Motion(MotionCommand),
    /// Render trials of scraping or rolling for listeners, and a page on which they rate them
    #[command(subcommand)]
    Study(StudyCommand),
    /// Make, build, check and show kits
    #[command(subcommand)]
    Kit(KitCommand),
    /// Run firmware on a virtual board
    #[command(subcommand)]
    Board(BoardCommand),
}

/// Arguments of `malleus demo`.
#[derive(Debug, Args)]
pub(crate) struct DemoArguments {
    /// Folder for demo.wav and demo.png; it is made if it does not exist
    #[arg(long, value_name = "DIR", default_value = "malleus-demo")]
    pub(crate) out: PathBuf,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}

/// Arguments of `malleus play`.
#[derive(Debug, Args)]
pub(crate) struct PlayArguments {
    /// Kit: a .toml or .bin file, or the name of a shipped kit (demo, recorded, filters, scrapes,
    /// priors, shapes)
    #[arg(long)]
    pub(crate) kit: String,
    /// Events: a Standard MIDI File, or CSV in UTF-8 with the columns
    /// sample|time_s,pad,velocity[,position,striker,action,peak_force,contact_time_s]
    #[arg(long, value_name = "FILE", required_unless_present_any = ["direct", "motion"], conflicts_with = "direct")]
    pub(crate) strikes: Option<PathBuf>,
    /// Force that drives a pad sample by sample: a WAV file whose full scale is the reference force
    /// of the pad's object; its channels count from 0 [default channel: 0]
    #[arg(long, value_name = "FILE[:CHANNEL]", requires = "pad")]
    pub(crate) direct: Option<String>,
    /// Pad that the force of --direct drives
    #[arg(long, value_name = "NAME", requires = "direct", conflicts_with_all = ["strikes", "motion"])]
    pub(crate) pad: Option<String>,
    /// Motion of scrapers and balls over pads with a surface, with or without strikes: CSV with the
    /// columns time_s|sample,pad,action,striker,x_m,y_m,normal_n (docs/motion.md)
    #[arg(long, value_name = "FILE", conflicts_with = "direct")]
    pub(crate) motion: Option<PathBuf>,
    /// WAV file of the motion's force in newtons, its normal force in newtons, speed in m/s and
    /// distance in metres, as four channels of 32-bit float
    #[arg(long, value_name = "FILE.wav", requires = "motion", conflicts_with = "direct")]
    pub(crate) force: Option<PathBuf>,
    /// Parts of the motion's model to leave out
    #[arg(
        long,
        value_enum,
        value_name = "PARTS",
        value_delimiter = ',',
        requires = "motion",
        conflicts_with = "direct"
    )]
    pub(crate) without: Vec<AblationName>,
    /// WAV file to write
    #[arg(short, long, value_name = "OUT.wav")]
    pub(crate) output: PathBuf,
    /// Sample rate in Hz, or as a ratio such as 86000000/1792 [default: 48000, with --direct the
    /// rate of its file]
    #[arg(long, value_name = "HZ|N/D", value_parser = parse_rate)]
    pub(crate) rate: Option<SampleRate>,
    /// Play as this board does: at its rate, with its reverberation, within its time, and without
    /// the stages that it leaves out; stm32f407g-disc1 or blackpill-f411
    #[arg(long, value_parser = parse_board, conflicts_with_all = ["rate", "reference", "no_skip"])]
    pub(crate) board: Option<Board>,
    /// Frames per block, always 32 with --board or --budget-mhz; every number gives equal sound,
    /// bit for bit
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub(crate) block: u32,
    /// Seconds to play after the last event or the end of the force [default: until the sound has
    /// decayed by 96 dB, at most 30]
    #[arg(long, value_name = "SECONDS", value_parser = parse_tail)]
    pub(crate) tail: Option<f64>,
    /// Render with the f64 reference instead of the instrument
    #[arg(long, conflicts_with = "no_skip")]
    pub(crate) reference: bool,
    /// Run every mode in every frame, also those that cannot be heard
    #[arg(long)]
    pub(crate) no_skip: bool,
    /// Keep the sound at or below this level by a limiter, in dB of full scale from -40 to 0; the
    /// sound comes 64 frames later
    #[arg(long, value_name = "DB", value_parser = parse_ceiling, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["reference", "board"])]
    pub(crate) limit: Option<f32>,
    /// Million cycles of a Cortex-M4 that may be spent per second; what does not fit is left out,
    /// the quietest modes first. 0 means no limit [default: the limit of --board, unless the events
    /// are a log that says what was left out; without --board no limit]
    #[arg(long, value_name = "MHZ", value_parser = parse_budget, conflicts_with_all = ["reference", "no_skip"])]
    pub(crate) budget_mhz: Option<f64>,
    /// Write all events as they were played as CSV, with those that left modes out for want of
    /// time; played with --strikes, beside the same --motion, the file gives the same sound, bit
    /// for bit
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["reference", "direct"])]
    pub(crate) log: Option<PathBuf>,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}

/// Part of the model of scraping and rolling that can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AblationName {
    /// Limit of the path's curvature: the path is the surface's own
    Nonlinearity,
    /// Normal force: the limit stays at its mean
    NormalForce,
    /// Modes of the scraper
    Scraper,
}

/// Arguments of `malleus fit`.
#[derive(Debug, Args)]
pub(crate) struct FitArguments {
    /// Recordings: WAV, FLAC, AIFF, Ogg Vorbis, MP3, AAC, ALAC, CAF
    #[arg(required = true)]
    pub(crate) input: Vec<PathBuf>,
    /// Table to write: a .toml file for one recording, or a folder for one table per recording
    #[arg(short, long, value_name = "TABLE.toml|DIR")]
    pub(crate) output: PathBuf,
    /// Maximum number of modes; the strongest are kept [default: 64, with --estimator bins 1025]
    #[arg(long, value_name = "N", value_parser = parse_modes)]
    pub(crate) modes: Option<usize>,
    /// Estimator of the modes: `modal` finds all together by maximum likelihood; `bins` finds one
    /// per bin of a spectrogram, and always adds 100 bands of noise (a physical prior); `descent`,
    /// with --events, fits all strikes by Adam on spectrograms, for comparison
    #[arg(long, value_enum, value_name = "NAME", default_value_t = EstimatorName::Modal)]
    pub(crate) estimator: EstimatorName,
    /// Number of steps of --estimator descent [default: 6000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) steps: Option<u32>,
    /// Fit noise through a moving filter instead of modes and residual, with at most ten modes
    /// beside it or at most ten loops round it (docs/dynamic-filter-fits.md)
    #[arg(long, value_enum, value_name = "WITH", conflicts_with_all = ["modes", "estimator", "force_channel", "hits", "budget", "report", "materials"])]
    pub(crate) dynamic_filter: Option<BesideName>,
    /// Channel of the recording that holds the measured force, counted from 0
    #[arg(long, value_name = "C")]
    pub(crate) force_channel: Option<usize>,
    /// Strikes of the recording to use, counted from 1 [default: all]
    #[arg(long, value_name = "N,N", value_delimiter = ',')]
    pub(crate) hits: Vec<usize>,
    /// Cortex-M4 cycles per sample that the table may take while it is struck; the modes that
    /// matter most are kept
    #[arg(long, value_name = "CYCLES", value_parser = parse_cycles)]
    pub(crate) budget: Option<f64>,
    /// Write the instrument's sound of the loudest strike, aligned to the recording
    #[arg(long, value_name = "OUT.wav")]
    pub(crate) render: Option<PathBuf>,
    /// Fit all strikes of the recording together, and write them as events that replay it on the
    /// table, with force and contact time of each (docs/multi-strike.md)
    #[arg(long, value_name = "OUT.csv", conflicts_with_all = ["dynamic_filter", "force_channel", "hits", "budget", "render"])]
    pub(crate) events: Option<PathBuf>,
    /// Number of gains of each mode along the object, for strikes at different positions: about
    /// three for each half wave of the highest mode, at least 4; 1 for one place
    #[arg(long, value_name = "P", requires = "events", default_value_t = 1, value_parser = parse_positions)]
    #[arg(conflicts_with_all = ["dynamic_filter", "force_channel", "hits", "budget", "render"])]
    pub(crate) positions: u8,
    /// Number of strikers that strike, told apart by their contact times and own modes
    #[arg(long, value_name = "N", requires = "events", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=4))]
    #[arg(conflicts_with_all = ["dynamic_filter", "force_channel", "hits", "budget", "render"])]
    pub(crate) strikers: u8,
    /// Write a self-contained page of sound, pictures and figures for each recording into this
    /// folder, and an index of all pages in it
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// Materials to choose from [default: all that are known]
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',')]
    pub(crate) materials: Vec<String>,
    /// Size of a bar that is free all round, in m, and its density in kg/m³: its modes then give
    /// Young's modulus
    #[arg(long, value_name = "L,H,DENSITY", value_parser = parse_bar, conflicts_with_all = ["disc", "dynamic_filter"])]
    pub(crate) bar: Option<Solid>,
    /// Radius and thickness of a disc that is free all round, in m, and its density in kg/m³: its
    /// modes then give Young's modulus
    #[arg(long, value_name = "R,H,DENSITY", value_parser = parse_disc, conflicts_with = "dynamic_filter")]
    pub(crate) disc: Option<Solid>,
    /// Licence of the recordings, kept in the tables
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub(crate) licence: String,
    /// Fit again the recordings whose results exist and are newer than they are
    #[arg(long)]
    pub(crate) redo: bool,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}

/// Parts that a fitted dynamic filter gets besides its noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BesideName {
    Modes,
    Loops,
}

/// Names of the estimators of modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum EstimatorName {
    Modal,
    Bins,
    Descent,
}

/// Commands of `malleus kit`.
#[derive(Debug, Subcommand)]
pub(crate) enum KitCommand {
    /// Make a new kit from tables, such as `malleus fit` writes: each object becomes a pad
    ///
    /// Chooses levels with which each pad peaks at -6 dBFS at velocity 1.
    New {
        /// Tables: .toml files with objects, strikers and surfaces. Without -o, the first path is
        /// the kit to write and the others are the tables
        #[arg(required = true, value_name = "TABLE")]
        tables: Vec<PathBuf>,
        /// Kit to write, as text, or in binary form if its name ends in .bin
        #[arg(short, long, value_name = "KIT.toml|KIT.bin")]
        output: Option<PathBuf>,
        /// MIDI note of the first pad; each further pad has the next note
        #[arg(long, value_name = "NOTE", default_value_t = 36, value_parser = clap::value_parser!(u8).range(0..=127))]
        first_note: u8,
    },
    /// Build the binary form of a kit, which a board reads
    Build {
        /// Kit: a .toml or .bin file, or the name of a shipped kit
        kit: String,
        /// Binary file to write
        #[arg(short, long, value_name = "KIT.bin")]
        output: PathBuf,
    },
    /// Check a kit: whether it is valid, what clips at velocity 1, and what boards leave out of it
    Check {
        /// Kit: a .toml or .bin file, or the name of a shipped kit
        kit: String,
        /// Sample rate at which its filters must be stable, in Hz, or as a ratio such as
        /// 86000000/1792
        #[arg(long, value_name = "HZ|N/D", default_value = "48000", value_parser = parse_rate)]
        rate: SampleRate,
        /// Check for that board alone and print its plan, memory and time: stm32f407g-disc1 or
        /// blackpill-f411
        #[arg(long, value_parser = parse_board)]
        board: Option<virtual_board::Board>,
        /// Print a machine-readable report on stdout (docs/json.md)
        #[arg(long)]
        json: bool,
    },
    /// Show a kit, text or binary, as text
    Show {
        /// Kit: a .toml or .bin file, or the name of a shipped kit
        kit: String,
        /// Draw the kit's modes and filters as a PNG file, too
        #[arg(long, value_name = "FILE.png")]
        plot: Option<PathBuf>,
        /// Print a machine-readable report instead of the text (docs/json.md)
        #[arg(long)]
        json: bool,
    },
}

fn parse_rate(text: &str) -> Result<SampleRate, String> {
    let (numerator, denominator) = text.split_once('/').unwrap_or((text, "1"));
    let parse = |part: &str| {
        part.parse::<u32>().map_err(|_| "must be a whole number of Hz, or a ratio such as 86000000/1792".to_owned())
    };
    SampleRate::new(parse(numerator)?, parse(denominator)?).ok_or("must be from 8000 to 192000 Hz".to_owned())
}

fn parse_budget(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|mhz: &f64| *mhz == 0.0 || (1.0..=10_000.0).contains(mhz)).ok_or_else(|| {
        "must be a number of MHz from 1 to 10000, such as 134.4 for 80 % of 168 MHz, or 0 for no limit".to_owned()
    })
}

fn parse_ceiling(text: &str) -> Result<f32, String> {
    let ceiling = text.parse().ok().filter(|db| (LOWEST_CEILING_DB..=0.0).contains(db));
    ceiling.ok_or_else(|| format!("must be from {LOWEST_CEILING_DB} to 0 dB of full scale, such as -1"))
}

fn parse_modes(text: &str) -> Result<usize, String> {
    let modes = text.parse().ok().filter(|modes| (1..=1025).contains(modes));
    modes.ok_or("must be from 1 to 1025 modes".to_owned())
}

fn parse_positions(text: &str) -> Result<u8, String> {
    let positions = text.parse().ok().filter(|positions| *positions == 1 || (4..=16).contains(positions));
    positions.ok_or("must be from 4 to 16 gains along the object, or 1 for one place".to_owned())
}

fn parse_cycles(text: &str) -> Result<f64, String> {
    let cycles = text.parse().ok().filter(|cycles| (10.0..=1e6).contains(cycles));
    cycles.ok_or("must be from 10 to 1000000 cycles per sample".to_owned())
}

fn parse_bar(text: &str) -> Result<Solid, String> {
    let [length_m, height_m, density] = parse_solid(text)?;
    match height_m <= 0.2 * length_m {
        true => Ok(Solid::Bar { length_m, height_m, density }),
        false => Err("must have a thickness of at most a fifth of the length".to_owned()),
    }
}

fn parse_disc(text: &str) -> Result<Solid, String> {
    let [radius_m, height_m, density] = parse_solid(text)?;
    match height_m <= 0.1 * radius_m {
        true => Ok(Solid::Disc { radius_m, height_m, density }),
        false => Err("must have a thickness of at most a tenth of the radius".to_owned()),
    }
}

/// Size, thickness and density of a solid.
fn parse_solid(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    let solid = <[f64; 3]>::try_from(numbers).ok().filter(|_| text.split(',').count() == 3);
    let is_possible = |[size_m, height_m, density]: &[f64; 3]| {
        (1e-3..=10.0).contains(size_m) && (1e-5..=1.0).contains(height_m) && (10.0..=25_000.0).contains(density)
    };
    solid.filter(is_possible).ok_or(
        "must be three numbers such as 0.3,0.006,7850: a size of 0.001 to 10 m, a thickness of 0.00001 to 1 m, a density of 10 to 25000 kg/m³"
            .to_owned(),
    )
}

fn parse_tail(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=3600.0).contains(seconds));
    seconds.ok_or("must be from 0 to 3600 seconds".to_owned())
}
