//! From a piezo's voltage to strikes, in double precision and in plain steps.
//!
//! ```text
//!  ADC counts ──(-)──► |x| ──► smoothed ──► > level? ──► largest |x| within the scan time ──► crosstalk? ──► velocity
//!                ▲                             ▲
//!   offset, mains hum                threshold, noise, ringing
//! ```
//!
//! Bookkeeping (offset and hum, noise, mask) happens every [`TICK_FRAMES`] frames, as on the board; all else frame by frame. Signals
//! are in ADC counts. What is ours and not from a paper stands beside each step.

mod baseline;
mod detector;
mod mask;
mod piezo;
mod resample;
mod settings;

pub use detector::{Strike, detect};
pub use resample::resample;
pub use settings::{PiezoSettings, Rim};

/// Frames between two rounds of bookkeeping.
pub const TICK_FRAMES: usize = 32;
/// Half the range of a 12-bit ADC, in counts.
pub const HALF_RANGE_COUNTS: f64 = 2048.0;
/// The largest count of a 12-bit ADC.
pub const LAST_COUNT: u16 = 4095;
