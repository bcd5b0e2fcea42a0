#![no_std]
#![doc = "Malleus' instrument, from trigger to samples."]

#[cfg(test)]
extern crate std;

pub mod biquad;
pub mod built;
pub mod contact;
pub mod dynamic_filter;
pub mod engine;
pub mod event;
pub mod fixed;
pub mod frames;
pub mod limiter;
pub mod memory;
pub mod midi;
pub mod noise;
pub mod output;
pub mod radiation;
pub mod residual;
pub mod resonator;
pub mod room;
pub mod scrape;
pub mod table;
pub mod time;
pub mod trigger;
pub mod voice;
pub mod waveguide;

#[cfg(cortex_m4f)]
mod clear;
mod exponential;
mod fourier;
mod rate;
mod sine;
mod square_root;

pub use rate::SampleRate;
