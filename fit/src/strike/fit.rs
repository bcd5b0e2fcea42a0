//! A fitted object: its modes, and the strikes from which they come.

use nalgebra::Complex;
use serde::Serialize;

use crate::band::Band;
use crate::bins::BINS;
use crate::modes::{Gains, Settings as ModeSettings};
use crate::segment::Hit;

/// Estimator of the modes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// Maximum likelihood over all damped sines together ([`crate::modes`]).
    #[default]
    Modal,
    /// One mode a bin of a spectrogram (physics-diffusion §3.1, [`crate::bins`]), of the loudest
    /// strike alone.
    Bins,
}

impl Estimator {
    /// Maximum number of modes of a fit whose caller asks for no number: 64, or one a bin.
    pub fn usual_modes(self) -> usize {
        match self {
            Self::Modal => ModeSettings::default().most_modes,
            Self::Bins => BINS,
        }
    }
}

/// Settings of a fit.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Estimator of the modes.
    pub estimator: Estimator,
    /// Settings of the modal estimator.
    pub modes: ModeSettings,
    /// True if a descent on the log-spectral distance follows the maximum-likelihood estimate.
    pub polish: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { estimator: Estimator::Modal, modes: ModeSettings::default(), polish: true }
    }
}

/// A mode of an object, and its response to each strike or position.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Decay rate in 1/s.
    pub decay_per_s: f64,
    /// Gains `[sine, cosine]` in output per newton-second, as tables define them.
    ///
    /// From sound alone there is one pair a strike, with a measured force one pair a position.
    pub gains: Vec<[f64; 2]>,
}

impl Mode {
    /// T60 in seconds.
    pub fn t60_s(&self) -> f64 {
        1000f64.ln() / self.decay_per_s
    }
}

/// One strike, and how well the model fits it.
#[derive(Clone, Debug, PartialEq)]
pub struct Strike {
    /// Place of the strike in the recording.
    pub hit: Hit,
    /// Contact time in seconds.
    pub contact_time_s: f64,
    /// Peak of the force: 1 from sound alone, else as measured (full scale 1).
    pub peak_force: f64,
    /// Position of the strike, from 0 to 1 along the positions with gains; 0 from sound alone.
    pub position: f64,
    /// Acceleration sound in output per newton, as tables define it.
    pub acceleration: f64,
    /// Log-spectral distance in dB between recording and model, over 0.25 s from 20 samples before
    /// the peak.
    pub lsd_db: f64,
    /// Energy that the model leaves of the strike, in dB.
    pub residual_db: f64,
}

/// A fitted object. From sound alone, forces have a peak of 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Sample rate of the recording in Hz.
    pub rate_hz: f64,
    /// Modes in order of frequency.
    pub modes: Vec<Mode>,
    /// Strikes in order of time.
    pub strikes: Vec<Strike>,
    /// True if the force was measured: gains are then those at positions, otherwise those of
    /// strikes.
    pub measured: bool,
    /// Noise bands that belong to the modes of the loudest strike, at its peak force.
    ///
    /// Empty if the modes were fitted without noise.
    pub noise: Vec<Band>,
    /// True if the modes explain the loudest strike down to its noise floor.
    ///
    /// Poles and gains are then those of most likelihood, and no descent has moved them.
    pub is_exact: bool,
    /// Index of the loudest strike, whose gains a table takes if the force was not measured.
    pub loudest: usize,
}

impl Fit {
    /// Fit without a mode and without a strike: tables of other stages begin with it.
    pub fn silent(rate_hz: f64) -> Self {
        let (modes, strikes, noise) = (Vec::new(), Vec::new(), Vec::new());
        Self { rate_hz, modes, strikes, measured: false, noise, is_exact: false, loudest: 0 }
    }
}

/// Gain g of `Σ F[m] Re(g z^(n-m))` as sine and cosine gains of a table.
///
/// A table's response is the sum over samples divided by the rate.
pub(super) fn table_gain(gain: Complex<f64>, rate_hz: f64) -> [f64; 2] {
    [-gain.im * rate_hz, gain.re * rate_hz]
}

/// Gain of the force itself as a table has it.
///
/// A table counts the response's first sample half, the estimator counts it whole.
pub(super) fn table_acceleration(gains: &Gains) -> f64 {
    gains.force + 0.5 * gains.modes.iter().map(|gain| gain.re).sum::<f64>()
}
