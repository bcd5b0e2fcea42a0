//! The sounding pad: its input is force, its output the sound of eq. 1.

use super::biquads::Biquads;
use super::dynamic_filter::DynamicFilterVoice;
use super::hand::{BlockHand, Hand};
use super::object::Pad;
use crate::contact::Impact;
use crate::error::BankOwner;
use crate::event::{Action, Event, TICK_SAMPLES};
use crate::radiation::{Acceleration, add_acceleration_sound};
use crate::rate::SampleRate;
use crate::resonator::{Bank, GainsError};

/// Pad in motion: its banks, its filters and the contacts in flight.
pub(crate) struct Voice<'a> {
    pad: &'a Pad,
    rate: SampleRate,
    object: Bank<'a>,
    /// Position of the latest strike, at which a direct force acts.
    position: f64,
    strikers: Vec<StrikerVoice<'a>>,
    biquads: Biquads<'a>,
    dynamic_filter: Option<DynamicFilterVoice<'a>>,
    /// Hand on the biquads and the dynamic filter; each bank damps its own modes.
    hand: Hand,
    /// Hand on the object's modes if they are in frames.
    block_hand: BlockHand,
}

/// Striker in motion.
struct StrikerVoice<'a> {
    /// Contacts that have begun and are not over, each with its position.
    impacts: Vec<(Impact, f64)>,
    bank: Bank<'a>,
}

impl<'a> Voice<'a> {
    /// Pad at rest.
    ///
    /// # Errors
    /// A bank has uneven gains.
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
            dynamic_filter: pad.object.dynamic_filter.as_ref().map(|table| DynamicFilterVoice::new(table, rate)),
            hand: Hand::AWAY,
            block_hand: BlockHand::default(),
        })
    }

    /// Applies `event` before the next sample, which is the first one that it affects.
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
                self.banks_under_hand().for_each(|bank| bank.choke(t60_s));
                self.block_hand.lay(true);
                self.hand.choke(t60_s, self.rate);
            }
            Action::Release => {
                self.banks_under_hand().for_each(Bank::release);
                self.block_hand.lay(false);
                self.hand.release();
            }
        }
    }

    /// Adds the pad's sound from `first_sample` on to `sound`.
    ///
    /// The contacts in flight drive it, and so does `direct`, a force in newtons as long as
    /// `sound`.
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
        if self.dynamic_filter.as_ref().is_some_and(DynamicFilterVoice::takes_modes) {
            let mut modes = vec![0.0; sound.len()];
            self.object.add_sound_at(&at_positions, &mut modes);
            self.add_filtered(first_sample, &force, Some(&modes), sound);
        } else {
            self.add_object(&at_positions, sound);
            self.add_filtered(first_sample, &force, None, sound);
        }
        if let Acceleration::Factor(alpha) = self.pad.object.acceleration {
            add_acceleration_sound(alpha, &force, sound);
        }
    }

    /// Adds the sound of the object's modes under forces at their positions.
    fn add_object(&mut self, forces: &[(f64, &[f64])], sound: &mut [f64]) {
        let hand = self.block_hand.shares(self.pad.choke_t60_s, self.rate).filter(|_| self.pad.is_in_frames);
        let Some(hand) = hand else { return self.object.add_sound_at(forces, sound) };
        let shares: Vec<f64> = hand.take(sound.len() + 1).collect();
        // The hand is one factor on all that sounds, so a force is as much larger.
        let raised: Vec<(f64, Vec<f64>)> = forces
            .iter()
            .map(|(position, force)| (*position, force.iter().zip(&shares).map(|(x, share)| x / share).collect()))
            .collect();
        let raised: Vec<_> = raised.iter().map(|(position, force)| (*position, force.as_slice())).collect();
        let mut free = vec![0.0; sound.len()];
        self.object.add_sound_at(&raised, &mut free);
        for ((sound, free), share) in sound.iter_mut().zip(free).zip(&shares) {
            *sound += free * share;
        }
        self.object.attenuate(shares[sound.len()]);
    }

    /// Begins a block of [`BLOCK_SAMPLES`](super::hand::BLOCK_SAMPLES).
    pub(crate) fn begin_block(&mut self) {
        self.block_hand.begin_block();
    }

    /// Adds the sound of biquads and dynamic filter under the hand. `modes` feed the dynamic
    /// filter.
    fn add_filtered(&mut self, first_sample: u64, force: &[f64], modes: Option<&[f64]>, sound: &mut [f64]) {
        for (index, (sample, sound)) in (first_sample..).zip(sound).enumerate() {
            let modes = modes.map_or(0.0, |modes| modes[index]);
            let dynamic = self.dynamic_filter.as_mut().map_or(0.0, |filter| filter.step(modes));
            *sound += self.biquads.step(force[index]) + dynamic;
            if self.hand.is_here() {
                self.damp();
            }
            if (sample + 1).is_multiple_of(TICK_SAMPLES) && self.hand.has_muted() {
                self.dynamic_filter.iter_mut().for_each(DynamicFilterVoice::mute);
            }
        }
    }

    /// Damps the filters after a sample under the hand.
    fn damp(&mut self) {
        self.biquads.damp(&self.hand);
        if let Some(filter) = &mut self.dynamic_filter {
            let kept = self.hand.take(filter.own_decay());
            filter.attenuate(kept);
        }
    }

    /// Carries a choke or release on to further modes; called at each tick.
    pub(crate) fn reach(&mut self) {
        self.banks().filter(|bank| bank.is_being_reached()).for_each(Bank::reach);
    }

    /// True while a choke or release has modes left to reach.
    pub(crate) fn is_being_reached(&self) -> bool {
        self.object.is_being_reached() || self.strikers.iter().any(|striker| striker.bank.is_being_reached())
    }

    /// Banks in which a hand moves poles.
    fn banks_under_hand(&mut self) -> impl Iterator<Item = &mut Bank<'a>> {
        let without_object = usize::from(self.pad.is_in_frames);
        self.banks().skip(without_object)
    }

    fn banks(&mut self) -> impl Iterator<Item = &mut Bank<'a>> {
        let of_strikers = self.strikers.iter_mut().map(|striker| &mut striker.bank);
        std::iter::once(&mut self.object).chain(of_strikers)
    }
}

/// Force at a position; a force of 0 is added to the list if it has none there yet.
fn at_position(forces: &mut Vec<(f64, Vec<f64>)>, position: f64, length: usize) -> &mut [f64] {
    let index = forces.iter().position(|(other, _)| *other == position).unwrap_or_else(|| {
        forces.push((position, vec![0.0; length]));
        forces.len() - 1
    });
    &mut forces[index].1
}

/// Adds `terms` to `sum`, sample by sample.
fn add(terms: &[f64], sum: &mut [f64]) {
    for (term, sum) in terms.iter().zip(sum) {
        *sum += term;
    }
}
