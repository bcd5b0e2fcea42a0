//! How far one sound is from another.

mod gradient;
mod lsd;
mod spectrogram;

pub(crate) use gradient::Target;
pub use lsd::{LSD_SECONDS, frame_distances_db, log_spectral_distance_db, lsd_window};
pub use spectrogram::Spectrogram;
