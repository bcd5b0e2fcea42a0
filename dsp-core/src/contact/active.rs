//! The contacts that are under way in an engine: impacts, and the force of contacts that go on.

use super::law::Impact;
use super::ongoing::OngoingForces;
use super::pulse::{Asymmetry, Pulse, WHOLE};
use super::shape::{self, SHAPE_BITS};
use crate::fixed;
use crate::memory::{Memory, OutOfMemory, Region};

/// One contact under way.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    pad: u8,
    striker: u8,
    /// Position slot of the pad that the contact drives.
    slot: u8,
    pulse: Pulse,
    /// Peak force, Q4.27.
    peak: i32,
    /// Fraction of the pulse at the end of the next frame's interval, 1.0 = [`WHOLE`].
    phase: u64,
    /// Fraction of the pulse in one frame, at most 16.
    step: u64,
}

impl Contact {
    /// A contact that is over.
    const OVER: Self = Self { pad: 0, striker: 0, slot: 0, pulse: Pulse::Gaussian, peak: 0, phase: 0, step: 0 };

    /// Begins a contact between samples: its pulse began `early` before the next frame.
    ///
    /// `early` is a fraction of a sample, 1.0 = 2^32.
    pub fn new(pad: u8, striker: u8, impact: Impact, early: u32) -> Self {
        let (step, peak) = impact.pulse.played(impact.step, impact.peak);
        // The upper and lower halves apart, so that nothing overflows.
        let (upper, lower) = (step >> 32, step & 0xffff_ffff);
        let phase = upper * u64::from(early) + ((lower * u64::from(early)) >> 32);
        Self { pad, striker, slot: 0, pulse: impact.pulse, peak, phase, step: step.max(1) }
    }

    /// Moves the contact to the position of one of the pad's slots.
    pub fn in_slot(self, slot: u8) -> Self {
        Self { slot, ..self }
    }

    /// Phase from which on no frame has force; below 2^63.
    fn end(&self) -> u64 {
        match self.pulse {
            // The last frame is the one in whose interval the pulse ends.
            Pulse::Hertz(_) => WHOLE + self.step,
            Pulse::Gaussian => WHOLE,
        }
    }

    fn is_over(&self) -> bool {
        self.phase >= self.end() || self.step == 0
    }

    /// Upper bound of the number of frames that still have force.
    fn frames_left(&self) -> u32 {
        (self.end().saturating_sub(self.phase) >> 32) as u32 / ((self.step >> 32) as u32).max(1) + 1
    }

    /// Adds the pulse to a run of force and advances the phase.
    fn add_to(&mut self, force: &mut [i32]) {
        match self.pulse {
            Pulse::Hertz(asymmetry) => self.add_means(force, asymmetry),
            Pulse::Gaussian => self.add_gaussian(force),
        }
    }

    /// Adds to each frame the pulse's mean over the interval that ends at the frame.
    ///
    /// The pulse fills only a part of the first and of the last interval, which have coefficients
    /// of their own. The intervals between share theirs.
    #[inline(always)]
    fn add_means(&mut self, force: &mut [i32], asymmetry: Asymmetry) {
        let (step, peak) = (self.step, i64::from(self.peak));
        // A shape is below 1: the product is smaller than the peak.
        let scaled = |shape: i32| ((i64::from(shape) * peak) >> SHAPE_BITS) as i32;
        let mut frames = force.iter_mut();
        if self.phase < step {
            let Some(force) = frames.next() else { return };
            *force = fixed::qadd(*force, scaled(asymmetry.edge(self.phase, step)));
            self.phase += step;
        }
        if self.phase <= WHOLE {
            let means = asymmetry.means(step, 1 << 31);
            // The interval's middle; its upper 32 bits, which are below 1 here.
            let (mut middle, last) = (self.phase - step / 2, WHOLE - step / 2);
            while middle <= last {
                let Some(force) = frames.next() else { break };
                *force = fixed::qadd(*force, scaled(means.about((middle >> 26) as u32)));
                middle += step;
            }
            self.phase = middle + step / 2;
        }
        if self.phase > WHOLE && self.phase < WHOLE + step {
            let Some(force) = frames.next() else { return };
            *force = fixed::qadd(*force, scaled(asymmetry.edge(self.phase, step)));
            self.phase += step;
        }
    }

    #[inline(always)]
    fn add_gaussian(&mut self, force: &mut [i32]) {
        let (mut phase, step, peak) = (self.phase, self.step, i64::from(self.peak));
        for force in force {
            if phase >= WHOLE {
                break;
            }
            // Below 1.0: the upper 32 bits of the fraction.
            let value = (i64::from(shape::gaussian((phase >> 26) as u32)) * peak) >> SHAPE_BITS;
            *force = fixed::qadd(*force, value as i32);
            phase += step;
        }
        self.phase = phase;
    }
}

/// Contacts under way in an engine: impacts in the order in which they began, and contacts that go
/// on.
#[derive(Debug)]
pub struct ActiveContacts<'m> {
    contacts: &'m mut [Contact],
    count: usize,
    /// Force of contacts that go on.
    pub ongoing: OngoingForces<'m>,
}

