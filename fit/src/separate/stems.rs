//! Stems: the sound of each part of a recording, through the contacts of its blows.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Complex;
use rayon::prelude::*;

use super::common::{Owned, passes};
use super::contact::{Contact, Expected, find, gains};
use super::parts::Parts;
use super::{Blow, Clip, PartMode, STEPS, Separation, Stems};
use crate::modes::{Basis, Gains, Pole, Stretch};

/// Contact and gains of one blow.
#[derive(Clone, Debug)]
struct Struck {
    contact: Contact,
    /// Sample before which the next blow begins.
    end: usize,
    gains: Gains,
    /// Mean square of what is left behind the blow.
    noise: f64,
}

impl Struck {
    /// Energy of all modes' amplitudes.
    fn strength(&self) -> f64 {
        self.gains.modes.iter().map(|gain| gain.norm_sqr()).sum()
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
    let stems = stems.map(|(index, (recorded, clip))| stems_of(clip, recorded, owned, parts.of_clip[index][0])).collect();
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
        let end = blows.get(index + 1).map_or(left.len(), |next| next.saturating_sub(lead)).max(blow + 8).min(left.len());
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
    Some(Struck { contact, end, gains, noise: energy.max(0.0) / (end - first) as f64 })
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
        for (&member, gain) in recording.members.iter().zip(&blow.gains.modes) {
            sums[member].0 += gain.norm_sqr() / all;
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
        let members = recorded.members.iter().copied().chain([shares.len() - 1]);
        // A gain has two numbers, each with half of the variance.
        let expected: Expected = members.map(|member| (0.5 * shares[member] * scale).max(f64::MIN_POSITIVE)).collect();
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
    let gain_in = |blow: &Struck, recording: &Recorded, pole: usize| {
        let at = recording.members.iter().position(|member| *member == pole);
        at.map_or(Complex::new(0.0, 0.0), |at| blow.gains.modes[at])
    };
    let own: Vec<usize> = (0..owned.poles.len()).filter(|&pole| owned.part[pole] == part).collect();
    let strength = |recording: &Recorded, blow: &Struck| {
        own.iter().map(|&pole| gain_in(blow, recording, pole).norm_sqr()).sum::<f64>()
    };
    let blows: Vec<(&Recorded, &Struck, f64)> = recorded
        .iter()
        .flat_map(|recording| recording.struck.iter().map(move |blow| (recording, blow)))
        .map(|(recording, blow)| (recording, blow, strength(recording, blow)))
        .collect();
    let Some(loudest) = blows.iter().max_by(|a, b| a.2.total_cmp(&b.2)) else { return Vec::new() };
    let energies: Vec<f64> = own
        .iter()
        .map(|&pole| {
            let sum: f64 = blows.iter().map(|(recording, blow, _)| gain_in(blow, recording, pole).norm_sqr()).sum();
            sum / owned.poles[pole].decay
        })
        .collect();
    let most = energies.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let modes = own.iter().zip(&energies).map(|(&pole, energy)| {
        let gain = gain_in(loudest.1, loudest.0, pole);
        PartMode {
            frequency_hz: owned.poles[pole].frequency_hz(rate_hz),
            decay_per_s: owned.poles[pole].decay_per_s(rate_hz),
            gain: [gain.re, gain.im],
            level_db: 10.0 * (energy.max(1e-20 * most) / most).log10(),
        }
    });
    let mut modes: Vec<PartMode> = modes.collect();
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    modes
}
