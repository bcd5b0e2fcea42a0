//! Arguments of `malleus motion`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// Commands of `malleus motion`: one for each path.
#[derive(Debug, Subcommand)]
pub(crate) enum MotionCommand {
    /// Strokes there and back
    BackAndForth(StrokesArguments),
    /// Strokes with the speeds of back-and-forth, one behind the other in a straight line
    FourStrokes(StrokesArguments),
    /// One turn of a circle at a constant speed
    Circle(SteadyArguments),
    /// Straight line with the speeds of the circle
    Line(SteadyArguments),
    /// Smooth random path, drawn from --seed
    Scribble(ScribbleArguments),
    /// Solid ball that rolls up or down an incline
    Roll(RollArguments),
}

/// Arguments of `malleus motion back-and-forth` and `four-strokes`.
#[derive(Debug, Args)]
pub(crate) struct StrokesArguments {
    /// Length of a stroke in metres, from 0.001 to 100
    #[arg(long, value_name = "M", default_value = "0.2")]
    pub(crate) length: f64,
    /// Time of two strokes in seconds, from 0.002 to 60
    #[arg(long, value_name = "SECONDS", default_value = "1")]
    pub(crate) period: f64,
    /// Number of strokes, from 1 to 1000
    #[arg(long, value_name = "N", default_value = "4")]
    pub(crate) strokes: u32,
    #[command(flatten)]
    pub(crate) file: MotionFileArguments,
}

/// Arguments of `malleus motion circle` and `line`.
#[derive(Debug, Args)]
pub(crate) struct SteadyArguments {
    /// Length of the path in metres, from 0.001 to 100: of a circle the circumference
    #[arg(long, value_name = "M", default_value = "0.6")]
    pub(crate) length: f64,
    /// Speed in m/s between start and end, from 0.001 to 10
    #[arg(long, value_name = "M/S", default_value = "0.4")]
    pub(crate) speed: f64,
    #[command(flatten)]
    pub(crate) file: MotionFileArguments,
}

/// Arguments of `malleus motion scribble`.
#[derive(Debug, Args)]
pub(crate) struct ScribbleArguments {
    /// Length of the path in metres, from 0.001 to 100
    #[arg(long, value_name = "M", default_value = "0.8")]
    pub(crate) length: f64,
    /// Mean speed in m/s between start and end, from 0.001 to 10; at most 10 anywhere on the path
    #[arg(long, value_name = "M/S", default_value = "0.4")]
    pub(crate) speed: f64,
    #[command(flatten)]
    pub(crate) file: MotionFileArguments,
}

/// Arguments of `malleus motion roll`.
#[derive(Debug, Args)]
pub(crate) struct RollArguments {
    /// Length of the incline in metres, from 0.001 to 100
    #[arg(long, value_name = "M", default_value = "0.5")]
    pub(crate) length: f64,
    /// Speed at the beginning in m/s: 0, or from 0.001 to 10; at most 10 anywhere on the path
    #[arg(long, value_name = "M/S", default_value = "0.1")]
    pub(crate) speed: f64,
    /// Angle in degrees from -80 to 80: positive uphill, where a ball that stops before the end
    /// rolls back, and negative downhill
    #[arg(long, value_name = "DEGREES", default_value = "-2", allow_hyphen_values = true)]
    pub(crate) incline: f64,
    #[command(flatten)]
    pub(crate) file: MotionFileArguments,
}

/// Arguments of all commands of `malleus motion`.
#[derive(Debug, Args)]
pub(crate) struct MotionFileArguments {
    /// Motion to write: CSV with the columns time_s,pad,action,striker,x_m,y_m,normal_n
    #[arg(short, long, value_name = "M.csv")]
    pub(crate) output: PathBuf,
    /// Pad that is touched: its name, or its number counted from 0
    #[arg(long, value_name = "PAD", default_value = "0")]
    pub(crate) pad: String,
    /// Striker of the pad [default: the pad's first]
    #[arg(long, value_name = "NAME", default_value = "", hide_default_value = true)]
    pub(crate) striker: String,
    /// Time of the first touch in seconds, from 0 to 3600
    #[arg(long, value_name = "SECONDS", default_value = "0")]
    pub(crate) start: f64,
    /// Place of the first touch in metres
    #[arg(long, value_name = "X,Y", default_value = "0,0", value_parser = parse_place, allow_hyphen_values = true)]
    pub(crate) at: [f64; 2],
    /// Change length and speed by random factors from 0.71 to 1.41, and begin up to 0.3 s later
    /// and 0.05 m beside, all drawn from --seed
    #[arg(long)]
    pub(crate) vary: bool,
    /// Seed of a scribble's path, and of --vary
    #[arg(long, value_name = "N", default_value = "1")]
    pub(crate) seed: u32,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}

fn parse_place(text: &str) -> Result<[f64; 2], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let place = numbers.and_then(|numbers| <[f64; 2]>::try_from(numbers).ok());
    place.ok_or_else(|| "must be two numbers in metres, such as 0.1,-0.05".to_owned())
}
