//! Distances between sounds.

mod background;
mod erb;
mod gradient;
mod lsd;
mod spectrogram;
mod strike;

pub(crate) use background::Background;
pub use erb::{ERB_BANDS, ErbLevels};
pub(crate) use erb::{band_power, erb_edges_hz, erb_edges_up_to_hz};
pub(crate) use gradient::Target;
pub(crate) use lsd::{LONGEST_WINDOW, log_spectral_distance_db};
pub use lsd::{LSD_SECONDS, frame_distances_db, lsd_window};
pub use spectrogram::Spectrogram;
pub use strike::{Distances, RecordedLevels, lead};
