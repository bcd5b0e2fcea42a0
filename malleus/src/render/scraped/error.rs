//! Reasons for which a motion makes no force on a kit.

use dsp_core::scrape::MotionError;
use dsp_core::table::TableError;

use crate::motion::normal::GripError;

/// Refusal of a motion on a kit.
#[derive(Debug, thiserror::Error)]
pub enum ScrapedError {
    /// The kit's surfaces, or what moves over them, are refused.
    #[error("{0}")]
    Table(#[from] TableError),
    /// The object of a pad has no surface.
    #[error(
        "pad {pad}: its object {object} has no surface; give the object the keys surface = \"...\" and size_m, and the kit a table [[surface]] (malleus surface makes one)"
    )]
    NoSurface {
        /// Name of the pad.
        pad: String,
        /// Name of its object.
        object: String,
    },
    /// A striker does not scrape.
    #[error("pad {pad}: striker {striker} does not scrape; give it a table [striker.scrape]")]
    DoesNotScrape {
        /// Name of the pad.
        pad: String,
        /// Name of the striker.
        striker: String,
    },
    /// A striker does not roll.
    #[error("pad {pad}: striker {striker} does not roll; give it the tables [striker.scrape] and [striker.roll]")]
    DoesNotRoll {
        /// Name of the pad.
        pad: String,
        /// Name of the striker.
        striker: String,
    },
    /// The grip of a striker is refused.
    #[error("striker {striker}: {error}")]
    Grip {
        /// Name of the striker.
        striker: String,
        /// Reason.
        error: GripError,
    },
    /// A motion is refused by the instrument.
    #[error("at {time_s:.4} s {error}")]
    Motion {
        /// Time in seconds.
        time_s: f64,
        /// Reason.
        error: MotionError,
    },
}
