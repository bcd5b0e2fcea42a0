//! From a measured surface to the small table of heights that a scraper or a ball moves over.
//!
//! ```text
//! file ─► heights ─► filled ─► profile ─► shortest wave ─► statistics ─► synthesis ─► table
//!          (m, step)  (holes)  (line off,   (below it lies    (spectrum,    (periodic,
//!                               tip, rows)   no measurement)   curvatures)   4096 points)
//! ```
//!
//! The force on a scraper follows the curvature of the surface under it (scraping-rolling eq. 1 to
//! 5), so that the curvature decides what a table has to keep: its spectrum, and how spiky it is
//! in each octave. A file is longer than a chip's flash. A table is a short surface that has the
//! statistics of the whole file (scraping-rolling §2.2 and §6), or, on request, a section of it as
//! measured.

mod csv_file;
mod error;
mod extension;
mod file;
mod filled;
mod fit;
mod heights;
mod holes;
mod map;
mod npy_file;
mod options;
mod profile;
mod report;
mod section;
mod shortest;
mod spectrum;
mod statistics;
mod synthesis;
mod table;
mod tip;
mod waves;

pub use error::SurfaceError;
pub use file::read;
pub use fit::fit;
pub use heights::Heights;
pub use options::{Note, Options, Source};
pub use report::{BandLevel, Report};
pub use table::Table;
