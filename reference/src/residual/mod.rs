//! The residual: the sound of an object beside its modes, as bands of decaying noise.
//!
//! *Physics-Driven Diffusion Models for Impact Sound Synthesis from Videos* (Su et al., 2023), eq.
//! 5 and 6: `R(t) = Σ_m w_m 10^(-γ_m t/20) BPF_m(noise)`. Each strike starts such a sum of its own,
//! scaled by its peak force over the object's reference force. Independent noises add in energy.

mod band;
mod expectation;
mod fourier;
mod render;

pub use band::{Band, Hold};
pub use expectation::{energy_density, envelope, power};
pub use render::{render, render_held};
