//! Arguments of `malleus surface`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `malleus surface`.
#[derive(Debug, Args)]
pub(crate) struct SurfaceArguments {
    /// Measured surface: an .npy file with a profile or a map of heights in metres, or a .csv file
    /// with a column of heights, columns x_m,height_m, or a map with a row a line
    #[arg(value_name = "IN.npy|IN.csv")]
    pub(crate) input: PathBuf,
    /// Table to write
    #[arg(short, long, value_name = "S.toml")]
    pub(crate) output: PathBuf,
    /// Distance of the file's points in metres, where the file does not tell it
    #[arg(long, value_name = "M")]
    pub(crate) step: Option<f64>,
    /// Factor on all heights
    #[arg(long, value_name = "K", default_value = "1")]
    pub(crate) height_scale: f64,
    /// Number of points of the new profile: a power of two from 256 to 4096
    #[arg(long, value_name = "N", default_value = "4096", conflicts_with_all = ["section", "map"])]
    pub(crate) points: usize,
    /// Section of the profile as measured, from and to in metres, in place of a new profile with
    /// the statistics of the whole
    #[arg(long, value_name = "FROM,TO", value_parser = parse_section, conflicts_with = "map")]
    pub(crate) section: Option<[f64; 2]>,
    /// Map as measured, in place of a new profile
    #[arg(long)]
    pub(crate) map: bool,
    /// Shortest wavelength in metres to which the spectrum goes on with its slope, below what was
    /// measured
    #[arg(long, value_name = "M", conflicts_with_all = ["section", "map"])]
    pub(crate) extend_to: Option<f64>,
    /// Radius in metres of a ball, whose path is taken in place of the surface
    #[arg(long, value_name = "M")]
    pub(crate) tip_radius: Option<f64>,
    /// Seed of the new profile: another one has the same statistics
    #[arg(long, value_name = "N", default_value = "1", conflicts_with_all = ["section", "map"])]
    pub(crate) seed: u64,
    /// Folder for a page that shows the surface and its table; it is made if it does not exist
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// Licence of the measurement, kept in the table
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub(crate) licence: String,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}

fn parse_section(text: &str) -> Result<[f64; 2], String> {
    let wrong = || "give two numbers in metres, the smaller first, such as 0.01,0.05".to_owned();
    let (from, to) = text.split_once(',').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(wrong);
    let section = [number(from)?, number(to)?];
    if section[0] < section[1] { Ok(section) } else { Err(wrong()) }
}
