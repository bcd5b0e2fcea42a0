//! The program: arguments in, exit code out. 0 done, 1 failed, 2 wrong usage.

mod commands;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use dsp_core::SampleRate;

/// Physically modelled percussion, rendered by exactly the code that a board runs.
///
/// Without a command, plays the demo.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Play a short piece on the shipped kit: writes demo.wav and demo.png, prints a row a pad
    Demo(DemoArguments),
    /// Play a kit: events or a direct force in, a 24-bit stereo WAV file out
    Play(PlayArguments),
    /// Fit recordings of something being struck: a table each
    Fit(FitArguments),
    /// Build, check and show kits
    #[command(subcommand)]
    Kit(KitCommand),
    /// Run firmware on a virtual board
    #[command(subcommand)]
    Board(commands::board::BoardCommand),
}

/// Arguments of `malleus demo`.
#[derive(Debug, Args)]
struct DemoArguments {
    /// Folder for demo.wav and demo.png, made where it is missing
    #[arg(long, value_name = "DIR", default_value = "malleus-demo")]
    out: PathBuf,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Arguments of `malleus play`.
#[derive(Debug, Args)]
struct PlayArguments {
    /// Kit: a .toml or .bin file, or the name of a shipped kit (demo, recorded, filters)
    #[arg(long)]
    kit: String,
    /// Events: CSV (sample|time_s,pad,velocity[,position,striker,action]) or a Standard MIDI File
    #[arg(long, value_name = "FILE", required_unless_present = "direct", conflicts_with = "direct")]
    strikes: Option<PathBuf>,
    /// Force that drives a pad sample by sample: a WAV file, full scale = the object's reference force; channels count from 0
    #[arg(long, value_name = "FILE[:CHANNEL]", requires = "pad")]
    direct: Option<String>,
    /// Pad that the direct force drives
    #[arg(long, value_name = "NAME", requires = "direct")]
    pad: Option<String>,
    /// Where the sound goes
    #[arg(short, long, value_name = "OUT.wav")]
    output: PathBuf,
    /// Sample rate in Hz, or as a ratio such as 86000000/1792 [default: 48000, with --direct the file's own]
    #[arg(long, value_name = "HZ|N/D", value_parser = parse_rate)]
    rate: Option<SampleRate>,
    /// Play as that board does, at its rate, with its room, within its budget and without what it
    /// leaves out: stm32f407g-disc1 or blackpill-f411
    #[arg(long, value_parser = commands::board::parse_board, conflicts_with_all = ["rate", "reference", "no_skip"])]
    board: Option<virtual_board::Board>,
    /// Frames a block; any block gives the same bits. With --board always the board's 32
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    block: u32,
    /// Seconds that follow the last event or the force's end [default: until it has rung down by 96 dB, at most 30]
    #[arg(long, value_name = "SECONDS", value_parser = parse_tail)]
    tail: Option<f64>,
    /// Render by the f64 reference instead of the instrument
    #[arg(long, conflicts_with = "no_skip")]
    reference: bool,
    /// Run every mode in every frame, skip nothing
    #[arg(long)]
    no_skip: bool,
    /// Cycles a second of a Cortex-M4 that may be spent, in MHz; what does not fit is left out, the
    /// quietest first. 0 is no limit [default: that of the
    /// --board, unless the events are a log with what it left out; without a board no limit]
    #[arg(long, value_name = "MHZ", value_parser = parse_budget, conflicts_with_all = ["reference", "no_skip"])]
    budget_mhz: Option<f64>,
    /// Write all events that were played, what was left out for want of time among them, as CSV: played back it gives the same bits
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["reference", "direct"])]
    log: Option<PathBuf>,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Arguments of `malleus fit`.
#[derive(Debug, Args)]
struct FitArguments {
    /// Recordings: WAV, FLAC, AIFF, Ogg Vorbis, MP3, AAC, ALAC, CAF
    #[arg(required = true)]
    input: Vec<PathBuf>,
    /// Where the table goes: a .toml file, or a folder for one table a recording
    #[arg(short, long, value_name = "TABLE.toml|DIR")]
    output: PathBuf,
    /// Modes at most
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = parse_modes)]
    modes: usize,
    /// How modes are found: `modal` all together by maximum likelihood; `bins` one a bin of a spectrogram, for comparison
    #[arg(long, value_enum, value_name = "NAME", default_value_t = EstimatorName::Modal)]
    estimator: EstimatorName,
    /// Fit noise through a moving filter in place of modes and residual, with at most ten modes beside it or ten loops round it (docs/dynamic-filter-fits.md)
    #[arg(long, value_enum, value_name = "WITH", conflicts_with_all = ["modes", "estimator", "force_channel", "hits", "budget", "report"])]
    dynamic_filter: Option<BesideName>,
    /// Channel of the measured force, counted from 0
    #[arg(long, value_name = "C")]
    force_channel: Option<usize>,
    /// Strikes to use, counted from 1 [default: all]
    #[arg(long, value_name = "N,N", value_delimiter = ',')]
    hits: Vec<usize>,
    /// Cortex-M4 cycles a sample that the table may take while it is struck: keeps the modes that matter most
    #[arg(long, value_name = "CYCLES", value_parser = parse_cycles)]
    budget: Option<f64>,
    /// Write the instrument's rendering of the loudest strike, aligned to the recording
    #[arg(long, value_name = "OUT.wav")]
    render: Option<PathBuf>,
    /// Write a self-contained page of sound, pictures and figures for each recording into this folder, and an index of all pages in it
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Licence of the recordings, kept in the tables
    #[arg(long, value_name = "TEXT", default_value = "")]
    licence: String,
    /// Fit again what is done already
    #[arg(long)]
    redo: bool,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// What a dynamic filter has beside its noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum BesideName {
    Modes,
    Loops,
}

