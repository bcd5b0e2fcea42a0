//! Stems: the sound of each part of a recording, through the contacts of its blows.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Complex;
use rayon::prelude::*;

use super::clip::Clip;
use super::common::{Owned, passes};
use super::contact::{Contact, Expected, find, gains};
use super::parts::Parts;
use super::separation::{Blow, PartMode, STEPS, Separation, Stems};
use crate::modes::{Basis, Gains, Pole, Stretch};

/// Contact and gains of one blow.
#[derive(Clone, Debug)]
struct Struck {
    contact: Contact,
    /// Sample before which the next blow begins.
    end: usize,
    gains: Gains,
    /// Power of the force's spectrum at each pole; 1 for an impulse.
    response: Vec<f64>,
    /// Mean square of what is left behind the blow.
    noise: f64,
}

impl Struck {
    /// Squared amplitude with which a mode rings after the contact, referred to its beginning.
    fn power(&self, index: usize) -> f64 {
        self.gains.modes[index].norm_sqr() * self.response[index]
    }

    /// Squared amplitudes of all modes together.
    fn strength(&self) -> f64 {
        (0..self.gains.modes.len()).map(|index| self.power(index)).sum()
    }
}

/// Blows of one recording, and the poles of its two parts.
struct Recorded {
    members: Vec<usize>,
    poles: Vec<Pole>,
    struck: Vec<Struck>,
}

/// Number of times that the gains are found anew with what all recordings let expect.
const ROUNDS: usize = 2;
/// Time in seconds before a blow at which the sound of the one before it ends to count.
const LEAD_S: f64 = 0.002;
/// Least expected share of a mode in a blow's energy.
const LEAST_SHARE: f64 = 1e-9;
/// Least power of a force's spectrum at a pole, -60 dB: spectra of half-sines have zeros.
const LEAST_RESPONSE: f64 = 1e-6;

