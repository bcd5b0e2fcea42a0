//! One object struck: from the strikes of a recording to modes, gains, contact times.

mod force;
mod high_pass;
mod sound;

pub use force::{MeasuredHit, Place, Shared, fit_force, force_width_s, measured_hits, share_poles};
pub use high_pass::high_pass;
pub use sound::fit_sound;

use nalgebra::Complex;
use serde::Serialize;

use crate::modes::{Gains, Settings as ModeSettings};
use crate::segment::Hit;

/// Which estimator finds the modes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// Maximum likelihood over all damped sines together ([`crate::modes`]).
    #[default]
    Modal,
    /// One mode a bin of a spectrogram (physics-diffusion §3.1, [`crate::bins`]), of the loudest strike alone.
    Bins,
}

/// How to fit.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// The estimator.
    pub estimator: Estimator,
    /// The modal estimator's settings.
    pub modes: ModeSettings,
    /// Whether a descent on the log-spectral distance follows the maximum-likelihood estimate.
    pub polish: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { estimator: Estimator::Modal, modes: ModeSettings::default(), polish: true }
    }
}

/// A mode of an object and how each strike excites it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Decay rate in 1/s.
    pub decay_per_s: f64,
    /// `[sine, cosine]` gains in output per newton-second, as tables define them: from sound alone one pair a strike, with a measured force one
    /// pair a position.
    pub gains: Vec<[f64; 2]>,
}

impl Mode {
    /// T60 in seconds.
    pub fn t60_s(&self) -> f64 {
        1000f64.ln() / self.decay_per_s
    }
}

/// One strike as it was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Strike {
    /// Where in the recording.
    pub hit: Hit,
    /// Contact time in seconds.
    pub contact_time_s: f64,
    /// Peak of the force: 1 from sound alone, else as measured (full scale = 1).
    pub peak_force: f64,
    /// Where it strikes, from 0 to 1 along the positions at which there are gains; 0 from sound alone.
    pub position: f64,
    /// Acceleration sound, output per newton, as tables define it.
    pub acceleration: f64,
    /// Log-spectral distance in dB between recording and model over 0.25 s from 20 samples before the peak.
    pub lsd_db: f64,
    /// Energy that the model leaves of the strike, dB.
    pub residual_db: f64,
}

/// A fitted object. From sound alone, forces have a peak of 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Sample rate of the recording in Hz.
    pub rate_hz: f64,
    /// Modes in order of frequency.
    pub modes: Vec<Mode>,
    /// The strikes, in order of time.
    pub strikes: Vec<Strike>,
    /// Whether the force was measured: then gains are those at positions, else those of strikes.
    pub measured: bool,
    /// Index of the loudest strike, whose gains a table takes where the force was not measured.
    pub loudest: usize,
}

/// `Σ F[m] Re(g z^(n-m))` as sine and cosine gains of a table, whose response is the sum over samples divided by the rate.
fn table_gain(gain: Complex<f64>, rate_hz: f64) -> [f64; 2] {
    [-gain.im * rate_hz, gain.re * rate_hz]
}

/// The force's own gain as a table has it: there the response's first sample counts half, here it counts whole.
fn table_acceleration(gains: &Gains) -> f64 {
    gains.force + 0.5 * gains.modes.iter().map(|gain| gain.re).sum::<f64>()
}
