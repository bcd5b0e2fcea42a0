//! How far one sound is from another.

mod lsd;
mod spectrogram;

pub use lsd::{LSD_SECONDS, log_spectral_distance_db, lsd_window};
pub use spectrogram::Spectrogram;
