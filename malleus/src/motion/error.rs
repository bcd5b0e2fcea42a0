//! Reasons for which a motion is refused.

use std::path::PathBuf;

use super::path::Action;
use super::speed::MOST_SPEED_M_PER_S;

/// Refusal of a file of a motion: it cannot be read, or no tool can move like this.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct MotionError {
    /// Path of the refused file.
    pub path: PathBuf,
    /// Reason of the refusal.
    pub fault: MotionFault,
}

/// Reason for which the content of a file of a motion is refused. Lines count from 1.
#[derive(Debug, thiserror::Error)]
pub enum MotionFault {
    /// The file cannot be read from disk.
    #[error("{}", .0.reason())]
    File(#[from] kit::file::FileError),
    /// The file is binary, or text in another encoding than UTF-8. The offset of the first such
    /// byte counts from 0.
    #[error(
        "not text in UTF-8 (byte {offset} is not); give a motion as CSV: time_s,pad,action,striker,x_m,y_m,normal_n"
    )]
    NotText {
        /// Offset of the first byte that is not UTF-8 or is a NUL.
        offset: usize,
    },
    /// A line has more or fewer fields than the header.
    #[error(
        "line {line}: the number of fields is {found}; the header has {expected}, and every line must have as many"
    )]
    FieldCount {
        /// Line of the file.
        line: u64,
        /// Number of fields on the line.
        found: u64,
        /// Number of fields in the header.
        expected: u64,
    },
    /// The header lacks a column, repeats one, or has an unknown one.
    #[error(
        "line 1: {0}; the header is `time_s,pad,action,x_m` or `sample,pad,action,x_m`, then any of `striker`, `y_m`, `normal_n`"
    )]
    Header(String),
    /// A field holds a value that is not allowed there, such as an unknown pad, striker or action,
    /// a number that is not finite, or a negative force.
    #[error("line {line}: {column} = {value:?}: {allowed}")]
    Field {
        /// Line of the file.
        line: u64,
        /// Name of the column.
        column: &'static str,
        /// Refused value, as it stands in the file.
        value: String,
        /// Values that are allowed in the field, in words.
        allowed: String,
    },
    /// A line is not later than the one before it, by at least a nanosecond.
    #[error(
        "line {line}: its time {time_s} s is not later than {before_s} s on the line before; sort the file by time, with one line a time"
    )]
    OutOfOrder {
        /// Line of the file.
        line: u64,
        /// Time of the line in seconds.
        time_s: f64,
        /// Time of the line before in seconds.
        before_s: f64,
    },
    /// The tool is lifted off a pad that it has never touched.
    #[error("line {line}: lift off pad {pad} before it is touched; begin with a line of scrape or roll")]
    LiftBeforeTouch {
        /// Line of the file.
        line: u64,
        /// Name of the pad.
        pad: String,
    },
    /// The tool is lifted off a pad from which it is lifted already.
    #[error("line {line}: pad {pad} is lifted already; leave the line out, or touch the pad again by scrape or roll")]
    LiftAfterLift {
        /// Line of the file.
        line: u64,
        /// Name of the pad.
        pad: String,
    },
    /// A contact has one place only, so that it has no path.
    #[error(
        "line {line}: the contact with pad {pad} has this place alone; give at least two lines with a place, the last of which may be the lift"
    )]
    SingleLine {
        /// Line of the file on which the contact begins.
        line: u64,
        /// Name of the pad.
        pad: String,
    },
    /// A tool that scrapes begins to roll, or the other way round, while it touches a pad.
    #[error("line {line}: {after} on pad {pad} while it is touched by {before}; lift first")]
    ActionChanged {
        /// Line of the file.
        line: u64,
        /// Name of the pad.
        pad: String,
        /// Action of the contact so far.
        before: Action,
        /// Action of the line.
        after: Action,
    },
    /// Another striker takes over while a pad is touched.
    #[error("line {line}: another striker on pad {pad} while it is touched; lift first")]
    StrikerChanged {
        /// Line of the file.
        line: u64,
        /// Name of the pad.
        pad: String,
    },
    /// A pad is touched while another one still is.
    #[error(
        "line {line}: pad {pad} is touched while pad {touched} still is; one pad at a time can be scraped or rolled over: lift off {touched} first"
    )]
    TwoPads {
        /// Line of the file.
        line: u64,
        /// Name of the pad on the line.
        pad: String,
        /// Name of the pad that is touched already.
        touched: String,
    },
    /// The path is too fast at some time.
    #[error(
        "line {line}: {speed_m_per_s:.4} m/s at {time_s:.6} s, on the way to this line; at most {MOST_SPEED_M_PER_S} m/s: give more time or a shorter way"
    )]
    TooFast {
        /// Line of the file at the end of the way that is too fast.
        line: u64,
        /// Time in seconds at which the way is fastest.
        time_s: f64,
        /// Speed there in metres per second.
        speed_m_per_s: f64,
    },
    /// The file has no line that touches a pad.
    #[error("it touches no pad; give lines of scrape or roll")]
    NoContact,
}
