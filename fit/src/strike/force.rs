//! Strikes with a measured force: the object's own response, the force divided out.

use super::high_pass::high_pass;
use super::{Fit, Mode, Settings, Strike, table_acceleration, table_gain};
use crate::FitError;
use crate::contact::PULSE_FWHM;
use crate::distance::{log_spectral_distance_db, lsd_window};
use crate::modes::{Basis, Ending, Gains, Group, Pole, Stretch, estimate_poles, refine};
use crate::segment::Hit;

/// Both sides lose what is below: an impact hammer and a room say little there.
const HIGH_PASS_HZ: f64 = 300.0;
/// Force that belongs to a hit: from so long before its peak, for so long, in seconds.
const FORCE_BEFORE_S: f64 = 0.0015;
const FORCE_LENGTH_S: f64 = 0.0045;
/// Sound of a hit that is fitted at most, in seconds.
const LONGEST_S: f64 = 0.3;
/// Sound and force of a hit are multiplied by its energy to minus this: 0 leaves hits as recorded, 0.5 makes them alike. Chosen by how the first four hits
/// of the two hammer recordings predict the rest: docs/fit.md says how far that is evidence.
const SOFTNESS: f64 = 0.125;
/// A mode refined to a decay so many times the fastest that is searched for is none any more.
const STRAYED: f64 = 4.0;
/// Samples by which a prediction may be early or late.
const DELAYS: i64 = 4;
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

/// Fits the strikes of a recording with its force: the object's own response, with gains at as many positions as there are strikes, in an order
/// in which neighbours are alike. Each strike's contact time is that of the pulse with the measured force's width at half maximum.
///
/// What a strike's figures compare is the model under the measured force, both sides high-passed at 300 Hz.
///
/// # Errors
/// [`FitError::NoForce`], [`FitError::NoModes`].
pub fn fit_force(
    sound: &[f64],
    force: &[f64],
    channel: usize,
    rate_hz: f64,
    hits: &[Hit],
    settings: Settings,
) -> Result<Fit, FitError> {
    let measured = measured_hits(sound, force, channel, rate_hz, hits)?;
    let shared = share_poles(&measured, rate_hz, settings)?;
    let every: Vec<usize> = (0..measured.len()).collect();
    let row = shared.in_a_row(&every);
    let (modes, acceleration) = shared.as_modes(&row, rate_hz);
    let strikes = measured.iter().zip(&shared.places).zip(&shared.residual_db).map(|((hit, place), &residual_db)| {
        let model = shared.sound(place, hit);
        let window = lsd_window(&hit.sound, rate_hz);
        let onset = (hit.at_s * rate_hz).round() as usize;
        Strike {
            hit: Hit { onset, end: onset + hit.sound.len() },
            contact_time_s: force_width_s(force, onset, rate_hz) / PULSE_FWHM,
            peak_force: force.get(onset).copied().unwrap_or(1.0),
            position: shared.prediction_along_db(&row, hit).1,
            acceleration,
            lsd_db: log_spectral_distance_db(&hit.sound[window.clone()], &model[window]),
            residual_db,
        }
    });
    let strikes: Vec<Strike> = strikes.collect();
    let loudest = (0..measured.len()).max_by(|&a, &b| measured[a].energy().total_cmp(&measured[b].energy()));
    Ok(Fit { rate_hz, modes, strikes, measured: true, loudest: loudest.unwrap_or(0) })
}

/// Width of a force pulse at half its maximum, in seconds.
pub fn force_width_s(force: &[f64], peak: usize, rate_hz: f64) -> f64 {
    let half = force.get(peak).copied().unwrap_or(0.0) / 2.0;
    let before = force[..peak.min(force.len())].iter().rev().take_while(|x| **x > half).count();
    let after = force[peak.min(force.len())..].iter().take_while(|x| **x > half).count();
    // Between the last sample above and the first below, along a straight line.
    let crossing = |inside: usize, outside: Option<usize>| {
        let (inside, outside) = (force.get(inside).copied(), outside.and_then(|at| force.get(at)).copied());
        match (inside, outside) {
            (Some(inside), Some(outside)) if inside > outside => (inside - half) / (inside - outside),
            _ => 0.0,
        }
    };
    let first = peak.saturating_sub(before);
    let last = (peak + after).saturating_sub(1);
    ((last - first) as f64 + crossing(first, first.checked_sub(1)) + crossing(last, Some(last + 1))) / rate_hz
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
    let mut cuts = Vec::new();
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
        cuts.push((hit, peak, start, hit.onset.saturating_sub(rise).min(samples(LONGEST_DELAY_S))));
    }
    // Hammer and microphone stand still: one delay for all.
    let mut delays: Vec<usize> = cuts.iter().map(|cut| cut.3).collect();
    delays.sort_unstable();
    let delay = delays.get(delays.len() / 2).copied().unwrap_or(0);
    let mut measured = Vec::new();
    for (hit, peak, start, _) in cuts {
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
    let scaled: Vec<MeasuredHit> = hits.iter().map(|hit| hit.weighed(hit.energy().sqrt().recip())).collect();
    let groups: Vec<Group<'_>> = scaled.iter().map(|hit| Group { stretches: vec![hit.stretch()] }).collect();
    let ending = Ending { steps: 20, ..Ending::COARSE };
    let model = refine(&groups, &poles, ending).ok_or_else(none)?;
    // What has strayed below the high-pass, or decays faster than a mode does, explains the pass's skirt and sounds like a thud.
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

impl MeasuredHit {
    /// Sound and force times `weight`.
    fn weighed(&self, weight: f64) -> Self {
        let times = |samples: &[f64]| samples.iter().map(|x| x * weight).collect();
        Self { sound: times(&self.sound), force: times(&self.force), ..*self }
    }
}

impl Shared {
    /// Number of modes.
    pub fn mode_count(&self) -> usize {
        self.poles.len()
    }

    /// The plain joint least squares of several hits: one set of gains, each hit's force as measured.
    pub fn plain_place(&self, hits: &[MeasuredHit]) -> Option<Place> {
        self.solve_place(hits)
    }

    /// One set of gains for several hits at places of their own. Hits are brought into step with what the others say of them, and
    /// soft ones count for more than their energy: between hits as recorded and hits of one strength.
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

    /// The poles as modes whose gains are those of `places`, one after the other, in the units of tables; and the acceleration sound, the mean over
    /// the places.
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

    /// The places of several hits in a row, each next to the one it is most like: an open path of small steps. Their gains are brought to
    /// the strength of the first.
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

/// The sound `delay` samples later, as long as it was.
fn lagged(sound: &[f64], delay: i64) -> Vec<f64> {
    (0..sound.len() as i64)
        .map(|n| usize::try_from(n - delay).ok().and_then(|at| sound.get(at)).copied().unwrap_or(0.0))
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
