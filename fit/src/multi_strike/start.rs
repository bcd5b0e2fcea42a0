//! First estimate of all contacts, from the changes of the modes' amplitudes.
//!
//! A strike changes the amplitude of mode k by `a_k = m g_k Q(s_k, τ) e^{-s_k δ}`, δ from a moment
//! near the strike to the middle of its contact. For a trial contact time of the strongest strike
//! its amplitudes give the gains. Then each strike is looked up on a grid over τ and δ, and gains
//! and contacts are improved in turn.

use nalgebra::Complex;
use rayon::prelude::*;

use super::amplitudes::{Change, OWN_ERROR, Told, White, changes_of, spreads};
use super::contact::{Contact, strength};
use super::contact_grid::{Grid, Shapes, contact_times, exponents_of, fit_gains};
use super::free::{Guard, amplitudes, stretches};
use super::model::{Model, Strike};
use crate::modes::Pole;

type C64 = Complex<f64>;

/// Ratio of neighbouring contact times. A mode of 5 kHz is not rung by contacts of 0.9 or 1.1 ms,
/// but by those of 1 ms: coarser steps miss the right time.
const FINER: f64 = 1.0193;
/// Number of looks at the grid, the later ones with the gains of all strikes.
const LOOKS: usize = 2;
/// Least median over strikes of a mode's energy over the noise in an amplitude.
const STEADY: f64 = 6.0;
/// Least number of modes that contacts are started from.
const LEAST_MODES: usize = 4;

/// Extent of the search for starting models.
#[derive(Clone, Copy)]
pub(super) struct StartSearch {
    /// Number of contact times of the strongest strike at which all strikes are looked up.
    tried: usize,
    /// Number of contact times on either side of each to which the strikes are followed.
    followed: i32,
    /// Maximum number of starts that are aligned, beginning with the one that explains most of the
    /// ringing.
    pub(super) aligned: usize,
    /// True if a right start leaves only noise, within the contacts too.
    pub(super) leaves_noise: bool,
}

impl StartSearch {
    /// Search in a sound without a room.
    pub(super) const DRY: Self = Self { tried: 40, followed: 2, aligned: usize::MAX, leaves_noise: true };
    /// Search in a sound with a room, whose reflections no start explains. Of more starts some
    /// wrong ones leave less: the sets *room* lose strikes.
    pub(super) const IN_ROOM: Self = Self { tried: 20, followed: 0, aligned: 14, leaves_noise: false };
}

/// Starting models of the strikes near `onsets`, the best first: one for each contact time tried.
///
/// The first gains come from one strike: the strongest, or at attempt n the one that n others
/// exceed.
/// Strikes too close to their neighbours for an amplitude of their own are left out.
pub(crate) fn starts(
    white: &White<'_>,
    onsets: &[usize],
    poles: &[Pole],
    rate_hz: f64,
    (attempt, search): (usize, StartSearch),
) -> Vec<Model> {
    // The second start differs in kind.
    let told = if attempt == 1 { Told::Alone } else { Told::Together };
    let poles = &steady(&changes_of(white, onsets, poles, rate_hz, told), poles);
    let changes = changes_of(white, onsets, poles, rate_hz, told);
    let strength_of = |change: &Change| {
        change.amplitudes.iter().zip(&change.variances).map(|(a, v)| (1.0 + a.norm_sqr() / v).ln()).sum::<f64>()
    };
    let strengths: Vec<f64> = changes.iter().map(strength_of).collect();
    let Some(first) = strongest_but(&strengths, attempt) else { return Vec::new() };
    let looked_at = Grid::new(exponents_of(poles), rate_hz);
    let mut found: Vec<(f64, Model)> = contact_times(search.tried, rate_hz)
        .into_par_iter()
        .flat_map_iter(|time| from_trial(&changes, (first, time), poles, &looked_at, search.followed))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, model)| model).collect()
}

/// Index of the value that `others` values exceed.
pub(super) fn strongest_but(values: &[f64], others: usize) -> Option<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*b].total_cmp(&values[*a]));
    order.get(others).copied()
}

