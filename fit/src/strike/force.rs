//! Strikes with a measured force: the object's own response, the force divided out.

use super::Settings;
use super::high_pass::high_pass;
use crate::FitError;
use crate::modes::{Basis, Ending, Gains, Group, Pole, Stretch, estimate_poles, refine};
use crate::segment::Hit;

/// Both sides lose what is below: an impact hammer and a room say little there.
const HIGH_PASS_HZ: f64 = 300.0;
/// Force that belongs to a hit: from so long before its peak, for so long, in seconds.
const FORCE_BEFORE_S: f64 = 0.0015;
const FORCE_LENGTH_S: f64 = 0.0045;
/// Sound of a hit that is fitted at most, in seconds.
const LONGEST_S: f64 = 0.3;
/// Largest delay between force and microphone, in seconds (1 m).
const LONGEST_DELAY_S: f64 = 0.003;

/// One hit, cut out: sound and force begin together, the microphone's delay taken away, both through the high-pass.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredHit {
    /// Time of the force's peak in the recording, seconds.
    pub at_s: f64,
    /// The microphone.
    pub sound: Vec<f64>,
    /// The force.
    pub force: Vec<f64>,
    /// Samples by which the microphone hears later.
    pub delay: usize,
}

/// Gains of an object at one place, with the acceleration sound there.
#[derive(Clone, Debug, PartialEq)]
pub struct Place(Gains);

/// Poles that all hits share, and each hit's own gains.
#[derive(Clone, Debug)]
pub struct Shared {
    poles: Vec<Pole>,
    /// Gains, one set a hit.
    pub places: Vec<Place>,
    /// What the model leaves of each hit, dB.
    pub residual_db: Vec<f64>,
}

/// Cuts the hits out of a recording with its force.
///
/// # Errors
/// [`FitError::NoForce`] for a force channel without pulses.
pub fn measured_hits(
    sound: &[f64],
    force: &[f64],
    channel: usize,
    rate_hz: f64,
    hits: &[Hit],
) -> Result<Vec<MeasuredHit>, FitError> {
    let samples = |seconds: f64| (seconds * rate_hz).round() as usize;
    let loudest = force.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let mut levels: Vec<f64> = force.iter().map(|x| x.abs()).collect();
    levels.sort_by(f64::total_cmp);
    let noise = levels.get(levels.len() / 2).copied().unwrap_or(0.0);
    if loudest <= 10.0 * noise || loudest <= 0.0 {
        return Err(FitError::NoForce { channel });
    }
    let (sound, filtered) = (high_pass(sound, HIGH_PASS_HZ, rate_hz), high_pass(force, HIGH_PASS_HZ, rate_hz));
    let mut measured = Vec::new();
    for hit in hits {
        let from = hit.onset.saturating_sub(samples(0.004));
        let near = &force[from.min(force.len())..force.len().min(hit.onset + samples(0.002))];
        let Some((peak, height)) = near.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) else { continue };
        if *height < 10.0 * noise {
            continue;
        }
        let peak = from + peak;
        let start = peak.saturating_sub(samples(FORCE_BEFORE_S));
        let rise = (start..peak).find(|&n| force[n] > 0.1 * height).unwrap_or(start);
        let delay = hit.onset.saturating_sub(rise).min(samples(LONGEST_DELAY_S));
        let end = sound.len().min(hit.end).min(start + delay + samples(LONGEST_S));
        if end <= start + delay + samples(FORCE_LENGTH_S) {
            continue;
        }
        let force_end = filtered.len().min(start + samples(FORCE_LENGTH_S));
        measured.push(MeasuredHit {
            at_s: peak as f64 / rate_hz,
            sound: sound[start + delay..end].to_vec(),
            force: filtered[start..force_end].to_vec(),
            delay,
        });
    }
    if measured.is_empty() { Err(FitError::NoForce { channel }) } else { Ok(measured) }
}

impl MeasuredHit {
    fn stretch(&self) -> Stretch<'_> {
        Stretch { samples: &self.sound, force: Some(&self.force) }
    }

    fn energy(&self) -> f64 {
        self.sound.iter().map(|x| x * x).sum()
    }
}

/// Finds the poles that all hits share, with gains of each hit's own.
///
/// # Errors
/// [`FitError::NoModes`].
pub fn share_poles(hits: &[MeasuredHit], rate_hz: f64, settings: Settings) -> Result<Shared, FitError> {
    let energy = |hit: &MeasuredHit| hit.energy();
    let Some(loudest) = hits.iter().max_by(|a, b| energy(a).total_cmp(&energy(b))) else {
        return Err(FitError::NoModes { at_s: 0.0 });
    };
    let none = || FitError::NoModes { at_s: loudest.at_s };
    let behind = loudest.force.len() / 2;
    let poles = estimate_poles(&loudest.sound[behind..], rate_hz, settings.modes);
    // Each hit as loud as the others: a soft one says as much of the object.
    let scaled: Vec<MeasuredHit> = hits.iter().map(|hit| hit.scaled(1.0, hit.energy().sqrt().recip())).collect();
    let groups: Vec<Group<'_>> = scaled.iter().map(|hit| Group { stretches: vec![hit.stretch()] }).collect();
    let ending = Ending { steps: 20, ..Ending::COARSE };
    let model = refine(&groups, &poles, ending).ok_or_else(none)?;
    let residual_db = groups.iter().enumerate().map(|(index, group)| {
        let left: f64 = model.residual(index, &group.stretches[0]).iter().map(|x| x * x).sum();
        10.0 * left.log10()
    });
    let residual_db = residual_db.collect();
    Ok(Shared { residual_db, places: model.gains.into_iter().map(Place).collect(), poles: model.poles })
}

