//! Last corrections of a fitted strike: levels of its loudest partials, and its peak.
//!
//! The descent lowers distances that are means over bands and frames. A single partial may stay
//! 4 dB off, and modes and noise may meet in one sample that stands above the recording's peak.
//! Both are heard, so both are measured in dsp-core's rendering and corrected:
//!
//! - The mode nearest to a loud partial gets the gain that gives the partial its level.
//! - What makes the peak is lowered. Each mode's share is its own part of that sample times its
//!   decay, so that short modes give way before those that ring.
//!
//! Faults are counted again in the new rendering, and the strike with the fewest is kept.

use fourier::Complex;

use crate::band::Band;
use crate::contact;
use crate::error::FitError;
use crate::hearing::{Heard, Partial};
use crate::joint::{self, HELD, LOUDEST};
use crate::modes::{Basis, Pole, Stretch};
use crate::stages::{self, RecordedStrike};
use crate::strike::{Fit, Mode};
use crate::table::{self, Provenance};

/// Largest error of a partial's level that counts as right, in dB.
const RIGHT_DB: f64 = 3.0;
/// Error of a partial's level up to which it is left as it is, in dB.
const CLOSE_DB: f64 = 2.5;
/// Largest change of a mode's level in one round, in dB.
const MOST_CHANGE_DB: f64 = 9.0;
/// Largest level of the rendering's peak over the recording's, in dB.
const MOST_PEAK_DB: f64 = 3.0;
/// Level over the recording's peak to which a peak is lowered, in dB.
const WANTED_PEAK_DB: f64 = 2.7;
/// Largest share of its gain that a mode loses in one round.
const MOST_LOSS: f64 = 0.5;
/// Relative distance of a partial from its mode up to which it has one.
const NEAR: f64 = 0.005;
/// Maximum number of rounds.
const ROUNDS: usize = 4;

/// Length in seconds behind the recording's peak that is rendered: the last spectrum of partials
/// ends there.
const RENDERED_S: f64 = 1.1;

/// A fit whose loudest partials and whose peak are right, as far as a few rounds bring them there.
///
/// Only modes with noise of their own are changed: exact modes stay exact.
///
/// # Errors
/// [`FitError`] if a board would refuse a table.
pub(crate) fn trimmed(
    fit: Fit,
    stage: &RecordedStrike<'_>,
    heard: &Heard,
    provenance: &Provenance,
) -> Result<Fit, FitError> {
    if fit.noise.is_empty() {
        return Ok(fit);
    }
    let trim = Trim::new(heard, stage.samples());
    let strike = stage.samples();
    let length = strike.len().min(peak_at(strike) + (RENDERED_S * stage.rate_hz()) as usize);
    let rendered = |fit: &Fit| -> Result<Rendered, FitError> {
        let table = table::of_fit(fit, provenance);
        let modes = stage.render(&table, length)?;
        Ok(Rendered { modes, whole: stage.render(&stages::noisy(table, &fit.noise), length)? })
    };
    let mut now = (rendered(&fit)?, fit);
    let mut faults = trim.faults(&now.1, &now.0);
    let mut best = now.1.clone();
    for _ in 0..ROUNDS {
        if faults == 0 {
            break;
        }
        let fit = trim.corrected(&now.1, &now.0);
        now = (rendered(&fit)?, fit);
        let left = trim.faults(&now.1, &now.0);
        if left < faults {
            (faults, best) = (left, now.1.clone());
        }
    }
    Ok(best)
}

/// The beginning of a fit's strike as dsp-core renders it.
struct Rendered {
    /// The modes alone.
    modes: Vec<f64>,
    /// Modes and noise.
    whole: Vec<f64>,
}

/// A recorded strike and the loudest of its partials.
struct Trim<'a> {
    heard: &'a Heard,
    peak: f64,
    /// The loudest partials, each with its place among all partials.
    partials: Vec<(usize, Partial)>,
}

impl<'a> Trim<'a> {
    /// The strike whose samples are `strike`.
    fn new(heard: &'a Heard, strike: &[f64]) -> Self {
        Self { heard, peak: peak(strike), partials: heard.partials().loudest(LOUDEST) }
    }

