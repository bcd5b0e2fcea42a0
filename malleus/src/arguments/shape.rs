//! Arguments of `malleus shape`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `malleus shape`.
#[derive(Debug, Args)]
pub(crate) struct ShapeArguments {
    /// Shape file: outline, thickness, material, support, strikes (docs/shape.md)
    #[arg(value_name = "SHAPE.toml", required_unless_present_any = ["benchmarks", "materials"])]
    pub(crate) input: Option<PathBuf>,
    /// Table to write
    #[arg(short, long, value_name = "TABLE.toml", required_unless_present_any = ["benchmarks", "materials"])]
    pub(crate) output: Option<PathBuf>,
    /// Number of modes, the lowest; silent ones count too. 32, if neither a frequency nor a budget
    /// is given
    #[arg(long, value_name = "N", conflicts_with_all = ["max_hz", "budget"])]
    pub(crate) modes: Option<usize>,
    /// All modes up to a frequency in Hz
    #[arg(long, value_name = "F", conflicts_with = "budget")]
    pub(crate) max_hz: Option<f64>,
    /// Budget in Cortex-M4 cycles a sample: the lowest modes that it can play, 9.42 cycles each
    #[arg(long, value_name = "CYCLES")]
    pub(crate) budget: Option<f64>,
    /// Error of each frequency to which the mesh is made finer, as a share: 0.001 is 0.1 %. No mesh
    /// mends the theory of thick or clamped plates and of wood: where that errs by nearly as much
    /// or more, the printed estimate is above this number (docs/shape.md)
    #[arg(long, value_name = "E", default_value = "0.001")]
    pub(crate) error: f64,
    /// Sound of a strike at each position, a second apart, as a WAV file
    #[arg(long, value_name = "OUT.wav")]
    pub(crate) render: Option<PathBuf>,
    /// Folder for index.html, a page with drawings, charts and sounds of the modes; it is made if
    /// it does not exist
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// Cut an arch into the lower side of a plain bar, a sheet seen from its side, so that its
    /// bending modes have these ratios, such as 1:4:10; the table is that of the tuned bar
    #[arg(long, value_name = "1:R:R", requires = "tuned", value_parser = parse_ratios)]
    pub(crate) undercut: Option<Ratios>,
    /// Shape file of the tuned bar to write
    #[arg(long, value_name = "TUNED.toml", requires = "undercut")]
    pub(crate) tuned: Option<PathBuf>,
    /// Frequency of the tuned bar's lowest mode in Hz: the bar is cut to the length that has it
    #[arg(long, value_name = "F", requires = "undercut")]
    pub(crate) hz: Option<f64>,
    /// Licence of the table
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub(crate) licence: String,
    /// Print frequencies of published benchmarks (NAFEMS FV12, FV16, FV32, FV52) beside the
    /// computed ones, in place of a shape
    #[arg(long, conflicts_with_all = ["input", "output", "render", "report"])]
    pub(crate) benchmarks: bool,
    /// List the shipped materials, in place of a shape
    #[arg(long, conflicts_with_all = ["input", "output", "benchmarks"])]
    pub(crate) materials: bool,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}

/// Frequencies of the first modes as multiples of the lowest.
#[derive(Clone, Debug)]
pub(crate) struct Ratios(pub(crate) Vec<f64>);

fn parse_ratios(text: &str) -> Result<Ratios, String> {
    let ratios: Result<Vec<f64>, _> = text.split(':').map(|ratio| ratio.trim().parse()).collect();
    ratios.map(Ratios).map_err(|_| "must be numbers with colons between them, such as 1:4:10".to_owned())
}
