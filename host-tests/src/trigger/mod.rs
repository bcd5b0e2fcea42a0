//! Strikes that are known exactly, and a score of how well a trigger finds them.
//!
//! [`set`] lists scenes (singles over 40 dB, rolls, flams, ringing and noisy piezos, crosstalk,
//! hum), [`piezo`] turns each into ADC counts, [`score()`] compares what a trigger reports with
//! what was played. Everything comes from a seed.

pub mod listen;
pub mod on_chip;
pub mod piezo;
pub mod random;
pub mod score;
pub mod set;

pub use piezo::{Ring, Scene, Strike};
pub use score::{Found, Score, score};
