//! Clipped samples, replaced in turn with the fit by what it says of them.
//!
//! The sound lies at the limit or beyond it where a sample is clipped. A model that lies beyond the
//! limit there has no error. The fit begins with values that follow from the modes that ring behind
//! the clipped samples. Then two steps are repeated, and each lowers the sum of squared errors:
//!
//! - Strikes and modes are fitted to the samples.
//! - Each clipped sample becomes the model's value, or the limit if the model lies below it.

use super::descend::{Ending, Fitted, descend};
use super::error::StrikesError;
use super::fit::{JointFit, fit};
use super::free::{Guard, MORE_MODES, amplitudes, free_modes_of, shortest, stretches};
use super::in_room::energy;
use super::layout::Layout;
use super::rises::rises;
use super::whitening::{ORDER, Whitening};
use crate::clipping::{Limits, flat_tops};
use crate::modes::Settings;

/// Share of a limit from which on a sample is clipped.
const AT_LIMIT: f64 = 0.9999;
/// Maximum number of times that the strikes are fitted anew.
const ROUNDS: usize = 6;
/// Maximum number of descents between two of these fits.
const DESCENTS: usize = 8;
/// Change of the clipped samples' energy, as a share of that of what the fit leaves, from which no
/// fit is made anew: -30 dB.
const SETTLED: f64 = 1e-3;
/// Change from which no descent follows, as a share likewise: -50 dB.
const DESCENDED: f64 = 1e-5;
/// Share of what the last fit leaves from which an earlier fit is taken that leaves less: -0.1 dB.
const CLEARLY_LESS: f64 = 0.98;
/// Largest value of a clipped sample that modes ringing behind it may give, in units of the limit.
const MOST_RINGING: f64 = 3.0;
/// Largest value of a clipped sample, in units of the limit.
const MOST: f64 = 10.0;
/// Growth of a mode back to a clipped sample up to which it counts there: 20 dB, in nepers.
const MOST_GROWTH: f64 = 2.3;

/// A clipped sample.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ClippedSample {
    at: usize,
    limit: f64,
}

/// Clipped samples of a recording in order of time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Clipped(Vec<ClippedSample>);

impl Clipped {
    /// Samples at the limits of a recording; `None` if it has no flat tops.
    pub(super) fn of(samples: &[f64]) -> Option<Self> {
        if flat_tops(samples).is_empty() {
            return None;
        }
        let limits = Limits::of(samples);
        let at_limit = samples.iter().enumerate().filter(|(_, x)| limits.are_reached(**x, AT_LIMIT));
        Some(Self(at_limit.map(|(at, &limit)| ClippedSample { at, limit }).collect()))
    }

    /// Fit of all strikes of a recording, whose clipped samples become what the fit says of them.
    ///
    /// # Errors
    /// Those of [`fit`].
    pub(super) fn fitted(
        &self,
        samples: &mut [f64],
        rate_hz: f64,
        settings: Settings,
        layout: Layout,
        told: &dyn Fn(f64),
    ) -> Result<JointFit, StrikesError> {
        let fit = |samples: &[f64], told: &dyn Fn(f64)| fit(samples, rate_hz, settings, layout, told);
        self.ring_on(samples, rate_hz, settings);
        self.fitted_in_turn(samples, fit, told).or_else(|_| {
            self.put_back(samples);
            self.fitted_in_turn(samples, fit, told)
        })
    }

    /// Sets clipped samples back to their limits.
    pub(super) fn put_back(&self, samples: &mut [f64]) {
        self.0.iter().for_each(|clipped| samples[clipped.at] = clipped.limit);
    }

    /// Fits of the strikes and clipped samples in turn, until the latter change little.
    fn fitted_in_turn(
        &self,
        samples: &mut [f64],
        fit: impl Fn(&[f64], &dyn Fn(f64)) -> Result<JointFit, StrikesError>,
        told: &dyn Fn(f64),
    ) -> Result<JointFit, StrikesError> {
        // Few recordings need all rounds: each takes half of the progress that is left.
        let of_round = |round: i32, share: f64| told(1.0 - 0.5f64.powi(round) * (1.0 - 0.5 * share));
        let mut found = fit(samples, &|share| of_round(0, share))?;
        let mut best: Option<JointFit> = None;
        let left = |joint: &JointFit| energy(&joint.fitted.residual);
        for round in 1..=ROUNDS {
            if self.settle(samples, &found) < SETTLED * left(&found) {
                break;
            }
            let next = fit(samples, &|share| of_round(round as i32, share))?;
            let earlier = std::mem::replace(&mut found, next);
            if best.as_ref().is_none_or(|best| left(&earlier) < left(best)) {
                best = Some(earlier);
            }
        }
        told(1.0);
        Ok(best.filter(|best| left(best) < CLEARLY_LESS * left(&found)).unwrap_or(found))
    }

