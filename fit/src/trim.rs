//! Last corrections of a fitted strike: levels of its loudest partials, its peak and its attack.
//!
//! The descent lowers distances that are means over bands and frames. A single partial may stay
//! 4 dB off, and modes and noise may meet in one sample that stands above the recording's peak.
//! All are heard, so all are measured in dsp-core's rendering and corrected:
//!
//! - The mode nearest to a loud partial gets the gain that brings the partial near its level.
//! - What makes a peak or the first 3 ms too loud is lowered. Each mode's share is its own part of
//!   these samples times its decay, so that short modes give way before those that ring.
//!
//! Faults are counted again in the new rendering, and the strike with the fewest is kept.

use std::ops::Range;

use fourier::Complex;

use crate::band::Band;
use crate::contact;
use crate::error::FitError;
use crate::hearing::{ATTACK_S, Heard, Partial, RIGHT_DB};
use crate::joint::{self, HELD, LOUDEST};
use crate::modes::{Basis, Pole, Stretch};
use crate::stages::{self, RecordedStrike};
use crate::strike::{Fit, Mode};
use crate::table::{self, Provenance};

/// Error that a corrected partial keeps, in dB: the descent weighed it against other distances.
const KEPT_DB: f64 = 2.0;
/// Distance of a mode from its partial within which it makes the partial's level, in bins.
const MAIN_LOBE_BINS: f64 = 1.5;
/// Largest change of a mode's level in one round, in dB.
const MOST_CHANGE_DB: f64 = 9.0;
/// Largest level of the rendering's peak, and of its attack, over the recording's, in dB.
const MOST_OVER_DB: f64 = 3.0;
/// Level over the recording's to which a peak or an attack is lowered, in dB.
const WANTED_OVER_DB: f64 = 2.7;
/// Largest share of its gain that a mode loses in one round.
const MOST_LOSS: f64 = 0.9;
/// Largest share of all parts that is taken away in one round.
const MOST_SURPLUS: f64 = 0.5;
/// Relative distance of a partial from its mode up to which it has one.
const NEAR: f64 = 0.005;
/// Maximum number of rounds.
const ROUNDS: usize = 8;

/// Length in seconds behind the recording's peak that is rendered: the last spectrum of partials
/// ends there.
const RENDERED_S: f64 = 1.1;

