//! One recording, many strikes, by the way of DiffImpact: Adam on spectrograms, from a random
//! start.
//!
//! ```text
//! parameters ─► force ─► modes ─► + acceleration ─► + noise ─► room ─► sound ─► loss
//!     ▲        (eq. 2-7,  (eq. 8-18)   (eq. 1)        (§3.4)   (eq. 19-23)     (§3.5)
//!     │       algorithm 1)                                                       │
//!     └──────────────────────── Adam ◄──────── gradient, by hand ◄───────────────┘
//! ```
//!
//! This is the way as published (`DiffImpact`, eq. 1 to 23, algorithm 1, analysis by synthesis of
//! §4.1), to compare [`crate::multi_strike`] with. Each file is a step and has its derivatives.
//! Numbers that the paper leaves open are those of the authors' released notebook, where it has
//! them.

mod adam;
mod bands;
mod error;
mod fit;
mod force;
mod loss;
mod model;
mod modes;
mod noise;
mod parameters;
mod room;
mod scale;
mod settings;
mod table;
#[cfg(test)]
mod tests;

pub use error::DescentError;
pub use fit::estimate;
pub use settings::Settings;
pub use table::{events, table};
