//! The one time by which all contacts of a starting model are early or late.
//!
//! The ringing behind the strikes says nothing about it: contacts that come later by D, with gains
//! turned by `e^{sD}`, ring alike. Only the samples within the contacts tell.

use std::ops::Range;

use rayon::prelude::*;

use super::contact::{Contact, strength};
use super::equations::residual_within;
use super::model::Model;
use crate::modes::add_ringing;

/// Reach of the search in seconds.
const REACH_S: f64 = 4e-3;
/// First step of the search in samples; it is halved down to the last.
const STEPS: [f64; 2] = [2.5, 0.04];
/// Number of strikes whose contacts are looked at, the strongest.
const MOST_STRIKES: usize = 3;
/// Margin of the samples about a contact, in samples.
const MARGIN: f64 = 8.0;

/// The strongest attacks of a recording, to try common times with.
struct Attacks<'a> {
    model: &'a Model,
    attacks: Vec<Attack>,
}

/// Window of a recording about a contact.
///
/// Behind the contact a strike rings alike at all common times. So energies are summed once, and
/// each time tried costs the samples within the contact only.
struct Attack {
    strike: usize,
    /// First sample of the window in the recording.
    from: usize,
    /// Sound without the other strikes.
    heard: Vec<f64>,
    /// Energy of the samples before each one, as if nothing were struck until then.
    before: Vec<f64>,
    /// Energy from each sample on of what the ringing leaves.
    behind: Vec<f64>,
}

impl Attack {
    /// Window of a strike; `heard` is its sound.
    fn new(model: &Model, index: usize, from: usize, heard: Vec<f64>) -> Self {
        let strike = model.strikes[index];
        let mut left = heard.clone();
        for mode in (0..model.poles.len()).filter(|mode| model.rings(*mode, &strike)) {
            let exponent = model.exponent(mode);
            let since = from as f64 - strike.contact.middle;
            let start = strength(exponent, strike.contact.time).value * (exponent * since).exp();
            add_ringing(model.poles[mode], -start * model.gain(mode, strike.position) * strike.contact.peak, &mut left);
        }
        let before = running_energy(heard.iter());
        let mut behind = running_energy(left.iter().rev());
        behind.reverse();
        Self { strike: index, from, heard, before, behind }
    }

    /// Energy that is left of the window if the strike comes later by `shift` samples.
    fn misfit(&self, model: &Model, shift: f64) -> f64 {
        let strike = model.strikes[self.strike];
        let contact = Contact { middle: strike.contact.middle + shift, ..strike.contact };
        let index_of = |sample: f64| ((sample - self.from as f64).max(0.0) as usize).min(self.heard.len());
        let (begun, over) = (index_of(contact.first_sample()), index_of(contact.end_sample()));
        let mut during = self.heard[begun..over].to_vec();
        for mode in (0..model.poles.len()).filter(|mode| model.rings(*mode, &strike)) {
            let exponent = model.exponent(mode);
            let gain = -model.gain(mode, strike.position) * (exponent * shift).exp() * contact.peak;
            contact.add_motion(exponent, gain, self.from + begun, &mut during);
        }
        self.before[begun] + during.iter().map(|x| x * x).sum::<f64>() + self.behind[over]
    }
}

/// Energy of the samples before each one, and of all.
fn running_energy<'a>(samples: impl Iterator<Item = &'a f64>) -> Vec<f64> {
    let mut sum = 0.0;
    let energies = samples.map(|x| {
        sum += x * x;
        sum
    });
    [0.0].into_iter().chain(energies).collect()
}

impl<'a> Attacks<'a> {
    /// Attacks in a recording of `length` samples; `left` gives what the model leaves of ranges.
    fn new(model: &'a Model, length: usize, reach: f64, left: impl FnOnce(&[Range<usize>]) -> Vec<Vec<f64>>) -> Self {
        let mut order: Vec<usize> = (0..model.strikes.len()).collect();
        order.sort_by(|a, b| model.strikes[*b].contact.peak.total_cmp(&model.strikes[*a].contact.peak));
        order.truncate(MOST_STRIKES);
        let range = |index: &usize| {
            let contact = model.strikes[*index].contact;
            let to = ((contact.end_sample() + reach + MARGIN).max(0.0) as usize).min(length);
            ((contact.first_sample() - reach - MARGIN).max(0.0) as usize).min(to)..to
        };
        let ranges: Vec<Range<usize>> = order.iter().map(range).collect();
        let with_strike = |((index, range), mut heard): ((usize, &Range<usize>), Vec<f64>)| {
            add_strike(model, index, range.start, &mut heard);
            Attack::new(model, index, range.start, heard)
        };
        Self { model, attacks: order.into_iter().zip(&ranges).zip(left(&ranges)).map(with_strike).collect() }
    }

