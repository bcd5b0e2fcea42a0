//! Fit of tables to recordings: the modes, contact, residual noise and room that a board plays.

pub mod audio;
pub mod bark;
pub mod bins;
pub mod contact;
pub mod descent;
pub mod distance;
pub mod dynamic_filter;
pub mod hearing;
pub mod material;
pub mod modes;
pub mod multi_strike;
pub mod recording;
pub mod render;
pub mod residual;
pub mod room;
pub mod room_prior;
pub mod score;
pub mod segment;
pub mod separate;
pub mod stages;
pub mod strike;
pub mod surface;
pub mod synthetic;
pub mod table;

mod analytic;
mod band;
mod clipping;
mod convolution;
mod decay;
mod error;
mod joint;
mod parabola;
mod random;
mod tones;
mod trim;
mod vectors;

pub use error::FitError;
