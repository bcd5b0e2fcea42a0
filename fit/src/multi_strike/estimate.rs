//! Modes and strikes of a fitted recording, with the standard deviation of each number.

use std::borrow::Cow;
use std::cell::Cell;
use std::f64::consts::TAU;

use nalgebra::Complex;
use serde::Serialize;

use super::added_noise::added_noise;
use super::clipping::is_clipped;
use super::declipping::Clipped;
use super::descend::{Deviations, Fitted};
use super::error::StrikesError;
use super::fit::fit;
use super::layout::Layout;
use super::spline::Weights;
use crate::clipping::Limits;
use crate::modes::Settings;
use crate::room::Room;

/// A mode with the standard deviations of its numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModeEstimate {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Standard deviation of the frequency in Hz.
    pub frequency_hz_sd: f64,
    /// Decay rate in 1/s.
    pub decay_per_s: f64,
    /// Standard deviation of the decay rate in 1/s.
    pub decay_per_s_sd: f64,
    /// Gains `[sine, cosine]` in output per unit of force and second, in continuous time, where the
    /// mode is loudest along the object.
    pub gain: [f64; 2],
    /// Relative standard deviation of the gain's magnitude; with positions that of the best known
    /// coefficient of the gains along the object.
    pub gain_sd: f64,
    /// Gains at evenly spaced positions from 0 to 1; empty if there is one place.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gains: Vec<[f64; 2]>,
    /// Striker whose own mode it is, counted from 0; `None` for a mode of the object.
    pub striker: Option<usize>,
}

impl ModeEstimate {
    /// T60 in seconds.
    pub fn t60_s(&self) -> f64 {
        1000f64.ln() / self.decay_per_s
    }
}

/// A strike with the standard deviations of its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StrikeEstimate {
    /// Onset of the force in seconds of the recording.
    pub at_s: f64,
    /// Standard deviation of the onset in seconds.
    pub at_s_sd: f64,
    /// Middle of the contact in seconds.
    pub middle_s: f64,
    /// Standard deviation of the middle in seconds.
    pub middle_s_sd: f64,
    /// Contact time in seconds.
    pub contact_time_s: f64,
    /// Standard deviation of the contact time in seconds.
    pub contact_time_s_sd: f64,
    /// Peak of the force; 1 for the strongest strike, which is the unit of force.
    pub peak_force: f64,
    /// Standard deviation of the peak; 0 for the strongest strike.
    pub peak_force_sd: f64,
    /// Position along the object, 0 to 1; which end is 0 is not told. 0 if there is one place.
    pub position: f64,
    /// Standard deviation of the position; 0 for the two strikes that fix the scale.
    pub position_sd: f64,
    /// Number of the striker, counted from 0, the hardest.
    pub striker: usize,
    /// Power that the model leaves of the strike and of 30 ms behind it, in dB over the median of
    /// all strikes.
    ///
    /// A strike that stands out by 9 dB or more is not explained: it is clipped, or something else
    /// sounds.
    pub left_db: f64,
    /// True if the sound stands still at its highest or lowest value within 20 ms of the onset.
    pub is_clipped: bool,
}

/// A recording of many strikes as its joint fit explains it.
#[derive(Clone, Debug, Serialize)]
pub struct Estimate {
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// Modes in order of frequency.
    pub modes: Vec<ModeEstimate>,
    /// Strikes in order of time.
    pub strikes: Vec<StrikeEstimate>,
    /// True if contact times are those heard of each strike alone, because those of one thing
    /// struck at one place contradict them.
    pub contact_times_are_heard: bool,
    /// Acceleration sound in output per unit of force; 0 if the sound does not tell one.
    pub acceleration: f64,
    /// Standard deviation of the acceleration sound; 0 if there is none.
    pub acceleration_sd: f64,
    /// Rms of what the model leaves of the recording, in dB of full scale. Clipped samples count as
    /// the fit has replaced them.
    pub left_dbfs: f64,
    /// Room, if one is heard; what is left is left without it.
    pub room: Option<Room>,
    /// Samples that the model leaves of the recording.
    #[serde(skip)]
    pub residual: Vec<f64>,
}

/// Fits all strikes of a recording together, by maximum likelihood.
///
/// If the noise of a recording lies more than about 88 dB below its peak, white noise at -72 dB of
/// the peak is added before the fit. It is subtracted from the residual afterwards.
///
/// Full scale of `samples` is 1. The model has one thing, struck at places and with strikers as the
/// layout says, and forces that are half-sines. Time and memory grow in proportion to the length
/// (docs/multi-strike.md has the accuracy and the cost). `told` gets the share of the work that is
/// done, from 0 to 1, and never less than before.
///
/// # Errors
/// [`StrikesError`] if fewer than two strikes are heard or far too many, if they cannot be told
/// apart, or if one thing and its strikes explain too little of the recording.
pub fn estimate(
    samples: &[f64],
    rate_hz: f64,
    settings: Settings,
    layout: Layout,
    told: impl Fn(f64),
) -> Result<Estimate, StrikesError> {
    of_samples(&mut Cow::Borrowed(samples), rate_hz, settings, layout, told)
}

/// Fits all strikes of a recording as [`estimate`] does, without a copy of its samples.
///
/// Noise, if any is needed, is added to the samples in place, and subtracted after the fit. The
/// samples then differ from the given ones by rounding, at most 1e-15.
///
/// # Errors
/// Those of [`estimate`].
pub fn estimate_in_place(
    samples: &mut Vec<f64>,
    rate_hz: f64,
    settings: Settings,
    layout: Layout,
    told: impl Fn(f64),
) -> Result<Estimate, StrikesError> {
    let mut owned = Cow::Owned(std::mem::take(samples));
    let estimate = of_samples(&mut owned, rate_hz, settings, layout, told);
    *samples = owned.into_owned();
    estimate
}

