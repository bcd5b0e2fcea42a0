//! How far one sound is from another.

mod erb;
mod gradient;
mod lsd;
mod spectrogram;

pub(crate) use erb::band_power;
pub use erb::{ERB_BANDS, ErbLevels, erb_edges_hz};
pub(crate) use gradient::Target;
pub use lsd::{LSD_SECONDS, frame_distances_db, log_spectral_distance_db, lsd_window};
pub use spectrogram::Spectrogram;
