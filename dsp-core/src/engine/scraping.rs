//! Contacts that go on, as the engine plays them: touches, motions, the force of a tick, and the
//! slot that follows.

use super::cost::CostItem;
use super::scrapes::{Place, STANDARD_SCRAPES};
use super::setup::{CyclesLeft, Skipping};
use super::stage::Stage;
use super::state::Engine;
use crate::event::{Action, Event};
use crate::fixed;
use crate::room::Sample;
use crate::scrape::{Contact, Motion};
use crate::time::TICK_FRAMES;
use crate::voice::Voice;

impl<S: Sample> Engine<'_, '_, S> {
    /// True if a striker of a pad can scrape or roll on it.
    pub(super) fn has_surface(&self, pad: u8, striker: u8, rolls: bool) -> bool {
        Contact::is_possible(&self.kit, usize::from(pad), usize::from(striker), rolls)
    }

    /// Applies the motions that were told within the last tick, and those among a block's events
    /// that are due as a tick begins.
    #[inline(never)] // must not weigh on ticks without events
    pub(super) fn tell_due_motions(&mut self, events: &[Event]) {
        let (now, mut index) = (self.now, 0);
        while let Some(event) = self.scrapes.told(index) {
            self.tell_motion(&event);
            index += 1;
        }
        self.scrapes.forget_told();
        for event in events.iter().take_while(|event| event.time.first_frame() <= now) {
            if event.is_motion() {
                self.tell_motion(event);
            } else if event.action == Action::Silence {
                self.end_contacts();
            }
        }
    }

    /// Ends all contacts that go on with the sound that is ending, at once if there is none.
    #[inline(never)] // rare
    pub(super) fn end_contacts(&mut self) {
        self.scrapes.end_soon();
        if self.idle {
            self.scrapes.end_those();
        }
    }

    /// Notes what a contact that goes on does from the tick on that begins.
    fn tell_motion(&mut self, event: &Event) {
        let Event { pad, striker, position, .. } = *event;
        match event.action {
            #[cfg(feature = "scrapes")]
            Action::Touch { rolls, normal_n } => self.touch(event, rolls, normal_n),
            #[cfg(feature = "scrapes")]
            Action::Move(motion) => {
                // A contact that is ending goes on as it did.
                if let Some(place) = self.scrapes.touching(pad, striker).filter(|place| !place.ends_soon) {
                    (place.motion, place.position) = (motion, position);
                }
            }
            #[cfg(feature = "scrapes")]
            Action::Lift => {
                self.scrapes.touching(pad, striker).into_iter().for_each(Place::lift);
            }
            _ => {}
        }
    }

    /// Begins a contact at rest, if there is a place and time for it.
    fn touch(&mut self, event: &Event, rolls: bool, normal_n: [f32; 2]) {
        let Event { pad, striker, position, .. } = *event;
        let touches = self.scrapes.touches;
        self.scrapes.touches = touches.wrapping_add(1);
        if self.scrapes.places.is_empty() {
            return;
        }
        let contact = Contact::of(&self.kit, usize::from(pad), usize::from(striker), rolls, normal_n);
        let Some(mut contact) = contact else { return };
        contact.seed = contact.seed.wrapping_add(touches << 8);
        // The contact before it, of the same striker, only fades from now on.
        let mut left = CyclesLeft::new(self.stage_cycles, self.sounding_cycles_beside((pad, striker)));
        // A touch takes longer than most ticks, and so do several in one.
        let first = self.scrapes.touch_cycles.saturating_add(contact.first_tick());
        let dearest = contact.dearest_tick().max(first);
        if !left.admits(false, Stage::Scrapes.worst_cycles(dearest)) {
            self.scrapes.refused += 1;
            return;
        }
        self.scrapes.touching(pad, striker).into_iter().for_each(Place::lift);
        let Some(voice) = self.voices.get(usize::from(pad)) else { return };
        let slot = voice.place_of(position, |slot| self.is_slot_taken(pad, slot));
        let leads_slot = voice.follows_positions() && !slot.is_merged && !self.scrapes.hold(pad, slot.slot);
        let Some(place) = self.scrapes.vacant() else {
            self.scrapes.refused += 1;
            return;
        };
        // A place whose slot stands elsewhere moves it as the next tick begins.
        let slot_position = if slot.moves { f32::NEG_INFINITY } else { position };
        (place.pad, place.striker, place.slot) = (pad, striker, slot.slot);
        (place.leads_slot, place.touches, place.ends_soon) = (leads_slot, true, false);
        (place.motion, place.position, place.slot_position) = (Motion::default(), position, slot_position);
        place.last_position = position;
        place.scraper.begin(contact);
        self.scrapes.touch_cycles = self.scrapes.touch_cycles.saturating_add(contact.touch_cycles());
    }

    /// Renders the force of the tick that begins.
    #[inline(never)] // must not weigh on kits without surfaces
    pub(super) fn scrape(&mut self) {
        let mut cycles = core::mem::take(&mut self.scrapes.touch_cycles);
        self.report.refused_scrapes += core::mem::take(&mut self.scrapes.refused);
        for index in 0..STANDARD_SCRAPES {
            let Some(place) = self.scrapes.places.get(index) else { break };
            if !place.is_due() {
                continue;
            }
            let (pad, striker) = (place.pad, place.striker);
            if self.slot_follows(place) {
                self.follow(index);
            }
            let Some(place) = self.scrapes.places.get_mut(index) else { break };
            place.last_position = place.position;
            let scraper = &mut place.scraper;
            let Some(force) = self.contacts.ongoing.begin(index, (pad, striker), place.slot) else { break };
            let is_rendered = scraper.render(place.motion, force).is_ok();
            cycles += scraper.cycles();
            let input = fixed::sum_of_magnitudes(force);
            let is_silent = self.skipping == Skipping::On && input == 0;
            if is_silent || !is_rendered {
                self.contacts.ongoing.end(index);
                continue;
            }
            self.report.scrape_frames += TICK_FRAMES as u32;
            self.wake(pad);
            if let Some(voice) = self.voices.get_mut(usize::from(pad)) {
                voice.expect_ongoing(striker, input);
            }
        }
        if self.budget.is_some() {
            self.report.counts.add(CostItem::ResidualCycle, cycles);
        }
    }

    /// Guards the pads for the contacts that go on, as their tick begins.
    #[inline(never)] // must not weigh on kits without surfaces
    pub(super) fn meet_ongoing(&mut self) {
        for pad in self.awake.pads() {
            self.voices.get_mut(usize::from(pad)).into_iter().for_each(Voice::meet_ongoing);
        }
    }

    /// True if a contact's slot is to move to the contact's place. Impacts that are under way keep
    /// it where it is.
    fn slot_follows(&self, place: &Place<'_>) -> bool {
        let has_moved = (place.middle() - place.slot_position).abs() > self.position_step;
        place.leads_slot && has_moved && !self.contacts.is_any_in(place.pad, place.slot)
    }

    /// Moves a contact's slot to the contact's place.
    fn follow(&mut self, index: usize) {
        let Some(place) = self.scrapes.places.get_mut(index) else { return };
        place.slot_position = place.middle();
        let Place { pad, slot, slot_position, .. } = *place;
        self.set_position(pad, slot, slot_position);
        self.voices.get_mut(usize::from(pad)).into_iter().for_each(Voice::note_move);
        if self.budget.is_some() {
            let moved = self.moved_slot(pad).counts();
            self.report.counts.add_all(moved);
        }
    }
}