/// Stems of all recordings, and the modes of all parts; `None` if a recording cannot be solved for.
pub(super) fn separated(
    clips: &[Clip<'_>],
    parts: &Parts,
    blows: &[Vec<usize>],
    owned: &Owned,
    report: &(dyn Fn(usize) + Sync),
) -> Option<Separation> {
    let done = AtomicUsize::new(0);
    let recorded = (0..clips.len()).into_par_iter().map(|index| {
        let found = contacts(&clips[index], &blows[index], owned, owned.of_clip(parts, index));
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        report(passes() + (STEPS - passes()) * done / clips.len());
        found
    });
    let mut recorded: Vec<Recorded> = recorded.collect::<Option<_>>()?;
    for _ in 0..ROUNDS {
        let shares = shares(&recorded, owned);
        recorded = recorded
            .into_par_iter()
            .zip(clips)
            .map(|(recorded, clip)| with_expected(clip, recorded, &shares))
            .collect::<Option<_>>()?;
    }
    let stems = recorded.par_iter().zip(clips).enumerate();
    let stems =
        stems.map(|(index, (recorded, clip))| stems_of(clip, recorded, owned, parts.of_clip[index][0])).collect();
    let modes = |part: usize| modes_of(part, &recorded, owned, clips.first().map_or(1.0, |clip| clip.rate_hz));
    Some(Separation {
        objects: (0..parts.objects).map(modes).collect(),
        strikers: (parts.objects..parts.count).map(modes).collect(),
        stems,
    })
}

/// Contacts of a recording's blows, one after the other.
fn contacts(clip: &Clip<'_>, blows: &[usize], owned: &Owned, members: Vec<usize>) -> Option<Recorded> {
    let poles: Vec<Pole> = members.iter().map(|&member| owned.poles[member]).collect();
    let mut left = clip.samples.to_vec();
    let lead = (LEAD_S * clip.rate_hz) as usize;
    let mut struck = Vec::with_capacity(blows.len());
    for (index, &blow) in blows.iter().enumerate() {
        let end =
            blows.get(index + 1).map_or(left.len(), |next| next.saturating_sub(lead)).max(blow + 8).min(left.len());
        let contact = find(&left, blow, end, &poles, clip.rate_hz);
        let blow = solved(&left, contact, end, &poles, None)?;
        subtract(&mut left, &blow, &poles);
        struck.push(blow);
    }
    Some(Recorded { members, poles, struck })
}

/// Gains of a blow, of which the sound up to sample `end` tells.
fn solved(left: &[f64], contact: Contact, end: usize, poles: &[Pole], expected: Option<&Expected>) -> Option<Struck> {
    let first = contact.first_sample().min(end.saturating_sub(2));
    let (gains, energy) = gains(&left[first..end], &contact.force(), poles, expected)?;
    let force = contact.force();
    let response = poles.iter().map(|&pole| {
        let spectrum: Complex<f64> = force.iter().enumerate().map(|(n, x)| pole.power(-(n as f64)) * *x).sum();
        spectrum.norm_sqr().max(LEAST_RESPONSE)
    });
    let response = response.collect();
    Some(Struck { contact, end, gains, response, noise: energy.max(0.0) / (end - first) as f64 })
}

/// Sounds of modes `chosen`, and of the force, added with a sign.
fn add(samples: &mut [f64], blow: &Struck, poles: &[Pole], sign: f64, chosen: impl Fn(usize) -> bool, force: bool) {
    let first = blow.contact.first_sample().min(samples.len());
    let behind = &mut samples[first..];
    let mut push = blow.contact.force();
    push.truncate(behind.len());
    let silence = vec![0.0; behind.len()];
    let stretch = Stretch { samples: &silence, force: Some(&push) };
    for (index, (&pole, gain)) in poles.iter().zip(&blow.gains.modes).enumerate() {
        if chosen(index) {
            Basis::new(pole, &stretch).add(gain * sign, behind);
        }
    }
    if force {
        behind.iter_mut().zip(&push).for_each(|(x, push)| *x += sign * blow.gains.force * push);
    }
}

fn subtract(left: &mut [f64], blow: &Struck, poles: &[Pole]) {
    add(left, blow, poles, -1.0, |_| true, true);
}

/// Share of each mode in the energy of a blow, as a mean over recordings; the last is the force's.
fn shares(recorded: &[Recorded], owned: &Owned) -> Vec<f64> {
    let mut sums = vec![(0.0, 0usize); owned.poles.len() + 1];
    for recording in recorded {
        let loudest = recording.struck.iter().max_by(|a, b| a.strength().total_cmp(&b.strength()));
        let Some(blow) = loudest.filter(|blow| blow.strength() > 0.0) else { continue };
        let all = blow.strength();
        for (index, &member) in recording.members.iter().enumerate() {
            sums[member].0 += blow.power(index) / all;
            sums[member].1 += 1;
        }
        if let Some(last) = sums.last_mut() {
            last.0 += blow.gains.force.powi(2) / all;
            last.1 += 1;
        }
    }
    sums.into_iter().map(|(sum, count)| (sum / count.max(1) as f64).max(LEAST_SHARE)).collect()
}

/// Gains anew, with the share that each mode has in all recordings as its expected variance.
fn with_expected(clip: &Clip<'_>, recorded: Recorded, shares: &[f64]) -> Option<Recorded> {
    let mut left = clip.samples.to_vec();
    let mut struck = Vec::with_capacity(recorded.struck.len());
    for blow in &recorded.struck {
        let scale = blow.strength() / blow.noise.max(f64::MIN_POSITIVE);
        // A gain has two numbers, each with half of the variance.
        let modes = recorded.members.iter().zip(&blow.response);
        let modes = modes.map(|(&member, response)| 0.5 * shares[member] * scale / response);
        let force = shares[shares.len() - 1] * scale;
        let expected: Expected = modes.chain([force]).map(|variance| variance.max(f64::MIN_POSITIVE)).collect();
        let anew = solved(&left, blow.contact, blow.end, &recorded.poles, Some(&expected))?;
        subtract(&mut left, &anew, &recorded.poles);
        struck.push(anew);
    }
    Some(Recorded { struck, ..recorded })
}

fn stems_of(clip: &Clip<'_>, recorded: &Recorded, owned: &Owned, object_part: usize) -> Stems {
    let mut object = vec![0.0; clip.samples.len()];
    let mut striker = object.clone();
    let is_objects = |index: usize| owned.part[recorded.members[index]] == object_part;
    for blow in &recorded.struck {
        add(&mut object, blow, &recorded.poles, 1.0, is_objects, false);
        add(&mut striker, blow, &recorded.poles, 1.0, |index| !is_objects(index), true);
    }
    let rest: Vec<f64> = clip.samples.iter().zip(&object).zip(&striker).map(|((x, a), b)| x - a - b).collect();
    let energy = |samples: &[f64]| samples.iter().map(|x| x * x).sum::<f64>().max(f64::MIN_POSITIVE);
    let left_db = 10.0 * (energy(&rest) / energy(clip.samples)).log10();
    let loudest = recorded.struck.iter().map(Struck::strength).fold(f64::MIN_POSITIVE, f64::max);
    let blows = recorded.struck.iter().map(|blow| Blow {
        at_s: blow.contact.start / clip.rate_hz,
        contact_time_s: blow.contact.time / clip.rate_hz,
        level_db: 10.0 * (blow.strength().max(1e-12 * loudest) / loudest).log10(),
    });
    Stems { object, striker, rest, left_db, blows: blows.collect() }
}

/// Modes of a part, with their gains in its loudest blow.
fn modes_of(part: usize, recorded: &[Recorded], owned: &Owned, rate_hz: f64) -> Vec<PartMode> {
    let own: Vec<usize> = (0..owned.poles.len()).filter(|&pole| owned.part[pole] == part).collect();
    // Blows of the part's recordings, each with the places of the part's poles among its own.
    let blows: Vec<(&Struck, Vec<usize>)> = recorded
        .iter()
        .filter_map(|recording| {
            let place = |pole: &usize| recording.members.iter().position(|member| member == pole);
            Some((recording, own.iter().map(place).collect::<Option<Vec<usize>>>()?))
        })
        .flat_map(|(recording, places)| recording.struck.iter().map(move |blow| (blow, places.clone())))
        .collect();
    let strength = |(blow, places): &(&Struck, Vec<usize>)| places.iter().map(|&at| blow.power(at)).sum::<f64>();
    let Some((loudest, places)) = blows.iter().max_by(|a, b| strength(a).total_cmp(&strength(b))) else {
        return Vec::new();
    };
    let energy = |index: usize| {
        blows.iter().map(|(blow, places)| blow.power(places[index])).sum::<f64>() / owned.poles[own[index]].decay
    };
    let energies: Vec<f64> = (0..own.len()).map(energy).collect();
    let most = energies.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    // A force with a peak of 1 instead of an impulse of 1.
    let impulse = 1.0 / loudest.contact.force().iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let modes = own.iter().zip(&energies).enumerate().map(|(index, (&pole, energy))| {
        let gain = loudest.gains.modes[places[index]] * (rate_hz / impulse);
        PartMode {
            frequency_hz: owned.poles[pole].frequency_hz(rate_hz),
            decay_per_s: owned.poles[pole].decay_per_s(rate_hz),
            gain: [-gain.im, gain.re],
            level_db: 10.0 * (energy.max(1e-20 * most) / most).log10(),
        }
    });
    let mut modes: Vec<PartMode> = modes.collect();
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    modes
}