impl MeasuredHit {
    /// The force times `gain`, then both times `weight`.
    fn scaled(&self, gain: f64, weight: f64) -> Self {
        let times = |samples: &[f64], factor: f64| samples.iter().map(|x| x * factor).collect();
        Self { sound: times(&self.sound, weight), force: times(&self.force, gain * weight), ..*self }
    }
}

impl Shared {
    /// Number of modes.
    pub fn mode_count(&self) -> usize {
        self.poles.len()
    }

    /// The plain joint least squares of several hits: one set of gains, each hit's force as measured.
    pub fn plain_place(&self, hits: &[MeasuredHit]) -> Option<Place> {
        self.solve_place(&hits.iter().map(|hit| hit.scaled(1.0, 1.0)).collect::<Vec<_>>())
    }

    /// One set of gains for several hits, each of which may have been stronger or weaker than its force channel says: gains and
    /// strengths in turn, every hit weighed alike.
    pub fn common_place(&self, hits: &[MeasuredHit]) -> Option<Place> {
        const ROUNDS: usize = 12;
        let mut strengths = vec![1.0; hits.len()];
        let mut place = None;
        for _ in 0..ROUNDS {
            let scaled: Vec<MeasuredHit> = hits
                .iter()
                .zip(&strengths)
                .map(|(hit, strength)| hit.scaled(*strength, hit.energy().sqrt().recip()))
                .collect();
            let next = self.solve_place(&scaled)?;
            for (strength, hit) in strengths.iter_mut().zip(hits) {
                let sound = self.sound(&next, hit);
                *strength = dot(&sound, &hit.sound) / dot(&sound, &sound).max(f64::MIN_POSITIVE);
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

    /// How the object sounds when struck at a place with a hit's force.
    fn sound(&self, place: &Place, hit: &MeasuredHit) -> Vec<f64> {
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

    /// What one place's prediction leaves of a hit in dB, delay and one gain free.
    pub fn prediction_db(&self, place: &Place, hit: &MeasuredHit) -> f64 {
        self.prediction_along_db(std::slice::from_ref(place), hit).0
    }

    /// What a prediction from several places in a row leaves of a hit, at the best position between them: dB, and the position from 0 to 1.
    /// Delay and one gain are free.
    pub fn prediction_along_db(&self, places: &[Place], hit: &MeasuredHit) -> (f64, f64) {
        const DELAYS: i64 = 4;
        const FINE: usize = 40;
        let sounds: Vec<Vec<f64>> = places.iter().map(|place| self.sound(place, hit)).collect();
        let mut best = (f64::INFINITY, 0.0);
        for delay in -DELAYS..=DELAYS {
            let lag = |sound: &[f64]| -> Vec<f64> {
                (0..sound.len() as i64)
                    .map(|n| usize::try_from(n - delay).ok().and_then(|at| sound.get(at)).copied().unwrap_or(0.0))
                    .collect()
            };
            let lagged: Vec<Vec<f64>> = sounds.iter().map(|sound| lag(sound)).collect();
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

    /// The places of several hits in a row, each next to the one it is most like: an open path of small steps. Their gains are brought to
    /// one strength.
    pub fn in_a_row(&self, hits: &[usize]) -> Vec<Place> {
        let unit = |place: &Place| {
            let size = place.0.modes.iter().map(|gain| gain.norm_sqr()).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
            Place(Gains {
                modes: place.0.modes.iter().map(|gain| gain / size).collect(),
                force: place.0.force / size,
            })
        };
        let distance = |a: &Place, b: &Place| {
            a.0.modes.iter().zip(&b.0.modes).map(|(a, b)| (a - b).norm_sqr()).sum::<f64>()
        };
        let mut left: Vec<Place> = hits.iter().filter_map(|&hit| self.places.get(hit)).map(unit).collect();
        if left.is_empty() {
            return left;
        }
        let mut row = vec![left.remove(0)];
        while !left.is_empty() {
            let nearest = |end: &Place| {
                (0..left.len()).map(|at| (distance(end, &left[at]), at)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0))
            };
            let (front, back) = (nearest(&row[0]), nearest(&row[row.len() - 1]));
            if front.0 < back.0 { row.insert(0, left.remove(front.1)) } else { row.push(left.remove(back.1)) }
        }
        row
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
