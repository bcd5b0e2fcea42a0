//! The study: how much of recordings' damping each method of resynthesis keeps.

use std::path::Path as FilePath;

use super::additive::additive;
use super::average_filter::{USUAL_BANDWIDTH_HZ, by_average_filter};
use super::model::{Form, Model, RATE_HZ};
use super::path::{Criterion, noise_alone};
use super::sound::render;
use super::waveguide::waveguide;
use crate::bark::{DampingLaw, damping_law, emergence_db};
use crate::error::FitError;
use crate::modes::{self, DampedSine};
use crate::{audio, segment};

/// Number of seeds over which a resynthesis is averaged.
pub const SEEDS: u64 = 4;
/// Time in seconds after its peak from which a strike rings freely.
const CONTACT_S: f64 = 5e-4;
/// Lowest frequency of a mode in Hz: what moves slower is not heard.
const LOWEST_HZ: f64 = 20.0;
/// Longest part of a strike that is analysed, in seconds.
const LONGEST_S: f64 = 12.0;

/// Analysis of a recording's loudest strike.
#[derive(Clone, Debug)]
pub struct Heard {
    /// Damping law of the strike.
    pub law: DampingLaw,
    /// Modes of the strike from 20 Hz on, with amplitudes and phases at the onset.
    pub modes: Vec<DampedSine>,
    /// Level in dB by which each mode stands out of the smooth part of the spectrum.
    pub emergence_db: Vec<f64>,
    /// Length of the strike in seconds.
    pub length_s: f64,
}

/// Analyses the loudest strike of a recording, of those that last at least 15 ms.
///
/// # Errors
/// [`FitError`] if the recording cannot be read or has no strike; [`FitError::TooShort`] if all
/// strikes are shorter than 15 ms; [`FitError::NoModes`] if no band decays.
pub fn heard_in(path: &FilePath) -> Result<Heard, FitError> {
    let recording = audio::read(path, None)?;
    let rate_hz = recording.rate_hz;
    let (hits, _) = segment::hits(&recording)?;
    let hits = segment::select(&recording, &hits, &[])?;
    let peak =
        |hit: &segment::Hit| recording.samples[hit.onset..hit.end].iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let loudest = hits.iter().max_by(|a, b| peak(a).total_cmp(&peak(b))).ok_or(FitError::NoOnset)?;
    let end = loudest.end.min(loudest.onset + (LONGEST_S * rate_hz) as usize);
    let strike = &recording.samples[loudest.onset..end];
    let law = damping_law(strike, rate_hz).ok_or(FitError::NoModes { at_s: loudest.onset as f64 / rate_hz })?;
    let attack = strike.len().min((0.05 * rate_hz) as usize);
    let top = (0..attack).max_by(|&a, &b| strike[a].abs().total_cmp(&strike[b].abs())).unwrap_or(0);
    let from = (top + (CONTACT_S * rate_hz) as usize).min(strike.len());
    let since_s = from as f64 / rate_hz;
    let mut modes = modes::estimate(&strike[from..], rate_hz, modes::Settings::default());
    modes.retain(|mode| mode.frequency_hz >= LOWEST_HZ);
    for mode in &mut modes {
        mode.amplitude *= (mode.decay_per_s * since_s).exp();
        mode.phase -= std::f64::consts::TAU * mode.frequency_hz * since_s;
    }
    let emergence_db = emergence_db(&modes, strike, rate_hz);
    Ok(Heard { law, modes, emergence_db, length_s: strike.len() as f64 / rate_hz })
}

/// A method of resynthesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Noise alone, first order, by the paper's three bands (eq. 17 to 21).
    ThreeBands,
    /// Noise alone, fitted to all bands.
    Noise(Form),
    /// Noise with modes beside the filter.
    Additive(Form),
    /// The noise alone of second order, with loops by eq. 22 to 24 round it.
    AverageFilter,
    /// Loops and filter fitted together.
    Waveguide(Form),
}

impl Way {
    /// Methods that the study compares.
    pub const ALL: [Self; 8] = [
        Self::ThreeBands,
        Self::Noise(Form::FirstOrder),
        Self::Noise(Form::OnePoleOneZero),
        Self::Noise(Form::SecondOrder),
        Self::Additive(Form::FirstOrder),
        Self::Additive(Form::SecondOrder),
        Self::AverageFilter,
        Self::Waveguide(Form::SecondOrder),
    ];

    /// Name of the method in a table.
    pub fn label(self) -> &'static str {
        match self {
            Self::ThreeBands => "three bands, 1st",
            Self::Noise(Form::FirstOrder) => "noise, 1st",
            Self::Noise(Form::OnePoleOneZero) => "noise, 1p1z",
            Self::Noise(Form::SecondOrder) => "noise, 2nd",
            Self::Additive(Form::FirstOrder) => "additive, 1st",
            Self::Additive(Form::OnePoleOneZero) => "additive, 1p1z",
            Self::Additive(Form::SecondOrder) => "additive, 2nd",
            Self::AverageFilter => "loops by eq. 22 to 24, 2nd",
            Self::Waveguide(Form::FirstOrder) => "waveguide, 1st",
            Self::Waveguide(Form::OnePoleOneZero) => "waveguide, 1p1z",
            Self::Waveguide(Form::SecondOrder) => "waveguide, 2nd",
        }
    }

    /// Fits a model to an analysed strike by this method.
    ///
    /// `told` gets the share of the work that is done.
    pub fn model(self, heard: &Heard, told: &(dyn Fn(f64) + Sync)) -> Model {
        let Heard { law, modes, emergence_db, .. } = heard;
        match self {
            Self::ThreeBands => Model { path: noise_alone(law, Criterion::ThreeBands), ..Model::default() },
            Self::Noise(form) => Model { path: noise_alone(law, Criterion::AllBands(form)), ..Model::default() },
            Self::Additive(form) => additive(law, modes, emergence_db, form, told),
            Self::AverageFilter => {
                let path = noise_alone(law, Criterion::AllBands(Form::SecondOrder));
                let loops = by_average_filter(&path, modes, emergence_db, USUAL_BANDWIDTH_HZ);
                Model { path, loops, ..Model::default() }
            }
            Self::Waveguide(form) => waveguide(law, modes, emergence_db, form, told),
        }
    }
}

/// Renders the model with [`SEEDS`] seeds, as long as the strike: one sound a seed, at 48 kHz.
pub fn resynthesis(model: &Model, heard: &Heard) -> Vec<Vec<f64>> {
    let length = (heard.length_s * RATE_HZ) as usize;
    (1..=SEEDS).map(|seed| render(model, length, seed)).collect()
}
