//! Poles that all measured strikes share, with gains at each strike's place.

use super::fit::{Mode, Settings, table_acceleration, table_gain};
use super::measured::{HIGH_PASS_HZ, MeasuredHit};
use crate::error::FitError;
use crate::modes::{Basis, Ending, Gains, Group, Pole, estimate_poles, refine};

/// Exponent of a strike's energy by which sound and force are divided.
///
/// 0 leaves strikes as recorded, 0.5 makes them equally loud. Chosen by how the first four strikes
/// of the two hammer recordings predict the others; docs/fit.md says how far that is evidence.
const SOFTNESS: f64 = 0.125;
/// Ratio to the fastest decay searched for from which a refined pole is no mode any more.
const STRAYED: f64 = 4.0;
/// Largest shift of a prediction in samples, early or late.
const DELAYS: i64 = 4;

/// Gains of an object at one place, with the acceleration sound there.
#[derive(Clone, Debug, PartialEq)]
pub struct Place(Gains);

/// Poles that all strikes share, and the gains of each strike.
#[derive(Clone, Debug)]
pub struct Shared {
    poles: Vec<Pole>,
    /// Gains of each strike.
    pub places: Vec<Place>,
    /// Energy that the model leaves of each strike, in dB.
    pub residual_db: Vec<f64>,
}

/// Finds the poles that all strikes share, with gains of each strike's own.
///
/// # Errors
/// [`FitError::NoModes`] if there is no strike, or no mode in the loudest.
pub fn share_poles(hits: &[MeasuredHit], rate_hz: f64, settings: Settings) -> Result<Shared, FitError> {
    let energy = |hit: &MeasuredHit| hit.energy();
    let Some(loudest) = hits.iter().max_by(|a, b| energy(a).total_cmp(&energy(b))) else {
        return Err(FitError::NoModes { at_s: 0.0 });
    };
    let none = || FitError::NoModes { at_s: loudest.at_s };
    let behind = loudest.force.len() / 2;
    let poles = estimate_poles(&loudest.sound[behind..], rate_hz, settings.modes);
    // All strikes are made equally loud: a soft one says as much of the object.
    let scaled: Vec<MeasuredHit> = hits.iter().map(|hit| hit.weighed(hit.energy().sqrt().recip())).collect();
    let groups: Vec<Group<'_>> = scaled.iter().map(|hit| Group { stretches: vec![hit.stretch()] }).collect();
    let ending = Ending { steps: 20, ..Ending::COARSE };
    let model = refine(&groups, &poles, ending).ok_or_else(none)?;
    // A pole below the high-pass, or one that decays too fast for a mode, explains the filter's
    // skirt and sounds like a thud.
    let is_mode = |pole: &Pole| {
        pole.frequency_hz(rate_hz) > 0.5 * HIGH_PASS_HZ
            && pole.decay_per_s(rate_hz) < STRAYED * settings.modes.fastest_decay_per_s
    };
    let modes: Vec<Pole> = model.poles.iter().copied().filter(is_mode).collect();
    let model = if modes.len() < model.poles.len() && !modes.is_empty() {
        refine(&groups, &modes, Ending { steps: 0, ..Ending::COARSE }).ok_or_else(none)?
    } else {
        model
    };
    let residual_db = groups.iter().enumerate().map(|(index, group)| {
        let left: f64 = model.residual(index, &group.stretches[0]).iter().map(|x| x * x).sum();
        10.0 * left.log10()
    });
    let residual_db = residual_db.collect();
    Ok(Shared { residual_db, places: model.gains.into_iter().map(Place).collect(), poles: model.poles })
}

impl Shared {
    /// Number of modes.
    pub fn mode_count(&self) -> usize {
        self.poles.len()
    }

    /// Gains of several strikes by plain joint least squares, each force as measured.
    pub fn plain_place(&self, hits: &[MeasuredHit]) -> Option<Place> {
        self.solve_place(hits)
    }

    /// One set of gains for several strikes at places of their own.
    ///
    /// Each strike is aligned in time with the prediction from all. Soft strikes count for more
    /// than their energy: between strikes as recorded and strikes of equal strength.
    pub fn common_place(&self, hits: &[MeasuredHit]) -> Option<Place> {
        const ROUNDS: usize = 4;
        let mut aligned: Vec<MeasuredHit> = hits.to_vec();
        let mut place = None;
        for _ in 0..ROUNDS {
            let weighed: Vec<MeasuredHit> =
                aligned.iter().map(|hit| hit.weighed(hit.energy().powf(SOFTNESS).recip())).collect();
            let next = self.solve_place(&weighed)?;
            for (hit, aligned) in hits.iter().zip(&mut aligned) {
                let sound = self.sound(&next, hit);
                let agreement = |delay: i64| dot(&lagged(&sound, delay), &hit.sound);
                let delay =
                    (-DELAYS..=DELAYS).max_by(|&a, &b| agreement(a).total_cmp(&agreement(b))).unwrap_or_default();
                aligned.sound = lagged(&hit.sound, -delay);
            }
            place = Some(next);
        }
        place
    }

    fn solve_place(&self, hits: &[MeasuredHit]) -> Option<Place> {
        let group = Group { stretches: hits.iter().map(MeasuredHit::stretch).collect() };
        let model = refine(&[group], &self.poles, Ending { steps: 0, ..Ending::COARSE })?;
        model.gains.into_iter().next().map(Place)
    }