impl<'m> ActiveContacts<'m> {
    /// Makes a set without memory for any contact.
    pub const fn none() -> Self {
        Self { contacts: &mut [], count: 0, ongoing: OngoingForces::none() }
    }

    /// Takes memory for at most `capacity` impacts under way, and for no contacts that go on.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, capacity: usize) -> Result<Self, OutOfMemory> {
        let contacts = memory.take(Region::Fast, capacity, || Contact::OVER)?;
        Ok(Self { contacts, count: 0, ongoing: OngoingForces::none() })
    }

    /// Number of impacts under way.
    pub fn count(&self) -> usize {
        self.count
    }

    /// True if any force acts.
    #[inline(always)]
    pub fn is_any(&self) -> bool {
        self.count > 0 || self.ongoing.is_any()
    }

    /// True if any force acts on a pad.
    #[inline(always)]
    pub fn is_any_on(&self, pad: u8) -> bool {
        self.under_way().iter().any(|contact| contact.pad == pad) || self.ongoing.is_any_on(pad)
    }

    /// True if any force acts on a pad by one of its strikers.
    #[inline(never)] // one copy for all ways of a pad's sound
    pub fn is_any_by(&self, pad: u8, striker: u8) -> bool {
        let is_by = |contact: &Contact| contact.pad == pad && contact.striker == striker;
        self.under_way().iter().any(is_by) || self.ongoing.is_any_by(pad, striker)
    }

    /// True if a contact under way on a pad drives the position slot.
    #[inline(always)]
    pub fn is_any_in(&self, pad: u8, slot: u8) -> bool {
        let is_in = |contact: &Contact| contact.pad == pad && contact.slot == slot;
        self.under_way().iter().any(is_in) || self.ongoing.is_any_in(pad, slot)
    }

    /// Bounds of the force that the contacts on a pad still bring.
    ///
    /// Returns the bound of the sum of their force in bus steps, and the longest impact in samples.
    /// Of contacts that go on it counts the force in the tick's rest.
    pub fn ahead(&self, pad: u8) -> (f32, f32) {
        let contacts = self.under_way().iter().filter(|contact| contact.pad == pad);
        contacts.fold((self.ongoing.input(pad), 0.0), |(input, longest), contact| {
            // The upper words are as precise as the floats.
            let step = ((contact.step >> 32) as u32).max(1) as f32;
            let left = (contact.end().saturating_sub(contact.phase) >> 32) as u32 as f32 / step + 1.0;
            let length = (contact.end() >> 32) as u32 as f32 / step;
            (input + contact.peak as f32 * left, if length > longest { length } else { longest })
        })
    }

    /// Number of frames with force within a run, added up over the impacts of a pad.
    pub fn frames_ahead(&self, pad: u8, frames: u32) -> u32 {
        let contacts = self.under_way().iter().filter(|contact| contact.pad == pad);
        contacts.map(|contact| contact.frames_left().min(frames)).sum()
    }

    /// Advances a pad's contacts without adding their force anywhere.
    pub fn pass(&mut self, pad: u8, frames: usize) {
        for contact in self.contacts.iter_mut().take(self.count).filter(|contact| contact.pad == pad) {
            contact.phase = contact.phase.saturating_add(contact.step.saturating_mul(frames as u64));
        }
        self.ongoing.pass(pad, frames);
    }

    /// Adds an impact. Returns true if it took the place of the contact nearest to its end.
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

    /// Adds the force of all contacts of a pad to a run, and advances them.
    pub fn add_force_of_pad(&mut self, pad: u8, force: &mut [i32]) {
        let own = self.contacts.iter_mut().take(self.count).filter(|contact| contact.pad == pad);
        own.for_each(|contact| contact.add_to(force));
        self.ongoing.add_of_pad(pad, force);
    }

    /// Adds the force of a pad's contacts with a striker in a position slot to a run, and advances
    /// them.
    pub fn add_force(&mut self, pad: u8, striker: u8, slot: u8, force: &mut [i32]) {
        let own = |contact: &&mut Contact| contact.pad == pad && contact.striker == striker && contact.slot == slot;
        self.contacts.iter_mut().take(self.count).filter(own).for_each(|contact| contact.add_to(force));
        self.ongoing.add(pad, striker, slot, force);
    }

    /// Ends all force at once.
    pub fn clear(&mut self) {
        self.count = 0;
        self.ongoing.clear();
    }

    /// Removes impacts that are over; the others keep their order.
    pub fn clear_finished(&mut self) {
        let mut kept = 0;
        for index in 0..self.count {
            if self.contacts.get(index).is_some_and(|contact| !contact.is_over()) {
                // Field by field, because a copy within the array links `memmove`: 1.5 KB.
                if let Some((before, rest)) = self.contacts.split_at_mut_checked(index)
                    && let (Some(place), Some(contact)) = (before.get_mut(kept), rest.first())
                {
                    let Contact { pad, striker, slot, pulse, peak, phase, step } = *contact;
                    (place.pad, place.striker, place.slot, place.pulse) = (pad, striker, slot, pulse);
                    (place.peak, place.phase, place.step) = (peak, phase, step);
                }
                kept += 1;
            }
        }
        self.count = kept;
    }

    fn under_way(&self) -> &[Contact] {
        self.contacts.get(..self.count).unwrap_or(&[])
    }
}
