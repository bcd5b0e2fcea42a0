//! The pad sounding: forces in, eq. 1 out.

use crate::contact::Impact;
use crate::error::BankOwner;
use crate::event::{Action, Event};
use crate::pad::Pad;
use crate::pad::biquads::Biquads;
use crate::pad::dynamic_filter::Sounding;
use crate::pad::hand::Hand;
use crate::radiation::{Acceleration, add_acceleration_sound};
use crate::rate::SampleRate;
use crate::resonator::{Bank, GainsError};

/// A hand's end is looked for so often: the instrument draws no more noise from there on.
const TICK_SAMPLES: u64 = 32;

/// Everything of a pad that moves: its banks and the contacts in flight.
pub(crate) struct Voice<'a> {
    pad: &'a Pad,
    rate: SampleRate,
    object: Bank<'a>,
    strikers: Vec<StrikerVoice<'a>>,
    biquads: Biquads<'a>,
    dynamic_filter: Option<Sounding<'a>>,
    /// On both of them; a bank damps its modes by itself.
    hand: Hand,
}

/// Everything of a striker that moves.
struct StrikerVoice<'a> {
    /// Its contacts that have begun and are not over.
    impacts: Vec<Impact>,
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
                    self.lift();
                    if let Some(filter) = &mut self.dynamic_filter {
                        filter.strike(impact.peak_force);
                    }
                    self.strikers[event.striker].impacts.push(impact);
                    self.object.set_position(event.position);
                }
            }
            Action::Choke => {
                let t60_s = self.pad.choke_t60_s;
                self.banks().for_each(|bank| bank.choke(t60_s));
                self.hand.choke(t60_s, self.rate);
            }
            Action::Release => {
                self.banks().for_each(Bank::release);
                self.lift();
                self.hand.release();
            }
        }
    }

    /// Adds the pad's sound from `first_sample` on to `sound`, under the contacts in flight and the
    /// `direct` force (newtons, as long as `sound`).
    pub(crate) fn add_sound(&mut self, first_sample: u64, direct: &[f64], sound: &mut [f64]) {
        let mut force = direct.to_vec(); // F of eq. 3, once every striker has added its part
        for (index, striker) in self.strikers.iter_mut().enumerate() {
            let mut striker_force = vec![0.0; sound.len()]; // F_s
            striker.impacts.retain(|impact| !impact.is_over(first_sample, self.rate));
            for impact in &striker.impacts {
                impact.add_force(first_sample, self.rate, &mut striker_force);
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
        if self.dynamic_filter.as_ref().is_some_and(Sounding::takes_modes) {
            let mut modes = vec![0.0; sound.len()];
            self.object.add_sound(&force, &mut modes);
            self.add_filtered(first_sample, &force, Some(&modes), sound);
        } else {
            self.object.add_sound(&force, sound);
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
            *sound += self.hand.fade(self.biquads.step(force[index]) + dynamic);
            if (sample + 1).is_multiple_of(TICK_SAMPLES) && self.hand.is_mute() {
                self.biquads.attenuate(0.0);
                self.dynamic_filter.iter_mut().for_each(Sounding::rest);
            }
        }
    }

    /// What rings is what the hand has left of it, and the hand begins anew.
    fn lift(&mut self) {
        let left = self.hand.lift();
        self.biquads.attenuate(left);
        if let Some(filter) = &mut self.dynamic_filter {
            filter.attenuate(left);
        }
    }

    fn banks(&mut self) -> impl Iterator<Item = &mut Bank<'a>> {
        let of_strikers = self.strikers.iter_mut().map(|striker| &mut striker.bank);
        std::iter::once(&mut self.object).chain(of_strikers)
    }
}

/// `sum += terms`.
fn add(terms: &[f64], sum: &mut [f64]) {
    for (term, sum) in terms.iter().zip(sum) {
        *sum += term;
    }
}
