//! Errors of a surface's fit.

use std::path::PathBuf;

use kit::counting::counted;

use super::options::Note;

/// Reason why no table can be made of a surface. Its message says what is wrong, where, and what to
/// do.
#[derive(Debug, thiserror::Error)]
pub enum SurfaceError {
    /// The file cannot be opened or read.
    #[error("{}: the file cannot be read ({cause}): check its path and permissions", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        cause: std::io::Error,
    },
    /// The file's name ends neither in `.npy` nor in `.csv`.
    #[error("{}: not known as a surface: give an NPY or a CSV file", path.display())]
    Format {
        /// Path of the file.
        path: PathBuf,
    },
    /// The file is no NPY file, or is cut.
    #[error("{}: not a whole NPY file ({reason}): save it anew with numpy.save", path.display())]
    NotNpy {
        /// Path of the file.
        path: PathBuf,
        /// Part that is missing.
        reason: &'static str,
    },
    /// The numbers of an NPY file are of a type that heights do not have.
    #[error("{}: numbers of the type {found}: save heights as floats of 16 to 64 bits or integers of 8 to 64", path.display())]
    NumberType {
        /// Path of the file.
        path: PathBuf,
        /// Type in NumPy's notation.
        found: String,
    },
    /// The array has neither one nor two dimensions.
    #[error("{}: an array of the shape {shape:?}: give a profile (one dimension) or a map (two)", path.display())]
    Shape {
        /// Path of the file.
        path: PathBuf,
        /// Lengths of the array.
        shape: Vec<usize>,
    },
    /// A line of a CSV file holds no numbers, or another number of them than the others.
    #[error("{}, line {line}: {cause}: give a column of heights, columns x_m,height_m, or a map with a row a line, its numbers separated by commas or blanks", path.display())]
    CsvLine {
        /// Path of the file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: u64,
        /// Reason.
        cause: String,
    },
    /// The head of a CSV file names a column of another unit than metres, or columns in disorder.
    #[error("{}, line {line}: {cause}: give heights, or columns x_m,height_m, in metres", path.display())]
    CsvHead {
        /// Path of the file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: u64,
        /// Reason.
        cause: String,
    },
    /// Positions of a profile do not grow.
    #[error("{}, line {line}: the position does not grow: sort the profile by position", path.display())]
    Order {
        /// Path of the file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: u64,
    },
    /// The file does not tell the distance of its points.
    #[error("{}: the file does not tell the distance of its points: give it in metres with --step", path.display())]
    NoStep {
        /// Path of the file.
        path: PathBuf,
    },
    /// An option's number is out of range.
    #[error("{option} {value}: {range}")]
    Range {
        /// Name of the option.
        option: &'static str,
        /// Value that was given.
        value: f64,
        /// Range in words.
        range: &'static str,
    },
    /// Too few points to tell a surface.
    #[error(
        "{} a row is too few to tell a surface: give a profile, or rows of a map, of at least {least}",
        counted(*points, "points")
    )]
    TooFew {
        /// Number of points of a row.
        points: usize,
        /// Least number.
        least: usize,
    },
    /// Most points are missing.
    #[error(
        "{percent:.0} % of the points are missing: at most half may be; measure the surface anew or cut the hole off"
    )]
    Missing {
        /// Share of missing points in percent.
        percent: f64,
    },
    /// All heights are equal, or one line.
    #[error("the surface is flat: it has no heights beside a straight line, so that nothing sounds")]
    Flat,
    /// The surface is shorter than a table of its shortest waves asks.
    #[error(
        "the profile is {length_m:.3e} m long, 40 of its shortest waves of {shortest_m:.3e} m at least are needed: give a longer one"
    )]
    TooShort {
        /// Length in metres.
        length_m: f64,
        /// Shortest wavelength in metres.
        shortest_m: f64,
    },
    /// A side of the map is shorter than a map asks.
    #[error(
        "a side of the map is {side_m:.3e} m long, 10 of its shortest waves of {shortest_m:.3e} m at least are needed: give a larger map, or leave --map out"
    )]
    MapTooSmall {
        /// Length of the shorter side in metres.
        side_m: f64,
        /// Shortest wavelength in metres.
        shortest_m: f64,
    },
    /// The section lies outside the profile.
    #[error(
        "--section {from_m},{to_m}: the profile reaches from 0 to {length_m:.5} m, and a section has at least 20 waves of {shortest_m:.3e} m"
    )]
    Section {
        /// Beginning of the section in metres.
        from_m: f64,
        /// End of the section in metres.
        to_m: f64,
        /// Length of the profile in metres.
        length_m: f64,
        /// Shortest wavelength in metres.
        shortest_m: f64,
    },
    /// `--map` was given for a profile.
    #[error("--map: the file holds one profile, not a map: leave --map out")]
    NoMap,
    /// No kit takes heights as large or small as these, which look as if they were in another unit.
    #[error("no kit takes this table: {note}")]
    Unit {
        /// Doubt about the unit, with advice.
        note: Note,
    },
    /// A kit does not take the table.
    #[error(
        "no kit takes this table ({cause}): if it is too large or too small give another --section or --extend-to, else look whether heights and steps are in metres (--height-scale, --step)"
    )]
    NotOfKit {
        /// Refusal of the kit.
        cause: Box<kit::KitError>,
    },
}
