//! Trigger: from a piezo's voltage to strikes, in double precision and in plain steps.
//!
//! ```text
//!  ADC counts ──(-)──► |x| ──► smoothed ──► > level? ──► largest |x| ──► crosstalk? ──► velocity
//!                ▲                             ▲         in scan time
//!   offset, mains hum              threshold, noise, ringing
//! ```
//!
//! Bookkeeping (offset and hum, noise, mask) happens every [`TICK_FRAMES`] frames, as on the board.
//! All else happens frame by frame. Signals are in ADC counts.

mod adc;
mod baseline;
mod detector;
mod mask;
mod piezo;
mod resample;
mod settings;

pub use adc::{HALF_RANGE_COUNTS, LAST_COUNT, TICK_FRAMES};
pub use detector::{Strike, detect};
pub use resample::resample;
pub use settings::{PiezoSettings, Rim};