    /// Sound of the object struck at a place with a strike's force.
    pub(super) fn sound(&self, place: &Place, hit: &MeasuredHit) -> Vec<f64> {
        let stretch = hit.stretch();
        let mut sound = vec![0.0; hit.sound.len()];
        for (&pole, gain) in self.poles.iter().zip(&place.0.modes) {
            Basis::new(pole, &stretch).add(*gain, &mut sound);
        }
        for (sound, force) in sound.iter_mut().zip(&hit.force) {
            *sound += place.0.force * force;
        }
        sound
    }

    /// Energy in dB that one place's prediction leaves of a strike, with delay and one gain free.
    pub fn prediction_db(&self, place: &Place, hit: &MeasuredHit) -> f64 {
        self.prediction_along_db(std::slice::from_ref(place), hit).0
    }

    /// Energy in dB that a prediction between several places in a row leaves of a strike, and the
    /// best position.
    ///
    /// The position is from 0 to 1. Delay and one gain are free.
    pub fn prediction_along_db(&self, places: &[Place], hit: &MeasuredHit) -> (f64, f64) {
        const FINE: usize = 40;
        let sounds: Vec<Vec<f64>> = places.iter().map(|place| self.sound(place, hit)).collect();
        let mut best = (f64::INFINITY, 0.0);
        for delay in -DELAYS..=DELAYS {
            let lagged: Vec<Vec<f64>> = sounds.iter().map(|sound| lagged(sound, delay)).collect();
            let along: Vec<f64> = lagged.iter().map(|sound| dot(sound, &hit.sound)).collect();
            let own: Vec<f64> = lagged.iter().map(|sound| dot(sound, sound)).collect();
            let cross: Vec<f64> = lagged.windows(2).map(|pair| dot(&pair[0], &pair[1])).collect();
            let mut offer = |taken: f64, position: f64| {
                let left = 10.0 * (1.0 - taken / hit.energy()).max(1e-12).log10();
                if left < best.0 {
                    best = (left, position);
                }
            };
            if lagged.len() == 1 {
                offer(along[0].powi(2) / own[0].max(f64::MIN_POSITIVE), 0.0);
            }
            for (index, cross) in cross.iter().enumerate() {
                for step in 0..=FINE {
                    let b = step as f64 / FINE as f64;
                    let a = 1.0 - b;
                    let energy = a * a * own[index] + 2.0 * a * b * cross + b * b * own[index + 1];
                    let taken = (a * along[index] + b * along[index + 1]).powi(2) / energy.max(f64::MIN_POSITIVE);
                    offer(taken, (index as f64 + b) / (places.len() - 1) as f64);
                }
            }
        }
        best
    }

    /// The poles as modes with the gains of `places`, in the units of tables; and the mean
    /// acceleration sound.
    pub fn as_modes(&self, places: &[Place], rate_hz: f64) -> (Vec<Mode>, f64) {
        let modes = self.poles.iter().enumerate().map(|(k, pole)| Mode {
            frequency_hz: pole.frequency_hz(rate_hz),
            decay_per_s: pole.decay_per_s(rate_hz),
            gains: places.iter().map(|place| table_gain(place.0.modes[k], rate_hz)).collect(),
        });
        let mut modes: Vec<Mode> = modes.collect();
        modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        let accelerations = places.iter().map(|place| table_acceleration(&place.0));
        (modes, accelerations.sum::<f64>() / places.len().max(1) as f64)
    }

    /// Places of several strikes in a row, each next to the one most like it: an open path of small
    /// steps.
    ///
    /// Their gains are scaled to the strength of the first.
    pub fn in_a_row(&self, hits: &[usize]) -> Vec<Place> {
        let norm = |place: &Place| place.0.modes.iter().map(|gain| gain.norm_sqr()).sum::<f64>().sqrt();
        let first = hits.first().and_then(|&hit| self.places.get(hit)).map_or(1.0, norm);
        let unit = |place: &Place| {
            let size = norm(place).max(f64::MIN_POSITIVE) / first;
            Place(Gains { modes: place.0.modes.iter().map(|gain| gain / size).collect(), force: place.0.force / size })
        };
        let distance =
            |a: &Place, b: &Place| a.0.modes.iter().zip(&b.0.modes).map(|(a, b)| (a - b).norm_sqr()).sum::<f64>();
        let mut left: Vec<Place> = hits.iter().filter_map(|&hit| self.places.get(hit)).map(unit).collect();
        if left.is_empty() {
            return left;
        }
        let mut row = vec![left.remove(0)];
        while !left.is_empty() {
            let nearest = |end: &Place| {
                (0..left.len())
                    .map(|at| (distance(end, &left[at]), at))
                    .min_by(|a, b| a.0.total_cmp(&b.0))
                    .unwrap_or((0.0, 0))
            };
            let (front, back) = (nearest(&row[0]), nearest(&row[row.len() - 1]));
            if front.0 < back.0 { row.insert(0, left.remove(front.1)) } else { row.push(left.remove(back.1)) }
        }
        row
    }
}

/// The sound delayed by `delay` samples, at its original length.
fn lagged(sound: &[f64], delay: i64) -> Vec<f64> {
    (0..sound.len() as i64)
        .map(|n| usize::try_from(n - delay).ok().and_then(|at| sound.get(at)).copied().unwrap_or(0.0))
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