    /// Number of loudest partials that lack a mode or are off by more than 3 dB, and one more if
    /// the rendering peaks more than 3 dB over the recording.
    fn faults(&self, fit: &Fit, rendered: &Rendered) -> usize {
        let errors_db = self.heard.partials().errors_db(&rendered.whole);
        let is_wrong = |(index, partial): &&(usize, Partial)| {
            let reach_hz = (NEAR * partial.frequency_hz).max(0.5 * self.heard.partials().bin_hz());
            let off_hz = nearest(fit, partial.frequency_hz).map_or(f64::INFINITY, |(_, off_hz)| off_hz.abs());
            off_hz > reach_hz || errors_db[*index].abs() > RIGHT_DB
        };
        let wrong = self.partials.iter().filter(is_wrong).count();
        wrong + usize::from(self.over_db(rendered) > MOST_PEAK_DB)
    }

    /// Level of a rendering's peak over the recording's, in dB.
    fn over_db(&self, rendered: &Rendered) -> f64 {
        20.0 * (peak(&rendered.whole) / self.peak).log10()
    }

    /// The fit with the levels of its partials and its peak corrected.
    fn corrected(&self, fit: &Fit, rendered: &Rendered) -> Fit {
        let mut corrected = fit.clone();
        let errors_db = self.heard.partials().errors_db(&rendered.whole);
        let mut done: Vec<usize> = Vec::new();
        for (index, partial) in &self.partials {
            let Some((mode, off_hz)) = nearest(fit, partial.frequency_hz) else { continue };
            if done.contains(&mode) {
                continue;
            }
            done.push(mode);
            let limit_hz = HELD * partial.frequency_hz;
            let is_off = off_hz.abs() > limit_hz.max(0.5 * self.heard.partials().bin_hz());
            if errors_db[*index].abs() <= CLOSE_DB && !is_off {
                continue;
            }
            if off_hz.abs() > limit_hz {
                corrected.modes[mode].frequency_hz = partial.frequency_hz + limit_hz * off_hz.signum();
            }
            let change_db = (-errors_db[*index]).clamp(-MOST_CHANGE_DB, MOST_CHANGE_DB);
            scale(&mut corrected, mode, 10f64.powf(change_db / 20.0));
        }
        if self.over_db(rendered) > MOST_PEAK_DB {
            self.lower_peak(fit, rendered, &mut corrected);
        }
        part_cancelling(&mut corrected);
        corrected.modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        corrected
    }

    /// Lowers the parts of `fit` that make its rendering peak, in `corrected`.
    fn lower_peak(&self, fit: &Fit, rendered: &Rendered, corrected: &mut Fit) {
        let Some(strike) = fit.strikes.get(fit.loudest) else { return };
        let at = peak_at(&rendered.whole);
        let Some(height) = rendered.whole.get(at).copied() else { return };
        let (height, sign) = (height.abs(), height.signum());
        let surplus = height - self.peak * 10f64.powf(WANTED_PEAK_DB / 20.0);
        let silence = vec![0.0; at + 1];
        let force = contact::force(strike.contact_time_s, fit.rate_hz);
        let stretch = Stretch { samples: &silence, force: Some(&force[..force.len().min(at + 1)]) };
        let of_mode = |mode: &Mode| {
            let [sine, cosine] = mode.gains.get(fit.loudest).copied().unwrap_or_default();
            let gain = Complex::new(cosine, -sine) * (strike.peak_force / fit.rate_hz);
            let mut sound = silence.clone();
            Basis::new(Pole::new(mode.frequency_hz, mode.decay_per_s, fit.rate_hz), &stretch).add(gain, &mut sound);
            sign * sound[at]
        };
        let parts: Vec<f64> = fit.modes.iter().map(of_mode).collect();
        let noise = sign * (rendered.whole[at] - rendered.modes.get(at).copied().unwrap_or(0.0));
        let decay = |band: &Band| band.decay_db_per_s / DECIBELS_A_NEPER;
        let noise_decay = fit.noise.iter().map(decay).sum::<f64>() / fit.noise.len().max(1) as f64;
        let weights = fit.modes.iter().map(|mode| mode.decay_per_s).chain([noise_decay]);
        let parts: Vec<(f64, f64)> =
            parts.into_iter().chain([noise]).zip(weights).map(|(part, weight)| (part.max(0.0), weight)).collect();
        let losses = losses(&parts, surplus);
        for (mode, loss) in losses.iter().take(fit.modes.len()).enumerate() {
            scale(corrected, mode, 1.0 - loss);
        }
        let loss = losses.last().copied().unwrap_or(0.0);
        corrected.noise.iter_mut().for_each(|band| band.weight *= 1.0 - loss);
    }
}

