//! The pad sounding: forces in, eq. 1 out.

use crate::contact::Impact;
use crate::error::BankOwner;
use crate::event::{Action, Event, TICK_SAMPLES};
use crate::pad::Pad;
use crate::pad::biquads::Biquads;
use crate::pad::dynamic_filter::Sounding;
use crate::pad::hand::Hand;
use crate::radiation::{Acceleration, add_acceleration_sound};
use crate::rate::SampleRate;
use crate::resonator::{Bank, GainsError};

/// Everything of a pad that moves: its banks and the contacts in flight.
pub(crate) struct Voice<'a> {
    pad: &'a Pad,
    rate: SampleRate,
    object: Bank<'a>,
    /// That of the latest strike: where a direct force acts.
    position: f64,
    strikers: Vec<StrikerVoice<'a>>,
    biquads: Biquads<'a>,
    dynamic_filter: Option<Sounding<'a>>,
    /// On the biquads and the dynamic filter; a bank damps its modes by itself.
    hand: Hand,
}

/// Everything of a striker that moves.
struct StrikerVoice<'a> {
    /// Its contacts that have begun and are not over, each with its position.
    impacts: Vec<(Impact, f64)>,
    bank: Bank<'a>,
}

impl<'a> Voice<'a> {
    /// A pad at rest; refused if a bank has uneven gains.
    pub(crate) fn new(pad: &'a Pad, rate: SampleRate) -> Result<Self, (BankOwner, GainsError)> {
        let bank = match pad.object.acceleration {
            Acceleration::Factor(_) => Bank::new,
            Acceleration::Balance => Bank::balanced,
        };
        let object = bank(&pad.object.modes, rate).map_err(|error| (BankOwner::Object, error))?;
        let strikers = pad.strikers.iter().enumerate().map(|(index, striker)| {
            Ok(StrikerVoice {
                impacts: Vec::new(),
                bank: bank(&striker.modes, rate).map_err(|error| (BankOwner::Striker(index), error))?,
            })
        });
        Ok(Self {
            pad,
            rate,
            object,
            position: 0.0,
            strikers: strikers.collect::<Result<_, _>>()?,
            biquads: Biquads::new(&pad.object.biquads),
            dynamic_filter: pad.object.dynamic_filter.as_ref().map(|table| Sounding::new(table, rate)),
            hand: Hand::AWAY,
        })
    }

    /// Lets `event` happen before the next sample, which is to be its first.
    pub(crate) fn play(&mut self, event: &Event) {
        match event.action {
            Action::Strike => {
                let striker = &self.pad.strikers[event.striker];
                if let Some(impact) = striker.strike(event.velocity, event.time_samples) {
                    self.hand.begin();
                    if let Some(filter) = &mut self.dynamic_filter {
                        filter.strike(impact.peak_force);
                    }
                    self.strikers[event.striker].impacts.push((impact, event.position));
                    self.position = event.position;
                }
            }
            Action::Choke => {
                let t60_s = self.pad.choke_t60_s;
                self.banks().for_each(|bank| bank.choke(t60_s));
                self.hand.choke(t60_s, self.rate);
            }
            Action::Release => {
                self.banks().for_each(Bank::release);
                self.hand.release();
            }
        }
    }

    /// Adds the pad's sound from `first_sample` on to `sound`, under the contacts in flight and the
    /// `direct` force (newtons, as long as `sound`).
    pub(crate) fn add_sound(&mut self, first_sample: u64, direct: &[f64], sound: &mut [f64]) {
        let mut force = direct.to_vec(); // F of eq. 3, once every striker has added its part
        let mut at_positions = vec![(self.position, direct.to_vec())];
        for (index, striker) in self.strikers.iter_mut().enumerate() {
            let mut striker_force = vec![0.0; sound.len()]; // F_s
            striker.impacts.retain(|(impact, _)| !impact.is_over(first_sample, self.rate));
            for (impact, position) in &striker.impacts {
                impact.add_force(first_sample, self.rate, &mut striker_force);
                impact.add_force(first_sample, self.rate, at_position(&mut at_positions, *position, sound.len()));
            }
            add(&striker_force, &mut force);

            if !striker.bank.is_empty() {
                if index == 0 {
                    add(direct, &mut striker_force);
                }
                let mut striker_sound = vec![0.0; sound.len()];
                striker.bank.add_sound(&striker_force, &mut striker_sound);
                for (from_striker, y) in striker_sound.iter().zip(&mut *sound) {
                    *y += self.pad.striker_weight * from_striker;
                }
            }
        }
        let at_positions: Vec<_> = at_positions.iter().map(|(position, force)| (*position, force.as_slice())).collect();
        if self.dynamic_filter.as_ref().is_some_and(Sounding::takes_modes) {
            let mut modes = vec![0.0; sound.len()];
            self.object.add_sound_at(&at_positions, &mut modes);
            self.add_filtered(first_sample, &force, Some(&modes), sound);
        } else {
            self.object.add_sound_at(&at_positions, sound);
            self.add_filtered(first_sample, &force, None, sound);
        }
        if let Acceleration::Factor(alpha) = self.pad.object.acceleration {
            add_acceleration_sound(alpha, &force, sound);
        }
    }

    /// Adds biquads and dynamic filter under the hand; `modes` go into the filter.
    fn add_filtered(&mut self, first_sample: u64, force: &[f64], modes: Option<&[f64]>, sound: &mut [f64]) {
        for (index, (sample, sound)) in (first_sample..).zip(sound).enumerate() {
            let modes = modes.map_or(0.0, |modes| modes[index]);
            let dynamic = self.dynamic_filter.as_mut().map_or(0.0, |filter| filter.step(modes));
            *sound += self.biquads.step(force[index]) + dynamic;
            if self.hand.is_here() {
                self.damp();
            }
            if (sample + 1).is_multiple_of(TICK_SAMPLES) && self.hand.has_muted() {
                self.dynamic_filter.iter_mut().for_each(Sounding::rest);
            }
        }
    }

    /// What the hand takes after a sample.
    fn damp(&mut self) {
        self.biquads.damp(&self.hand);
        if let Some(filter) = &mut self.dynamic_filter {
            let kept = self.hand.take(filter.own_decay());
            filter.attenuate(kept);
        }
    }

    /// At a tick: a hand that comes or goes reaches further modes.
    pub(crate) fn reach(&mut self) {
        self.banks().filter(|bank| bank.is_being_reached()).for_each(Bank::reach);
    }

    /// Whether a hand that comes or goes has modes left to reach.
    pub(crate) fn is_being_reached(&self) -> bool {
        self.object.is_being_reached() || self.strikers.iter().any(|striker| striker.bank.is_being_reached())
    }

    fn banks(&mut self) -> impl Iterator<Item = &mut Bank<'a>> {
        let of_strikers = self.strikers.iter_mut().map(|striker| &mut striker.bank);
        std::iter::once(&mut self.object).chain(of_strikers)
    }
}

/// The force at a position, 0 where there is none yet.
fn at_position(forces: &mut Vec<(f64, Vec<f64>)>, position: f64, length: usize) -> &mut [f64] {
    let index = forces.iter().position(|(other, _)| *other == position).unwrap_or_else(|| {
        forces.push((position, vec![0.0; length]));
        forces.len() - 1
    });
    &mut forces[index].1
}

/// `sum += terms`.
fn add(terms: &[f64], sum: &mut [f64]) {
    for (term, sum) in terms.iter().zip(sum) {
        *sum += term;
    }
}
