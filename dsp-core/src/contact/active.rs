//! The contacts that are under way in an engine: impacts, and the force of contacts that go on.

use super::angle::{Angle, MOST_TURNED, Width};
use super::kernel::{self, Turning};
use super::law::Impact;
use super::ongoing::OngoingForces;
use super::pulse::{Asymmetry, Pulse, WHOLE};
use super::shape::{self, SHAPE_BITS};
use crate::fixed;
use crate::memory::{Memory, OutOfMemory, Region};

/// Maximum number of frames for which the angle of a pulse is turned: the errors of turns add up.
/// Then the angle is derived from the phase.
const TURNS: u8 = 32;

/// One contact under way.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    pad: u8,
    striker: u8,
    /// Position slot of the pad that the contact drives.
    slot: u8,
    /// Number of frames for which the angle is still turned; at 0 it is derived from the phase.
    turns: u8,
    pulse: Pulse,
    /// Peak force, Q4.27.
    peak: i32,
    /// Angle of a Hertz pulse at the middle of the next frame's interval, if it has `turns`.
    angle: Angle,
    /// Fraction of the pulse at the end of the next frame's interval, 1.0 = [`WHOLE`].
    phase: u64,
    /// Fraction of the pulse in one frame, at most 16.
    step: u64,
}

impl Contact {
    /// A contact that is over.
    const OVER: Self = Self {
        pad: 0,
        striker: 0,
        slot: 0,
        turns: 0,
        pulse: Pulse::Gaussian,
        peak: 0,
        angle: Angle::ZERO,
        phase: 0,
        step: 0,
    };

    /// Begins a contact between samples: its pulse began `early` before the next frame.
    ///
    /// `early` is a fraction of a sample, 1.0 = 2^32.
    pub fn new(pad: u8, striker: u8, impact: Impact, early: u32) -> Self {
        let (step, peak) = impact.pulse.played(impact.step, impact.peak);
        // The upper and lower halves apart, so that nothing overflows.
        let (upper, lower) = (step >> 32, step & 0xffff_ffff);
        let phase = upper * u64::from(early) + ((lower * u64::from(early)) >> 32);
        Self { pad, striker, pulse: impact.pulse, peak, phase, step: step.max(1), ..Self::OVER }
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
    fn add_means(&mut self, mut force: &mut [i32], asymmetry: Asymmetry) {
        let step = self.step;
        if self.phase < step {
            let Some((first, later)) = force.split_first_mut() else { return };
            *first = fixed::qadd(*first, self.scaled(asymmetry.edge(self.phase, step)));
            self.phase += step;
            force = later;
        }
        if self.phase <= WHOLE {
            force = self.add_inner_means(force, asymmetry);
        }
        if self.phase > WHOLE && self.phase < WHOLE + step {
            let Some(last) = force.first_mut() else { return };
            *last = fixed::qadd(*last, self.scaled(asymmetry.edge(self.phase, step)));
            self.phase += step;
        }
    }

    /// Adds the means over intervals within the pulse; gives the frames behind them.
    #[inline(always)]
    fn add_inner_means<'f>(&mut self, mut force: &'f mut [i32], asymmetry: Asymmetry) -> &'f mut [i32] {
        let step = self.step;
        let width = Width::new(step);
        let (means, rotation) = (asymmetry.means(width, 1 << 31), width.rotation());
        let most_turns = if step > MOST_TURNED { 1 } else { TURNS };
        let mut turning = Turning { angle: self.angle, rotation, means, peak: self.peak };
        // The interval's middle; its upper 32 bits, which are below 1 here.
        let (mut middle, last) = (self.phase - step / 2, WHOLE - step / 2);
        while middle <= last && !force.is_empty() {
            if self.turns == 0 {
                (turning.angle, self.turns) = (Angle::at((middle >> 26) as u32), most_turns);
            }
            // At least one frame; none whose middle is beyond the last one.
            let surely = (((last - middle) >> 32) as u32).checked_div((step >> 32) as u32 + 1).unwrap_or(0) + 1;
            let count = surely.min(self.turns.into()).min(force.len() as u32);
            let Some((now, later)) = core::mem::take(&mut force).split_at_mut_checked(count as usize) else { break };
            kernel::add_means(now, &mut turning);
            self.turns -= count as u8; // at most all
            middle += u64::from(count) * step;
            force = later;
        }
        (self.angle, self.phase) = (turning.angle, middle + step / 2);
        force
    }

    /// Force of a shape's value, which is below 1: the product is smaller than the peak.
    #[inline(always)]
    fn scaled(&self, shape: i32) -> i32 {
        ((i64::from(shape) * i64::from(self.peak)) >> SHAPE_BITS) as i32
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
            contact.turns = 0;
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
                    let Contact { pad, striker, slot, turns, pulse, peak, angle, phase, step } = *contact;
                    (place.pad, place.striker, place.slot, place.turns) = (pad, striker, slot, turns);
                    (place.pulse, place.peak, place.angle) = (pulse, peak, angle);
                    (place.phase, place.step) = (phase, step);
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

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;
    use std::prelude::v1::*;
    use std::{println, vec};

    /// Plays a contact in runs of the lengths that `run` gives, in turn.
    fn played(step: u64, early: u32, run: impl Fn(usize) -> usize) -> Vec<i32> {
        let impact = Impact { pulse: Pulse::hertz(0.5), peak: 1 << 30, step };
        let mut contact = Contact::new(0, 0, impact, early);
        let mut force = vec![0; (WHOLE / step) as usize + 40];
        let (mut rest, mut runs) = (&mut force[..], 0);
        while !rest.is_empty() {
            let (now, later) = rest.split_at_mut(run(runs).min(rest.len()));
            contact.add_to(now);
            (rest, runs) = (later, runs + 1);
        }
        assert!(contact.is_over());
        force
    }

    #[test]
    fn force_follows_the_integral_to_1e_8_of_the_peak_in_runs_of_any_length() {
        let Pulse::Hertz(asymmetry) = Pulse::hertz(0.5) else { unreachable!("asked for this pulse") };
        let area = f64::from(Pulse::Hertz(asymmetry).area());
        let skew = f64::from(asymmetry.skew()) / 2f64.powi(31);
        let integral = |x: f64| {
            let x = x.clamp(0.0, 1.0);
            let (half, whole) = ((PI * x / 2.0).sin(), (PI * x).sin());
            area * (half * half + skew / 4.0 * whole * whole)
        };
        let mut worst = 0.0f64;
        for samples in [0.3, 1.0, 1.9, 2.0, 2.1, 3.7, 16.0, 33.3, 96.2, 480.1, 24_000.7] {
            let step = (WHOLE as f64 / samples) as u64;
            for early in [0, 1 << 20, 1 << 31, u32::MAX] {
                let at_once = played(step, early, |_| usize::MAX);
                assert_eq!(at_once, played(step, early, |run| 1 + run * 7 % 31), "{samples} {early}");
                let h = step as f64 / WHOLE as f64;
                for (frame, &force) in at_once.iter().enumerate() {
                    let x = (frame as f64 + f64::from(early) / 2f64.powi(32)) * h;
                    let exact = (integral(x) - integral(x - h)) / h;
                    worst = worst.max((f64::from(force) / 2f64.powi(30) - exact).abs());
                }
            }
        }
        println!("{worst:.1e} of the peak");
        assert!(worst < 1e-8, "{worst:e}");
    }
}