/// Decibels in a neper of amplitude.
const DECIBELS_A_NEPER: f64 = 8.685_889_638;

/// Shares of parts to take away, so that `surplus` is gone of their sum.
///
/// A share is proportional to the part and to its weight, and at most one half.
fn losses(parts: &[(f64, f64)], surplus: f64) -> Vec<f64> {
    let share = |factor: f64, (part, weight): &(f64, f64)| (factor * part * weight).min(MOST_LOSS);
    let taken = |factor: f64| parts.iter().map(|part| part.0 * share(factor, part)).sum::<f64>();
    let largest = parts.iter().map(|(part, weight)| part * weight).fold(f64::MIN_POSITIVE, f64::max);
    let (mut low, mut high) = (0.0, MOST_LOSS / largest);
    for _ in 0..DOUBLINGS {
        if taken(high) < surplus {
            (low, high) = (high, 2.0 * high);
        }
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if taken(middle) < surplus { low = middle } else { high = middle }
    }
    parts.iter().map(|part| share(high, part)).collect()
}

/// Number of times that the factor of all losses is doubled to find its upper bound.
const DOUBLINGS: usize = 40;
/// Number of halvings that find the factor of all losses.
const HALVINGS: usize = 40;

/// Multiplies a mode's gain in the loudest strike; the gain of the force itself stays.
fn scale(fit: &mut Fit, mode: usize, factor: f64) {
    let loudest = fit.loudest;
    let Some(gain) = fit.modes.get_mut(mode).and_then(|mode| mode.gains.get_mut(loudest)) else { return };
    // A table counts half of the modes' first sample as acceleration sound.
    let change = 0.5 * (factor - 1.0) * gain[1] / fit.rate_hz;
    gain.iter_mut().for_each(|gain| *gain *= factor);
    if let Some(strike) = fit.strikes.get_mut(loudest) {
        strike.acceleration += change;
    }
}

/// Parts modes within their widths that the corrections have made cancel by more than 6 dB.
fn part_cancelling(fit: &mut Fit) {
    let loudest = fit.loudest;
    let pole = |mode: &Mode| Pole::new(mode.frequency_hz, mode.decay_per_s, fit.rate_hz);
    let poles: Vec<Pole> = fit.modes.iter().map(pole).collect();
    let gain = |mode: &Mode| mode.gains.get(loudest).map_or(Complex::new(0.0, 0.0), |[a, b]| Complex::new(*a, *b));
    let mut gains: Vec<Complex<f64>> = fit.modes.iter().map(gain).collect();
    joint::part_cancelling(&poles, &mut gains);
    for (mode, gain) in fit.modes.iter_mut().zip(gains) {
        if let Some(place) = mode.gains.get_mut(loudest) {
            *place = [gain.re, gain.im];
        }
    }
}

/// Index of the mode nearest to a frequency, and its distance above it in Hz.
fn nearest(fit: &Fit, hz: f64) -> Option<(usize, f64)> {
    let distances = fit.modes.iter().map(|mode| mode.frequency_hz - hz).enumerate();
    distances.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// Sample at which a sound is furthest from 0.
fn peak_at(sound: &[f64]) -> usize {
    sound.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |(at, _)| at)
}

fn peak(sound: &[f64]) -> f64 {
    sound.iter().fold(f64::MIN_POSITIVE, |peak, x| peak.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_take_the_surplus_away_and_spare_what_rings() {
        let parts = [(0.5, 2.0), (0.3, 200.0), (0.0, 1_000.0)];
        let losses = losses(&parts, 0.1);
        let taken: f64 = parts.iter().zip(&losses).map(|((part, _), loss)| part * loss).sum();
        assert!((taken - 0.1).abs() < 1e-6, "{losses:?}");
        assert!(losses[1] > 10.0 * losses[0], "{losses:?}");
    }

    #[test]
    fn losses_are_at_most_a_half_if_the_surplus_cannot_be_taken() {
        assert!(losses(&[(0.5, 2.0), (0.3, 9.0)], 1.0).iter().all(|loss| *loss <= MOST_LOSS));
    }
}