fn of_samples(
    samples: &mut Cow<'_, [f64]>,
    rate_hz: f64,
    settings: Settings,
    layout: Layout,
    told: impl Fn(f64),
) -> Result<Estimate, StrikesError> {
    // A fit in a room that is given up begins anew.
    let furthest = Cell::new(0.0);
    let told = |share: f64| {
        furthest.set(share.max(furthest.get()));
        told(furthest.get());
    };
    let clipped = Clipped::of(samples);
    let noise = added_noise(samples, rate_hz);
    if let Some(noise) = noise {
        noise.add_to(samples.to_mut(), 1.0);
    }
    let joint = match &clipped {
        Some(clipped) => clipped.fitted(samples.to_mut(), rate_hz, settings, layout, &told),
        None => fit(samples, rate_hz, settings, layout, &told),
    };
    if let Some(noise) = noise {
        noise.add_to(samples.to_mut(), -1.0);
    }
    if let Some(clipped) = &clipped {
        clipped.put_back(samples.to_mut());
    }
    let mut joint = joint?;
    if let Some(noise) = noise {
        noise.add_to(&mut joint.fitted.residual, -1.0);
    }
    let mut estimate = of_fit(joint.fitted, &joint.deviations, rate_hz);
    estimate.room = joint.room;
    let limits = Limits::of(samples);
    for strike in &mut estimate.strikes {
        strike.is_clipped = is_clipped(samples, (strike.at_s * rate_hz).max(0.0) as usize, rate_hz, limits);
    }
    Ok(estimate)
}

/// Gains `[sine, cosine]` at evenly spaced positions: four for each interval between coefficients.
fn along(gains: &[Complex<f64>], rate_hz: f64) -> Vec<[f64; 2]> {
    let count = if gains.len() > 1 { (4 * gains.len() - 3).min(MOST_POSITIONS) } else { 1 };
    let position = |index: usize| if count > 1 { index as f64 / (count - 1) as f64 } else { 0.0 };
    let gain = |index: usize| Weights::at(position(index), gains.len()).sum(gains) * rate_hz;
    (0..count).map(|index| [-gain(index).im, gain(index).re]).collect()
}

/// Maximum number of positions that a table holds.
const MOST_POSITIONS: usize = 64;

fn loudest(gains: &[[f64; 2]]) -> [f64; 2] {
    let size = |gain: &&[f64; 2]| gain[0].hypot(gain[1]);
    gains.iter().max_by(|a, b| size(a).total_cmp(&size(b))).copied().unwrap_or([0.0; 2])
}

/// Numbers of a fitted model with their standard deviations.
pub(crate) fn of_fit(fitted: Fitted, deviations: &Deviations, rate_hz: f64) -> Estimate {
    let model = &fitted.model;
    let mut modes: Vec<ModeEstimate> = (model.poles.iter().zip(&model.gains))
        .zip(deviations.poles.iter().zip(&deviations.gains))
        .zip(&model.owners)
        .map(|(((pole, gains), ([decay, angular], spreads)), owner)| ModeEstimate {
            frequency_hz: pole.frequency_hz(rate_hz),
            frequency_hz_sd: angular * rate_hz / TAU,
            decay_per_s: pole.decay_per_s(rate_hz),
            decay_per_s_sd: decay * rate_hz,
            gain: loudest(&along(gains, rate_hz)),
            gain_sd: spreads.iter().copied().fold(f64::INFINITY, f64::min),
            gains: if model.places() > 1 { along(gains, rate_hz) } else { Vec::new() },
            striker: *owner,
        })
        .collect();
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    let (powers, median) = fitted.left_behind(rate_hz);
    let left_db = powers.into_iter().map(|power| 10.0 * (power / median).log10());
    let strikes = model.strikes.iter().zip(&deviations.strikes).zip(left_db).map(|((strike, covariance), left_db)| {
        let contact = strike.contact;
        let time_sd = covariance[(1, 1)].sqrt() * contact.time;
        let between = covariance[(0, 1)] * contact.time;
        let onset = covariance[(0, 0)] + 0.25 * time_sd * time_sd - between;
        StrikeEstimate {
            at_s: (contact.middle - 0.5 * contact.time) / rate_hz,
            at_s_sd: onset.max(0.0).sqrt() / rate_hz,
            middle_s: contact.middle / rate_hz,
            middle_s_sd: covariance[(0, 0)].sqrt() / rate_hz,
            contact_time_s: contact.time / rate_hz,
            contact_time_s_sd: time_sd / rate_hz,
            peak_force: contact.peak,
            peak_force_sd: covariance[(2, 2)].sqrt() * contact.peak,
            position: strike.position,
            position_sd: if covariance.nrows() > 3 { covariance[(3, 3)].max(0.0).sqrt() } else { 0.0 },
            striker: strike.striker,
            left_db,
            is_clipped: false,
        }
    });
    let mut strikes: Vec<StrikeEstimate> = strikes.collect();
    for end in model.ends().into_iter().flatten() {
        strikes[end].position_sd = 0.0;
    }
    let power = fitted.residual.iter().map(|x| x * x).sum::<f64>() / fitted.residual.len().max(1) as f64;
    Estimate {
        rate_hz,
        modes,
        strikes,
        contact_times_are_heard: model.contact_times_are_held,
        acceleration: model.acceleration,
        acceleration_sd: deviations.acceleration,
        left_dbfs: 10.0 * power.max(1e-30).log10(),
        room: None,
        residual: fitted.residual,
    }
}
