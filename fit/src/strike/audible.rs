//! Choice of modes by the loudness that they explain.

use crate::hearing::{HOP_S, Loudness, specific_loudness};
use crate::modes::DampedSine;

/// Number of times at which loudness is compared.
const TIMES: usize = 28;
/// Share of the strike's loudness that a mode has to explain at least.
const LEAST_SHARE: f64 = 1e-4;
/// Exponent of time on whose scale the times are evenly spread: the beginning is denser.
const CROWDING: f64 = 2.0;

/// Loudness of a strike at some times, and the excitation of the modes chosen so far.
pub(super) struct Chosen {
    modes: Vec<DampedSine>,
    times: Vec<(usize, f64)>,
    /// Wanted loudness by band and time.
    wanted: Vec<Vec<f64>>,
    /// Excitation of the chosen modes by band and time.
    given: Vec<Vec<f64>>,
}

impl Chosen {
    /// No modes yet.
    pub(super) fn none(loudness: &Loudness) -> Self {
        Self::of_excitation(loudness.excitation(), loudness.background())
    }

    fn of_excitation(excitation: &[Vec<f64>], background: &[f64]) -> Self {
        let frames = excitation.first().map_or(0, Vec::len);
        let place = |index: usize| ((index as f64 / TIMES as f64).powf(CROWDING) * frames as f64) as usize;
        let mut starts: Vec<usize> = (0..=TIMES).map(place).collect();
        starts.dedup();
        let times: Vec<(usize, f64)> =
            starts.windows(2).map(|pair| (usize::midpoint(pair[0], pair[1]), (pair[1] - pair[0]) as f64)).collect();
        let wanted = excitation.iter().zip(background).map(|(band, background)| {
            let loudness = |&(frame, _): &(usize, f64)| specific_loudness((band[frame] - background).max(0.0));
            times.iter().map(loudness).collect()
        });
        let wanted: Vec<Vec<f64>> = wanted.collect();
        let given = vec![vec![0.0; times.len()]; wanted.len()];
        Self { modes: Vec::new(), times, wanted, given }
    }

    /// Modes that were taken, and the excitation of what they leave.
    pub(super) fn of_rest(modes: Vec<DampedSine>, rest: &[Vec<f64>]) -> Self {
        let background = vec![0.0; rest.len()];
        Self { modes, ..Self::of_excitation(rest, &background) }
    }

    /// Modes that were taken, the best first.
    pub(super) fn modes(&self) -> &[DampedSine] {
        &self.modes
    }

    /// Takes the candidates that explain most loudness, until there are `most` modes.
    ///
    /// One after the other is taken: that which brings the loudness of those already taken nearest
    /// to the recording's, in all bands and at all times. A mode that explains less than a
    /// ten-thousandth of the strike's loudness is not taken.
    pub(super) fn take_from(&mut self, candidates: &[DampedSine], loudness: &Loudness, most: usize) {
        let least = LEAST_SHARE * self.total();
        let responses: Vec<Vec<(usize, f64)>> =
            candidates.iter().map(|mode| loudness.of_sine(mode.frequency_hz)).collect();
        let mut gains: Vec<f64> =
            candidates.iter().zip(&responses).map(|(mode, response)| self.gain(mode, response)).collect();
        let mut is_free = vec![true; candidates.len()];
        while self.modes.len() < most {
            let free = (0..candidates.len()).filter(|&index| is_free[index]);
            let best = free.max_by(|&a, &b| gains[a].total_cmp(&gains[b]));
            let Some(best) = best.filter(|&best| gains[best] > least) else { break };
            is_free[best] = false;
            if self.modes.iter().any(|mode| are_one(mode, &candidates[best])) {
                continue;
            }
            self.take(&candidates[best], &responses[best]);
            let touched: Vec<usize> = responses[best].iter().map(|(band, _)| *band).collect();
            for index in (0..candidates.len()).filter(|&index| is_free[index]) {
                if responses[index].iter().any(|(band, _)| touched.contains(band)) {
                    gains[index] = self.gain(&candidates[index], &responses[index]);
                }
            }
        }
    }

    fn total(&self) -> f64 {
        let band =
            |band: &Vec<f64>| band.iter().zip(&self.times).map(|(loudness, time)| loudness * time.1).sum::<f64>();
        self.wanted.iter().map(band).sum()
    }

    fn excitation(mode: &DampedSine, frame: usize) -> f64 {
        mode.amplitude.powi(2) * (-2.0 * mode.decay_per_s * (frame as f64 + 0.5) * HOP_S).exp()
    }

    /// Loudness that a mode brings to the right place, less that in the wrong place.
    fn gain(&self, mode: &DampedSine, response: &[(usize, f64)]) -> f64 {
        let mut gain = 0.0;
        for (index, &(frame, weight)) in self.times.iter().enumerate() {
            let power = Self::excitation(mode, frame);
            for &(band, share) in response {
                let (wanted, given) = (self.wanted[band][index], self.given[band][index]);
                let [before, after] = [given, given + power * share].map(specific_loudness);
                gain += weight * ((wanted - before).abs() - (wanted - after).abs());
            }
        }
        gain
    }

    fn take(&mut self, mode: &DampedSine, response: &[(usize, f64)]) {
        for (index, &(frame, _)) in self.times.iter().enumerate() {
            let power = Self::excitation(mode, frame);
            for &(band, share) in response {
                self.given[band][index] += power * share;
            }
        }
        self.modes.push(*mode);
    }
}

/// True if two modes lie within a quarter of their common width.
pub(super) fn are_one(a: &DampedSine, b: &DampedSine) -> bool {
    let width_hz = (a.decay_per_s + b.decay_per_s) / std::f64::consts::TAU;
    (a.frequency_hz - b.frequency_hz).abs() < 0.25 * width_hz
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(frequency_hz: f64, decay_per_s: f64, level_db: f64) -> DampedSine {
        DampedSine { frequency_hz, decay_per_s, amplitude: 10f64.powf(level_db / 20.0), phase: 0.0 }
    }

    #[test]
    fn a_loud_low_partial_comes_before_stronger_inaudible_ones() {
        let modes =
            [sine(330.0, 5.0, -30.0), sine(16_500.0, 5.0, -22.0), sine(4_000.0, 5.0, -20.0), sine(4_003.0, 5.0, -22.0)];
        let mut sound = vec![0.0; 44_100];
        modes.iter().for_each(|mode| mode.add_to(&mut sound, 44_100.0));
        let loudness = Loudness::new(&sound, &[], 44_100.0);
        let mut chosen = Chosen::none(&loudness);
        chosen.take_from(&modes, &loudness, 2);
        let chosen: Vec<f64> = chosen.modes().iter().map(|mode| mode.frequency_hz).collect();
        assert!(chosen.contains(&330.0) && chosen.iter().any(|hz| (hz - 4_000.0).abs() < 5.0), "{chosen:?}");
    }
}