    /// Energy that is left if all contacts come later by `shift` samples.
    fn misfit(&self, shift: f64) -> f64 {
        self.attacks.iter().map(|attack| attack.misfit(self.model, shift)).sum()
    }
}

/// The model with all contacts at the time that leaves least in the strongest attacks, and what it
/// leaves there.
pub(crate) fn aligned(model: &Model, samples: &[f64], rate_hz: f64) -> (f64, Model) {
    let reach = REACH_S * rate_hz;
    let attacks = Attacks::new(model, samples.len(), reach, |ranges| residual_within(model, samples, ranges));
    let steps = (reach / STEPS[0]) as i32;
    let (mut best, mut least) = (0.0, f64::INFINITY);
    let mut consider = |shift: f64, best: &mut f64| {
        let here = attacks.misfit(shift);
        if here < least {
            (*best, least) = (shift, here);
        }
    };
    (-steps..=steps).for_each(|step| consider(f64::from(step) * STEPS[0], &mut best));
    let mut step = 0.5 * STEPS[0];
    while step > STEPS[1] {
        let middle = best;
        [middle - step, middle + step].into_iter().for_each(|shift| consider(shift, &mut best));
        step *= 0.5;
    }
    (least, shifted(model, best))
}

/// Models with all contacts at other times that leave at most twice as much, the least first.
///
/// Contacts later by a small D leave `D F(t) Σ Re g + D²/2 F(t) Σ Re(s g) + ..`, which vanishes at
/// a second D near the first. A descent ends at either.
pub(crate) fn alternatives(model: &Model, left: &[f64]) -> Vec<Model> {
    let mut least: Vec<(f64, f64)> = Vec::new();
    for (reach, step) in [NEAR, FAR] {
        let within = |ranges: &[Range<usize>]| ranges.iter().map(|range| left[range.clone()].to_vec()).collect();
        let attacks = Attacks::new(model, left.len(), reach, within);
        let count = (reach / step) as i32;
        let misfits: Vec<(f64, f64)> = (-count..=count)
            .into_par_iter()
            .map(|index| (attacks.misfit(f64::from(index) * step), f64::from(index) * step))
            .collect();
        // A window as long as the far search has more of the noise in it.
        let base = attacks.misfit(0.0);
        let is_least = |three: &&[(f64, f64)]| three[1].0 < three[0].0 && three[1].0 <= three[2].0;
        let minima = misfits.windows(3).filter(is_least).map(|three| (three[1].0 - base, three[1].1));
        least.extend(minima.filter(|(excess, shift)| shift.abs() > step && *excess < base));
    }
    least.sort_by(|a, b| a.0.total_cmp(&b.0));
    least.into_iter().take(MOST_ALTERNATIVES).map(|(_, shift)| shifted(model, shift)).collect()
}

/// Reach and step in samples of the search for other times near a fitted one.
const NEAR: (f64, f64) = (4.0, 0.1);
/// Reach and step in samples of the search far from a fitted one.
const FAR: (f64, f64) = (60.0, 0.7);
/// Maximum number of other times.
const MOST_ALTERNATIVES: usize = 3;

fn shifted(model: &Model, shift: f64) -> Model {
    let mut shifted = model.clone();
    shifted.strikes.iter_mut().for_each(|strike| strike.contact.middle += shift);
    for (mode, gains) in shifted.gains.iter_mut().enumerate() {
        let turn = (model.exponent(mode) * shift).exp();
        gains.iter_mut().for_each(|gain| *gain *= turn);
    }
    shifted
}

/// Adds a strike to samples from `from` on.
fn add_strike(model: &Model, index: usize, from: usize, samples: &mut [f64]) {
    let strike = model.strikes[index];
    for mode in (0..model.poles.len()).filter(|mode| model.rings(*mode, &strike)) {
        let gain = model.gain(mode, strike.position) * strike.contact.peak;
        strike.contact.add_motion(model.exponent(mode), gain, from, samples);
    }
}
