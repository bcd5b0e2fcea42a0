//! The residual: what an object sounds beside its modes, as bands of decaying noise.
//!
//! *Physics-Driven Diffusion Models for Impact Sound Synthesis from Videos* (Su et al., 2023), eq. 5
//! and 6: `R(t) = Σ_m w_m 10^(-γ_m t/20) BPF_m(noise)`. Each strike starts such a sum of its own, scaled
//! by its peak force over the object's reference force; sums of independent noises add in energy.

mod fourier;
mod law;
mod render;

pub use law::{energy_density, envelope, power};
pub use render::{render, render_held};

/// A band of decaying noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Lower and upper edge, in hertz.
    pub edges_hz: [f64; 2],
    /// Rms w at t = 0 (full scale 1).
    pub weight: f64,
    /// Decay γ, in dB/s.
    pub decay_db_per_s: f64,
}

/// A time for which a hand lies on the object, counted from the strike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// When it comes, in seconds after the strike; below 0 where it lay there before.
    pub from_s: f64,
    /// When it goes.
    pub to_s: f64,
    /// T60 that it imposes, in seconds.
    pub t60_s: f64,
}

impl Band {
    /// Decay of the amplitude, in nepers per second.
    fn decay_per_s(&self) -> f64 {
        self.decay_db_per_s * std::f64::consts::LN_10 / 20.0
    }
}