    /// Sets clipped samples to what a fit says, then in turn with descents from it. Returns the
    /// energy of their change.
    fn settle(&self, samples: &mut [f64], found: &JointFit) -> f64 {
        let values = |samples: &[f64]| self.0.iter().map(|clipped| samples[clipped.at]).collect::<Vec<f64>>();
        let before = values(samples);
        self.replace(samples, MOST, |at, x| x - found.fitted.residual[at]);
        // A descent knows no room.
        if found.room.is_none() {
            let whitening = Whitening::of_residual(&found.fitted.residual, ORDER);
            let mut fitted = Fitted::new(found.fitted.model.clone(), samples, &whitening);
            for _ in 0..DESCENTS {
                fitted = descend(fitted, samples, &whitening, Ending::COMPLETION);
                let change = self.replace(samples, MOST, |at, x| x - fitted.residual[at]);
                if change < DESCENDED * energy(&fitted.residual) {
                    break;
                }
                fitted = Fitted::new(fitted.model, samples, &whitening);
            }
        }
        before.iter().zip(values(samples)).map(|(before, x)| (x - before).powi(2)).sum()
    }

    /// Sets each clipped sample to what is said of its place and value, at least its limit and at
    /// most `most` limits. Returns the energy of the change.
    fn replace(&self, samples: &mut [f64], most: f64, said: impl Fn(usize, f64) -> f64) -> f64 {
        let mut change = 0.0;
        for &ClippedSample { at, limit } in &self.0 {
            let before = samples[at];
            samples[at] = limit * (said(at, before) / limit).clamp(1.0, most);
            change += (samples[at] - before).powi(2);
        }
        change
    }

    /// Sets clipped samples to the modes that ring behind the last one of their strike.
    fn ring_on(&self, samples: &mut [f64], rate_hz: f64, settings: Settings) {
        let onsets = rises(samples, rate_hz);
        let mut stretches = stretches(&onsets, Guard::OF_RISE, samples.len(), rate_hz);
        let ends: Vec<usize> = onsets.iter().skip(1).copied().chain([samples.len()]).collect();
        for (stretch, end) in stretches.iter_mut().zip(ends) {
            let last = self.0[..self.0.partition_point(|clipped| clipped.at < end)].last();
            stretch.start = stretch.start.max(last.map_or(0, |last| last.at + 1));
            if stretch.start + shortest(rate_hz) > stretch.end {
                stretch.end = stretch.start;
            }
        }
        let few = Settings { most_modes: settings.most_modes.min(MORE_MODES), ..settings };
        let Some(free) = free_modes_of(samples, (&stretches, Guard::OF_RISE), rate_hz, few, &[]) else {
            return;
        };
        let amplitudes = amplitudes(samples, &stretches, &free.poles);
        self.replace(samples, MOST_RINGING, |at, x| {
            let Some(strike) = onsets.partition_point(|onset| *onset <= at).checked_sub(1) else { return x };
            let back = stretches[strike].start as f64 - at as f64;
            let modes = free.poles.iter().zip(&amplitudes[strike]).filter(|(pole, _)| pole.decay * back < MOST_GROWTH);
            modes.map(|(pole, amplitude)| (amplitude * pole.power(-back)).re).sum()
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;

    #[test]
    fn modes_that_ring_on_restore_most_of_what_is_clipped() {
        let whole = plain(3, 6.0, 10, -60.0);
        let mut cut = whole.clipped(0.45);
        let limits = Clipped::of(&cut).expect("there are flat tops");
        assert!(limits.0.len() > 100, "{} samples are clipped", limits.0.len());
        let missing = |samples: &[f64]| {
            limits.0.iter().map(|clipped| (samples[clipped.at] - whole.samples[clipped.at]).powi(2)).sum::<f64>()
        };
        let at_first = missing(&cut);
        limits.ring_on(&mut cut, whole.rate_hz, Settings::default());
        let ratio_db = 10.0 * (missing(&cut) / at_first).log10();
        println!("{ratio_db:.1} dB of {} samples", limits.0.len());
        assert!(ratio_db < -26.0, "{ratio_db:.1} dB of what clipping cut off is missing");
        limits.put_back(&mut cut);
        assert_eq!(missing(&cut), at_first);
    }

    #[test]
    fn sounds_without_flat_tops_are_not_clipped() {
        let sound = plain(3, 6.0, 10, -60.0);
        assert_eq!(Clipped::of(&sound.samples), None);
    }
}