/// Modes that most strikes ring; modes of one stretch alone are errors of that stretch.
fn steady(changes: &[Change], poles: &[Pole]) -> Vec<Pole> {
    let significance = |mode: usize| {
        let mut all: Vec<f64> =
            changes.iter().map(|change| change.amplitudes[mode].norm_sqr() / change.variances[mode]).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let mut modes: Vec<(f64, Pole)> =
        poles.iter().enumerate().map(|(mode, pole)| (significance(mode), *pole)).collect();
    modes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let count = modes.iter().take_while(|(significance, _)| *significance > STEADY).count();
    modes.truncate(count.max(LEAST_MODES));
    let mut steady: Vec<Pole> = modes.into_iter().map(|(_, pole)| pole).collect();
    steady.sort_by(|a, b| a.angular.total_cmp(&b.angular));
    steady
}

/// Strike that a model lacks, near a sample, from what the model leaves.
///
/// `None` if the next strike follows too soon for the modes to be heard.
pub(crate) fn missing(model: &Model, residual: &[f64], at: usize, rate_hz: f64, variance: f64) -> Option<Strike> {
    let next = model.strikes.iter().map(|strike| strike.contact.first_sample().max(0.0) as usize);
    let next = next.filter(|start| *start > at).min().unwrap_or(residual.len());
    let found = sought(model, residual.get(at..next)?, rate_hz, variance)?;
    Some(found.later_by(at as f64))
}

/// Strike that rings a model's modes as `heard` has it, from a moment near it until the next one.
///
/// Its middle counts from that moment. `None` if the next strike follows too soon for the modes to
/// be heard.
pub(crate) fn sought(model: &Model, heard: &[f64], rate_hz: f64, variance: f64) -> Option<Strike> {
    let stretches = stretches(&[0, heard.len()], Guard::OF_CHANGE, heard.len(), rate_hz);
    let own = amplitudes(heard, &stretches[..1], &model.poles).pop().filter(|own| !own.is_empty())?;
    let back = -(stretches[0].start as f64);
    let (mut sums, mut variances) = (Vec::new(), Vec::new());
    for ((amplitude, pole), spread) in
        own.iter().zip(&model.poles).zip(spreads(&model.poles, stretches[0].len(), Told::Alone))
    {
        let back = pole.power(back);
        sums.push(amplitude * back);
        let noise = variance * spread * back.norm_sqr();
        variances.push(noise + (OWN_ERROR * amplitude.norm() * back.norm()).powi(2));
    }
    let change = Change { at: 0, amplitudes: sums, variances };
    let looked_at = Grid::new(exponents_of(&model.poles), rate_hz);
    let silent = vec![0.0; model.poles.len()];
    let count = if model.places() > 1 { PLACES } else { 1 };
    let strikers = model.strikes.iter().map(|strike| strike.striker).max().unwrap_or(0);
    let tried = (0..count).flat_map(|place| (0..=strikers).map(move |striker| (place, striker)));
    let gains = |strike: &Strike| -> Vec<C64> {
        let gain = |mode: usize| {
            if model.rings(mode, strike) { model.gain(mode, strike.position) } else { C64::new(0.0, 0.0) }
        };
        (0..model.poles.len()).map(gain).collect()
    };
    let of_place = |(place, striker): (usize, usize)| {
        let mut strike = Strike { contact: NOWHERE, position: place as f64 / (PLACES - 1) as f64, striker };
        let gains = gains(&strike);
        strike.contact = looked_at.best(&change, &gains, &silent);
        let (left, _) = looked_at.improve(&mut strike.contact, &change, &gains);
        (left, strike)
    };
    let found: Vec<(f64, Strike)> = tried.collect::<Vec<_>>().into_par_iter().map(of_place).collect();
    let (mut left, mut strike) = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let mut reach = if count > 1 { 0.5 / (PLACES - 1) as f64 } else { 0.0 };
    while reach > FINEST {
        for position in [strike.position - reach, strike.position + reach] {
            let mut next = Strike { position: position.clamp(0.0, 1.0), ..strike };
            let gains = gains(&next);
            let here = looked_at.improve(&mut next.contact, &change, &gains).0;
            if here < left {
                (left, strike) = (here, next);
            }
        }
        reach *= 0.5;
    }
    Some(strike)
}

/// Least step of the position of a strike that is sought.
const FINEST: f64 = 1e-3;
/// Number of positions at which a missing strike is tried.
const PLACES: usize = 13;
/// Contact of a strike that is not yet looked for.
const NOWHERE: Contact = Contact { middle: 0.0, time: 1.0, peak: 0.0 };

/// Models for contact times of the strike `first` near a trial one, with their misfits.
///
/// All strikes are looked up on the grid at the trial time, and followed from there to the others.
fn from_trial(
    changes: &[Change],
    (first, time): (usize, f64),
    poles: &[Pole],
    grid: &Grid,
    followed: i32,
) -> Vec<(f64, Model)> {
    let loud = &changes[first];
    let strengths: Vec<C64> = grid.exponents.iter().map(|s| strength(*s, time).value).collect();
    let mut gains: Vec<C64> = loud.amplitudes.iter().zip(&strengths).map(|(a, strength)| a / strength).collect();
    let mut spreads: Vec<f64> = loud.variances.iter().zip(&strengths).map(|(v, s)| v / s.norm_sqr()).collect();
    // δ of the first strike is 0: its gains hold the phases, which turn all δ by one amount.
    let (mut contacts, mut left) = (Vec::new(), f64::INFINITY);
    for _ in 0..LOOKS {
        contacts = changes.iter().map(|change| grid.best(change, &gains, &spreads)).collect::<Vec<Contact>>();
        left = grid.in_turn(&mut contacts, changes, &mut gains);
        // The next look has gains of all strikes.
        spreads.fill(0.0);
    }
    let mut found = vec![(left, model_of(changes, poles, &contacts, &gains))];
    for factor in [FINER, 1.0 / FINER] {
        let (mut contacts, mut gains) = (contacts.clone(), gains.clone());
        for step in 1..=followed {
            let all_longer = (time * factor.powi(step)).powi(2) - contacts[first].time.powi(2);
            contacts.iter_mut().for_each(|contact| grid.lengthen(contact, all_longer));
            let shapes: Vec<Shapes> = contacts.iter().map(|contact| grid.shapes(contact)).collect();
            fit_gains(&shapes, changes, &mut gains);
            let left = grid.in_turn(&mut contacts, changes, &mut gains);
            found.push((left, model_of(changes, poles, &contacts, &gains)));
        }
    }
    found
}

/// Model of modes and of the contacts of changes.
fn model_of(changes: &[Change], poles: &[Pole], contacts: &[Contact], gains: &[C64]) -> Model {
    let strikes = contacts.iter().zip(changes).map(|(contact, change)| Strike {
        contact: Contact { middle: change.at as f64 + contact.middle, ..*contact },
        position: 0.0,
        striker: 0,
    });
    let mut model = Model {
        poles: poles.to_vec(),
        gains: gains.iter().map(|gain| vec![*gain]).collect(),
        owners: vec![None; poles.len()],
        acceleration: 0.0,
        contact_times_are_held: false,
        shapes_are_real: false,
        strikes: strikes.collect(),
    };
    model.strikes.sort_by(|a, b| a.contact.middle.total_cmp(&b.contact.middle));
    model.normalise();
    model
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;
    use crate::multi_strike::truth::model_of;
    use crate::multi_strike::whitening::Whitening;

    #[test]
    fn modes_that_are_not_there_beside_true_ones_spoil_no_contacts() {
        let sound = plain(8, 6.0, 10, -60.0);
        let truth = model_of(&sound);
        let mut poles = truth.poles.clone();
        for pole in &truth.poles[..3] {
            poles.push(Pole { decay: 0.05 * pole.decay, angular: 1.004 * pole.angular });
        }
        let onsets: Vec<usize> = sound.strikes.iter().map(|strike| (strike.at_s * sound.rate_hz) as usize).collect();
        let whitening = Whitening::none();
        let white = White { samples: &sound.samples, whitening: &whitening, variance: sound.noise_rms.powi(2) };
        let error = |model: &Model| {
            let pairs = model.strikes.iter().zip(&truth.strikes);
            let mut apart: Vec<f64> = pairs.map(|(a, b)| (a.contact.time / b.contact.time).ln().abs()).collect();
            apart.sort_by(f64::total_cmp);
            apart[apart.len() / 2]
        };
        let found = starts(&white, &onsets, &poles, sound.rate_hz, (0, StartSearch::DRY));
        assert!(found.iter().all(|model| model.strikes.len() == 10));
        let least = found.iter().map(error).fold(f64::INFINITY, f64::min);
        assert!(least < 0.05, "contact times of the best start are wrong by {least}");
    }
}
