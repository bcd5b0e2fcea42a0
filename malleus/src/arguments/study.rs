//! Arguments of `malleus study`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// Commands of `malleus study`: one for each experiment.
#[derive(Debug, Subcommand)]
pub(crate) enum StudyCommand {
    /// Realism of scrapes (Experiment 1), or with --stand-in which motion is heard (Experiment 2)
    Scraping(ScrapingStudyArguments),
    /// Realism of balls that roll (Experiment 3)
    Rolling(RollingStudyArguments),
}

/// Arguments of `malleus study scraping`.
#[derive(Debug, Args)]
pub(crate) struct ScrapingStudyArguments {
    /// Folder for index.html, the page on which sounds are rated, and the sounds; it is made if it
    /// does not exist
    #[arg(short, long, value_name = "DIR", required_unless_present = "stand_in")]
    pub(crate) output: Option<PathBuf>,
    /// Let a program in place of listeners tell five motions apart, and print what it confuses
    #[arg(long)]
    pub(crate) stand_in: bool,
    /// Renderings of each motion from which the program learns, and as many by which it is tested,
    /// from 4 to 1000
    #[arg(long, value_name = "N", default_value_t = 40, requires = "stand_in", value_parser = clap::value_parser!(u32).range(4..=1000))]
    pub(crate) renderings: u32,
    /// Seed of the renderings
    #[arg(long, value_name = "N", default_value_t = 1, requires = "stand_in")]
    pub(crate) seed: u32,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}

/// Arguments of `malleus study rolling`.
#[derive(Debug, Args)]
pub(crate) struct RollingStudyArguments {
    /// Folder for index.html, the page on which sounds are rated, and the sounds; it is made if it
    /// does not exist
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}