/// Brings a fit's loudest partials, peak and attack near to the recording's, in a few rounds.
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
    let trim = Trim::new(heard, stage.samples(), stage.rate_hz());
    let strike = stage.samples();
    let length = strike.len().min(peak_at(strike) + (RENDERED_S * stage.rate_hz()) as usize);
    let rendered = |fit: &Fit| -> Result<Rendered, FitError> {
        let table = table::of_fit(fit, provenance);
        let modes = stage.render(&table, length)?;
        Ok(Rendered { modes, whole: stage.render(&stages::noisy(table, &fit.noise), length)? })
    };
    let mut now = fit;
    let mut sound = rendered(&now)?;
    let mut faults = trim.faults(&now, &sound);
    let mut best = now.clone();
    for _ in 0..ROUNDS {
        if faults == 0 {
            break;
        }
        trim.correct(&mut now, &sound);
        sound = rendered(&now)?;
        let left = trim.faults(&now, &sound);
        if left < faults {
            (faults, best) = (left, now.clone());
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
    /// Samples of the strike.
    strike: &'a [f64],
    /// Sample of the strike's peak.
    peak: usize,
    /// Number of samples of the attack.
    attack: usize,
    /// The loudest partials, each with its place among all partials.
    partials: Vec<(usize, Partial)>,
}

impl<'a> Trim<'a> {
    /// The strike whose samples are `strike`.
    fn new(heard: &'a Heard, strike: &'a [f64], rate_hz: f64) -> Self {
        let attack = ((ATTACK_S * rate_hz) as usize).min(strike.len());
        Self { heard, strike, peak: peak_at(strike), attack, partials: heard.partials().loudest(LOUDEST) }
    }

    /// Number of loudest partials that lack a mode or are off by more than 3 dB, and one more for
    /// each of peak and attack that stands more than 3 dB over the recording's.
    fn faults(&self, fit: &Fit, rendered: &Rendered) -> usize {
        let errors_db = self.heard.partials().errors_db(&rendered.whole);
        let is_wrong = |(index, partial): &&(usize, Partial)| {
            let reach_hz = (NEAR * partial.frequency_hz).max(0.5 * self.heard.partials().bin_hz());
            let off_hz = nearest(fit, partial.frequency_hz).map_or(f64::INFINITY, |(_, off_hz)| off_hz.abs());
            off_hz > reach_hz || errors_db[*index].abs() > RIGHT_DB
        };
        let wrong = self.partials.iter().filter(is_wrong).count();
        wrong + self.over_db(rendered).iter().filter(|(_, over_db)| *over_db > MOST_OVER_DB).count()
    }

    /// Levels of a rendering's peak and of its attack over the recording's in dB, each with the
    /// samples that make it.
    fn over_db(&self, rendered: &Rendered) -> [(Range<usize>, f64); 2] {
        let at = peak_at(&rendered.whole);
        let attack = 0..self.attack.min(rendered.whole.len());
        [at..at + 1, attack].map(|range| {
            let wanted =
                if range.len() == 1 { &self.strike[self.peak..=self.peak] } else { &self.strike[range.clone()] };
            let ratio = energy(&rendered.whole[range.clone()]) / energy(wanted);
            (range, 10.0 * ratio.log10())
        })
    }

    /// Corrects the levels of a fit's partials, its peak and its attack.
    fn correct(&self, fit: &mut Fit, rendered: &Rendered) {
        let mut changes = Changes { modes: vec![1.0; fit.modes.len()], noise: 1.0 };
        for (range, over_db) in self.over_db(rendered) {
            if over_db > MOST_OVER_DB {
                let surplus = 1.0 - 10f64.powf((WANTED_OVER_DB - over_db) / 20.0);
                changes.lower(fit, rendered, range, surplus);
            }
        }
        let errors_db = self.heard.partials().errors_db(&rendered.whole);
        let modes: Vec<_> = self.partials.iter().map(|(_, partial)| nearest(fit, partial.frequency_hz)).collect();
        let mut done: Vec<usize> = Vec::new();
        for ((index, partial), mode) in self.partials.iter().zip(modes) {
            let Some((mode, off_hz)) = mode else { continue };
            if done.contains(&mode) {
                continue;
            }
            done.push(mode);
            let (held_hz, bin_hz) = (HELD * partial.frequency_hz, self.heard.partials().bin_hz());
            let is_off = off_hz.abs() > held_hz.max(0.5 * bin_hz);
            let error_db = errors_db[*index];
            if error_db.abs() <= RIGHT_DB && !is_off {
                continue;
            }
            // Beyond the window's main lobe a mode does not sound in the partial's bins.
            let limit_hz = held_hz.min(MAIN_LOBE_BINS * bin_hz);
            if off_hz.abs() > limit_hz {
                fit.modes[mode].frequency_hz = partial.frequency_hz + limit_hz * off_hz.signum();
            }
            let change_db = error_db.clamp(-KEPT_DB, KEPT_DB) - error_db;
            let change_db = change_db.clamp(-MOST_CHANGE_DB, MOST_CHANGE_DB);
            changes.modes[mode] *= 10f64.powf(change_db / 20.0);
        }
        for (mode, factor) in changes.modes.into_iter().enumerate() {
            scale(fit, mode, factor);
        }
        fit.noise.iter_mut().for_each(|band| band.weight *= changes.noise);
        part_cancelling(fit);
        fit.modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    }
}

/// Factors on the gain of each mode and on all noise.
struct Changes {
    modes: Vec<f64>,
    noise: f64,
}

impl Changes {
    /// Lowers what makes a rendering of `fit` loud in a range of samples.
    ///
    /// The range loses a share of its amplitude, `surplus`. Nothing is changed if that takes more
    /// than half of the modes that make it.
    fn lower(&mut self, fit: &Fit, rendered: &Rendered, range: Range<usize>, surplus: f64) {
        let Some(strike) = fit.strikes.get(fit.loudest) else { return };
        let whole = &rendered.whole[range.clone()];
        let all = energy(whole);
        let share = |part: &[f64]| part.iter().zip(whole).map(|(part, whole)| part * whole).sum::<f64>() / all;
        let silence = vec![0.0; range.end];
        let force = contact::force(strike.contact_time_s, fit.rate_hz);
        let stretch = Stretch { samples: &silence, force: Some(&force[..force.len().min(range.end)]) };
        let of_mode = |mode: &Mode| {
            let [sine, cosine] = mode.gains.get(fit.loudest).copied().unwrap_or_default();
            let gain = Complex::new(cosine, -sine) * (strike.peak_force / fit.rate_hz);
            let mut sound = silence.clone();
            Basis::new(Pole::new(mode.frequency_hz, mode.decay_per_s, fit.rate_hz), &stretch).add(gain, &mut sound);
            (share(&sound[range.clone()]).max(0.0), mode.decay_per_s)
        };
        let noise: Vec<f64> =
            whole.iter().zip(&rendered.modes[range.clone()]).map(|(whole, modes)| whole - modes).collect();
        let decay = |band: &Band| band.decay_db_per_s / DECIBELS_A_NEPER;
        let noise_decay = fit.noise.iter().map(decay).sum::<f64>() / fit.noise.len().max(1) as f64;
        let mut parts: Vec<(f64, f64)> = fit.modes.iter().map(of_mode).collect();
        // Noise fills more than its attack: a draw that is loud there stays.
        let is_peak = whole.len() == 1;
        parts.push(if is_peak { (share(&noise).max(0.0), noise_decay) } else { (0.0, 0.0) });
        let Some(losses) = losses(&parts, surplus) else { return };
        for (factor, loss) in self.modes.iter_mut().chain([&mut self.noise]).zip(losses) {
            *factor *= 1.0 - loss;
        }
    }
}

/// Decibels in a neper of amplitude.
const DECIBELS_A_NEPER: f64 = 8.685_889_638;

/// Shares of parts to take away, so that `surplus` is gone of their sum; `None` if it is too much.
///
/// A share is proportional to the part and to its weight, and at most nine tenths.
fn losses(parts: &[(f64, f64)], surplus: f64) -> Option<Vec<f64>> {
    let share = |factor: f64, (part, weight): &(f64, f64)| (factor * part * weight).min(MOST_LOSS);
    let taken = |factor: f64| parts.iter().map(|part| part.0 * share(factor, part)).sum::<f64>();
    if surplus > MOST_SURPLUS * parts.iter().map(|part| part.0).sum::<f64>() {
        return None;
    }
    let (mut low, mut high) = (0.0, 1.0);
    while taken(high) < surplus && high < MOST_FACTOR {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if taken(middle) < surplus { low = middle } else { high = middle }
    }
    Some(parts.iter().map(|part| share(high, part)).collect())
}

/// Largest factor of all losses.
const MOST_FACTOR: f64 = 1e12;
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

fn energy(sound: &[f64]) -> f64 {
    sound.iter().map(|x| x * x).sum::<f64>().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render;
    use crate::segment::Hit;
    use crate::strike::Strike;

    const RATE_HZ: f64 = 44_100.0;

    /// Modes of 500 Hz, 1400 Hz and, if its gain is not 0, a short one of 3 kHz, with faint noise.
    fn fit_of(gains: [f64; 3]) -> Fit {
        let mode = |(frequency_hz, decay_per_s, gain)| Mode { frequency_hz, decay_per_s, gains: vec![[gain, 0.0]] };
        let modes = [(500.0, 8.0, gains[0]), (1_400.0, 8.0, gains[1]), (3_000.0, 700.0, gains[2])];
        let strike = Strike {
            hit: Hit { onset: 0, end: RATE_HZ as usize },
            contact_time_s: 3e-4,
            peak_force: 1.0,
            position: 0.0,
            acceleration: 0.0,
            lsd_db: 0.0,
            residual_db: 0.0,
        };
        let noise = vec![Band { edges_hz: [2_000.0, 3_000.0], weight: 1e-6, decay_db_per_s: 40.0 }];
        let modes = modes.into_iter().filter(|mode| mode.2 > 0.0).map(mode).collect();
        Fit { modes, strikes: vec![strike], noise, ..Fit::silent(RATE_HZ) }
    }

    /// A fit trimmed to the sound of another one, and the levels of peaks over that sound's in dB,
    /// before and after.
    fn trimmed_to(wanted: &Fit, given: Fit) -> (Fit, [f64; 2]) {
        let provenance = Provenance { name: "bar".to_owned(), source: String::new(), licence: String::new() };
        let sound = |fit: &Fit| {
            render::by_instrument(&table::of_fit(fit, &provenance), 0.0, RATE_HZ, RATE_HZ as usize).expect("it plays")
        };
        let recording = sound(wanted);
        let stage = RecordedStrike::new(&[], &recording, RATE_HZ, 0.0);
        let heard = Heard::new(&recording, RATE_HZ, 0, recording.len());
        let trimmed = trimmed(given.clone(), &stage, &heard, &provenance).expect("it plays");
        let over_db = [&given, &trimmed].map(|fit| heard.scores(&sound(fit)).peak_db);
        (trimmed, over_db)
    }

    /// Runs a test on a stack that holds the engine which renders tables.
    fn on_a_large_stack(test: fn()) {
        let thread = std::thread::Builder::new().stack_size(64 << 20).spawn(test);
        thread.expect("a thread can be started").join().expect("the test passes");
    }

    #[test]
    fn a_partial_that_is_8_db_too_soft_comes_within_3_db_and_the_other_stays() {
        on_a_large_stack(|| {
            let (trimmed, _) = trimmed_to(&fit_of([500.0, 400.0, 0.0]), fit_of([500.0, 160.0, 0.0]));
            let level_db = 20.0 * (trimmed.modes[1].gains[0][0] / 400.0).log10();
            assert!(level_db.abs() <= 3.0, "{level_db} dB");
            assert_eq!(trimmed.modes[0].gains[0][0], 500.0);
        });
    }

    #[test]
    fn a_mode_beside_the_bins_of_its_partial_is_moved_into_them() {
        on_a_large_stack(|| {
            let with_mode_at = |frequency_hz: f64| {
                let mut fit = fit_of([500.0, 400.0, 0.0]);
                fit.modes[1].frequency_hz = frequency_hz;
                fit
            };
            let (trimmed, _) = trimmed_to(&with_mode_at(4_425.0), with_mode_at(4_437.0));
            let off_hz = trimmed.modes[1].frequency_hz - 4_425.0;
            assert!(off_hz.abs() < 2.0 * RATE_HZ / 8_192.0, "{off_hz} Hz");
        });
    }

    #[test]
    fn a_short_mode_that_makes_a_peak_is_lowered_and_ringing_modes_stay() {
        on_a_large_stack(|| {
            let (trimmed, [before, after]) = trimmed_to(&fit_of([500.0, 400.0, 0.0]), fit_of([500.0, 400.0, 1_500.0]));
            assert!(before > 3.2 && after <= 3.0, "{before} dB, {after} dB");
            let ringing = [trimmed.modes[0].gains[0][0] / 500.0, trimmed.modes[1].gains[0][0] / 400.0];
            assert!(ringing.iter().all(|ratio| (0.95..=1.0).contains(ratio)), "{ringing:?}");
        });
    }

    #[test]
    fn losses_take_the_surplus_away_and_spare_what_rings() {
        let parts = [(0.5, 2.0), (0.3, 200.0), (0.0, 1_000.0)];
        let losses = losses(&parts, 0.1).expect("0.1 of 0.8 can be taken");
        let taken: f64 = parts.iter().zip(&losses).map(|((part, _), loss)| part * loss).sum();
        assert!((taken - 0.1).abs() < 1e-6, "{losses:?}");
        assert!(losses[1] > 10.0 * losses[0], "{losses:?}");
    }

    #[test]
    fn nothing_is_taken_if_half_of_all_parts_is_less_than_the_surplus() {
        assert!(losses(&[(0.5, 2.0), (0.3, 9.0)], 0.5).is_none());
    }
}
