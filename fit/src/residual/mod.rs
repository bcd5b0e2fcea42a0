//! The residual of the modes: noise in bands that each decay at their own rate (physics-diffusion
//! eq. 5, 6).
//!
//! `R(t) = Σ_m w_m 10^{-γ_m t/20} B_m(t)`, with B_m Gaussian noise of unit rms in band m. The paper
//! trains an encoder for weights and decays. Here they are fitted, band by band, so that modes and
//! noise together are expected to be nearest to the recording's levels on the ERB scale (`levels`).
//! Then those bands are kept that do not raise the log-spectral distance (`admit`).

mod admit;
mod levels;
mod noise;
mod spread;
mod table;

pub use crate::band::{Band, usual_edges_hz};
pub use admit::admit;
pub use levels::{fit_bands, prior_edges_hz};
pub use noise::render;
pub use table::{with_bands, with_residual};
