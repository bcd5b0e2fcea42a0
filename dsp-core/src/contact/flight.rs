//! The contacts that are under way.

use super::law::{Impact, WHOLE};
use super::pulse::{self, Pulse, SHAPE_BITS};
use crate::fixed;

/// One contact under way.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    pad: u8,
    striker: u8,
    /// Which of the pad's position slots it drives.
    slot: u8,
    pulse: Pulse,
    /// Peak force, Q4.27.
    peak: i32,
    /// Fraction of the pulse at the next frame, 1.0 = 2^63.
    phase: u64,
    /// Fraction of the pulse in one frame.
    step: u64,
}

impl Contact {
    const OVER: Self = Self { pad: 0, striker: 0, slot: 0, pulse: Pulse::HertzHalfSine, peak: 0, phase: 0, step: 0 };

    /// A contact whose pulse began `early` (a fraction of a sample, 1.0 = 2^32) before the next frame: onsets fall between samples.
    pub fn new(pad: u8, striker: u8, impact: Impact, early: u32) -> Self {
        // The step in halves, so that nothing overflows.
        let (upper, lower) = (impact.step >> 32, impact.step & 0xffff_ffff);
        let phase = upper * u64::from(early) + ((lower * u64::from(early)) >> 32);
        Self { pad, striker, slot: 0, pulse: impact.pulse, peak: impact.peak, phase, step: impact.step.clamp(1, WHOLE) }
    }

    /// The same contact at the position of one of the pad's slots.
    pub fn in_slot(self, slot: u8) -> Self {
        Self { slot, ..self }
    }

    fn is_over(&self) -> bool {
        self.phase >= WHOLE || self.step == 0
    }

    /// Adds the pulse to a run of force and moves on.
    fn add_to(&mut self, force: &mut [i32]) {
        match self.pulse {
            Pulse::HertzHalfSine => self.add_shape(force, pulse::half_sine),
            Pulse::Gaussian => self.add_shape(force, pulse::gaussian),
        }
    }

    #[inline(always)]
    fn add_shape(&mut self, force: &mut [i32], shape: impl Fn(u32) -> i32) {
        let (mut phase, step, peak) = (self.phase, self.step, i64::from(self.peak));
        for force in force {
            if phase >= WHOLE {
                break;
            }
            // Below 1.0 = 2^63: the upper 32 bits of the fraction.
            let value = (i64::from(shape((phase >> 31) as u32)) * peak) >> SHAPE_BITS;
            *force = fixed::qadd(*force, value as i32);
            // Steps are at most 1.0, so that this cannot wrap.
            phase += step;
        }
        self.phase = phase;
    }
}

/// All contacts of an engine, in the order in which they began; at most `CAPACITY` at a time.
#[derive(Debug)]
pub struct Flight<const CAPACITY: usize> {
    contacts: [Contact; CAPACITY],
    count: usize,
}

impl<const CAPACITY: usize> Flight<CAPACITY> {
    /// Nothing under way.
    pub const EMPTY: Self = Self { contacts: [Contact::OVER; CAPACITY], count: 0 };

    /// Contacts under way.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Contacts under way on a pad.
    pub fn count_on(&self, pad: u8) -> usize {
        self.under_way().iter().filter(|contact| contact.pad == pad).count()
    }

    /// Whether any contact under way on a pad drives a position slot.
    pub fn is_any_in(&self, pad: u8, slot: u8) -> bool {
        self.under_way().iter().any(|contact| contact.pad == pad && contact.slot == slot)
    }

    /// What the contacts on a pad may still bring: a bound of the sum of their force, bus steps, and the length in samples of the longest.
    pub fn ahead(&self, pad: u8) -> (f32, f32) {
        let contacts = self.under_way().iter().filter(|contact| contact.pad == pad);
        contacts.fold((0.0, 0.0), |(input, longest), contact| {
            // The upper words are as precise as the floats.
            let step = ((contact.step >> 32) as u32).max(1) as f32;
            let left = ((WHOLE.saturating_sub(contact.phase)) >> 32) as u32 as f32 / step + 1.0;
            let length = (WHOLE >> 32) as u32 as f32 / step;
            (input + contact.peak as f32 * left, if length > longest { length } else { longest })
        })
    }

    /// Frames times contacts of a pad within a run.
    pub fn frames_ahead(&self, pad: u8, frames: u32) -> u32 {
        let contacts = self.under_way().iter().filter(|contact| contact.pad == pad);
        let left = |contact: &Contact| {
            (WHOLE.saturating_sub(contact.phase) >> 32) as u32 / ((contact.step >> 32) as u32).max(1)
        };
        contacts.map(|contact| (left(contact) + 1).min(frames)).sum()
    }

    /// Moves a pad's contacts on without anybody hearing them.
    pub fn pass(&mut self, pad: u8, frames: usize) {
        for contact in self.contacts.iter_mut().take(self.count).filter(|contact| contact.pad == pad) {
            contact.phase = contact.phase.saturating_add(contact.step.saturating_mul(frames as u64));
        }
    }

    /// Adds a contact. When all places are taken it takes the place of the one nearest to its end, and says so.
    pub fn begin(&mut self, contact: Contact) -> bool {
        if let Some(place) = self.contacts.get_mut(self.count) {
            *place = contact;
            self.count += 1;
            return false;
        }
        let nearest_to_end = self.contacts.iter_mut().max_by_key(|contact| contact.phase);
        if let Some(place) = nearest_to_end {
            *place = contact;
        }
        true
    }

    /// Adds the force of the contacts of one of a pad's strikers in a position slot to a run, and moves these contacts on.
    pub fn add_force(&mut self, pad: u8, striker: u8, slot: u8, force: &mut [i32]) {
        let own = |contact: &&mut Contact| contact.pad == pad && contact.striker == striker && contact.slot == slot;
        self.contacts.iter_mut().take(self.count).filter(own).for_each(|contact| contact.add_to(force));
    }

    /// Forgets contacts that are over; the others keep their order.
    pub fn clear_finished(&mut self) {
        let mut kept = 0;
        for index in 0..self.count {
            let Some(contact) = self.contacts.get(index).copied().filter(|contact| !contact.is_over()) else {
                continue;
            };
            if let Some(place) = self.contacts.get_mut(kept) {
                *place = contact;
                kept += 1;
            }
        }
        self.count = kept;
    }

    fn under_way(&self) -> &[Contact] {
        self.contacts.get(..self.count).unwrap_or(&[])
    }
}