/// Names of the estimators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum EstimatorName {
    Modal,
    Bins,
}

#[derive(Debug, Subcommand)]
enum KitCommand {
    /// Bind tables, such as `malleus fit` writes, to the pads of a new kit
    ///
    /// Chooses levels with which each pad peaks at -6 dBFS at velocity 1.
    New {
        /// Tables: .toml files with objects and strikers; each object becomes a pad. Without -o,
        /// the first is the new kit
        #[arg(required = true, value_name = "TABLE")]
        tables: Vec<PathBuf>,
        /// The new kit, text
        #[arg(short, long, value_name = "KIT.toml")]
        output: Option<PathBuf>,
        /// MIDI note of the first pad; the others follow
        #[arg(long, value_name = "NOTE", default_value_t = 36, value_parser = clap::value_parser!(u8).range(0..=127))]
        first_note: u8,
    },
    /// Build the binary form that a board reads
    Build {
        /// Kit as text
        kit: String,
        /// Where the binary goes
        #[arg(short, long, value_name = "KIT.bin")]
        output: PathBuf,
    },
    /// Check a kit, text or binary: whether it is valid, what clips at velocity 1, and what boards
    /// leave out of it
    Check {
        /// Kit: a .toml or .bin file, or the name of a shipped kit
        kit: String,
        /// Sample rate at which its filters must be stable, in Hz, or as a ratio such as 86000000/1792
        #[arg(long, value_name = "HZ|N/D", default_value = "48000", value_parser = parse_rate)]
        rate: SampleRate,
        /// Print a machine-readable report on stdout (docs/json.md)
        #[arg(long)]
        json: bool,
    },
    /// Show a kit, text or binary, as text
    Show {
        /// Kit: a .toml or .bin file, or the name of a shipped kit
        kit: String,
        /// Draw its modes, too
        #[arg(long, value_name = "FILE.png")]
        plot: Option<PathBuf>,
        /// Print a machine-readable report instead of the text (docs/json.md)
        #[arg(long)]
        json: bool,
    },
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = match arguments.command {
        None => commands::demo::run(&DemoArguments { out: PathBuf::from("malleus-demo"), json: false }),
        Some(Command::Demo(arguments)) => commands::demo::run(&arguments),
        Some(Command::Play(arguments)) => commands::play::run(&arguments),
        Some(Command::Fit(arguments)) => commands::fit::run(&arguments),
        Some(Command::Kit(command)) => commands::kit::run(&command),
        Some(Command::Board(command)) => commands::board::run(&command),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("malleus: {error}");
            ExitCode::FAILURE
        }
    }
}

fn parse_rate(text: &str) -> Result<SampleRate, String> {
    let (numerator, denominator) = text.split_once('/').unwrap_or((text, "1"));
    let parse = |part: &str| part.parse::<u32>().map_err(|_| "must be a whole number of Hz, or N/D".to_owned());
    SampleRate::new(parse(numerator)?, parse(denominator)?).ok_or("must be from 8000 to 192000 Hz".to_owned())
}

fn parse_budget(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|mhz: &f64| *mhz == 0.0 || (1.0..=10_000.0).contains(mhz)).ok_or_else(|| {
        "must be a number of MHz from 1 to 10000, such as 134.4 for 80 % of 168 MHz, or 0 for no limit".to_owned()
    })
}

fn parse_modes(text: &str) -> Result<usize, String> {
    let modes = text.parse().ok().filter(|modes| (1..=1024).contains(modes));
    modes.ok_or("must be from 1 to 1024 modes".to_owned())
}

fn parse_cycles(text: &str) -> Result<f64, String> {
    let cycles = text.parse().ok().filter(|cycles| (10.0..=1e6).contains(cycles));
    cycles.ok_or("must be from 10 to 1000000 cycles a sample".to_owned())
}

fn parse_tail(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=3600.0).contains(seconds));
    seconds.ok_or("must be from 0 to 3600 seconds".to_owned())
}
