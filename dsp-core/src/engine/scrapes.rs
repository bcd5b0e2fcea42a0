//! Contacts that go on: told by events, rendered at a tick's beginning, beside the impacts.
//!
//! ```text
//! Touch, Move, Lift --> place: scraper, motion --(each tick)--> force of the tick's frames
//!                                    \--> slot of the pad at the contact's place
//! ```

use crate::SampleRate;
use crate::contact::OngoingForces;
use crate::event::Event;
use crate::memory::{Memory, OutOfMemory, Region};
use crate::scrape::{Contact, Motion, Scraper};

/// Maximum number of contacts that go on at once, those that fade after their lift included: two
/// hands. A further one is refused.
pub const STANDARD_SCRAPES: usize = 2;

/// Maximum number of motions that are told within a tick. Of one contact's motions in a row only
/// the last one counts.
const MOST_TOLD: usize = 16;

/// One contact that goes on.
#[derive(Debug)]
pub(super) struct Place<'k> {
    pub(super) pad: u8,
    pub(super) striker: u8,
    /// Position slot of the pad that it drives.
    pub(super) slot: u8,
    /// True if the slot follows it: the object has several positions, and no other contact came
    /// first.
    pub(super) leads_slot: bool,
    /// True from the touch until the lift.
    pub(super) touches: bool,
    /// True if it ends with the sound that a [silence](crate::event::Action::Silence) is ending.
    pub(super) ends_soon: bool,
    pub(super) motion: Motion,
    /// Place along the object, 0 to 1, at the end of the coming tick and of the last one, and that
    /// of the slot.
    pub(super) position: f32,
    pub(super) last_position: f32,
    pub(super) slot_position: f32,
    pub(super) scraper: Scraper<'k>,
}

impl<'k> Place<'k> {
    /// Free place.
    fn new(contact: Contact<'k>, rate: SampleRate) -> Self {
        Self {
            pad: 0,
            striker: 0,
            slot: 0,
            leads_slot: false,
            touches: false,
            ends_soon: false,
            motion: Motion::default(),
            position: 0.0,
            last_position: 0.0,
            slot_position: 0.0,
            scraper: Scraper::new(contact, rate),
        }
    }

    /// True if the next tick has something to render.
    pub(super) fn is_due(&self) -> bool {
        self.motion.velocity_m_per_s != [0.0; 2] || !self.scraper.is_silent()
    }

    /// Place along the object in the middle of the coming tick.
    pub(super) fn middle(&self) -> f32 {
        0.5 * (self.last_position + self.position)
    }

    /// True if it touches, or fades after its lift.
    fn is_taken(&self) -> bool {
        self.touches || self.is_due()
    }

    /// Lifts the striker: the contact fades.
    pub(super) fn lift(&mut self) {
        (self.motion, self.touches) = (Motion::default(), false);
    }
}

/// All contacts that go on in an engine.
#[derive(Debug)]
pub(super) struct Scrapes<'k, 'm> {
    pub(super) places: &'m mut [Place<'k>],
    /// Motions that were told within the tick, and their number. They take effect as the next one
    /// begins, whatever has happened by the end of a block.
    told: &'m mut [Event],
    told_count: usize,
    /// Number of touches since the load: each begins at a place of its own on the surface.
    pub(super) touches: u32,
    /// Cycles of the touches since the last tick, and the number of those that were refused.
    pub(super) touch_cycles: u32,
    pub(super) refused: u32,
}

impl<'k, 'm> Scrapes<'k, 'm> {
    /// No contact can go on.
    pub(super) const fn none() -> Self {
        Self { places: &mut [], told: &mut [], told_count: 0, touches: 0, touch_cycles: 0, refused: 0 }
    }

    /// Takes memory for [`STANDARD_SCRAPES`] and their forces. `contact` is any that the kit
    /// allows.
    pub(super) fn take(
        memory: &mut Memory<'m>,
        contact: Contact<'k>,
        rate: SampleRate,
    ) -> Result<(Self, OngoingForces<'m>), OutOfMemory>
    where
        'k: 'm,
    {
        let places = memory.take(Region::Bulk, STANDARD_SCRAPES, || Place::new(contact, rate))?;
        let told = memory.take(Region::Bulk, MOST_TOLD, || Event::NOTHING)?;
        Ok((Self { places, told, ..Self::none() }, OngoingForces::take(memory, STANDARD_SCRAPES)?))
    }

    /// True if the next tick has something to render or to tell.
    #[inline(always)]
    pub(super) fn are_due(&self) -> bool {
        let has_news = || self.told_count > 0 || self.touch_cycles > 0 || self.refused > 0;
        cfg!(feature = "scrapes") && !self.places.is_empty() && (has_news() || self.places.iter().any(Place::is_due))
    }

    /// Notes a motion within a tick.
    pub(super) fn note(&mut self, event: &Event) {
        let told = self.told.get_mut(..self.told_count).unwrap_or(&mut []);
        let mut own = told.iter_mut().rev().filter(|told| (told.pad, told.striker) == (event.pad, event.striker));
        if let (true, Some(last)) = (event.is_move(), own.next())
            && last.is_move()
        {
            *last = *event;
        } else if let Some(place) = self.told.get_mut(self.told_count) {
            *place = *event;
            self.told_count += 1;
        } else if !self.places.is_empty() {
            self.refused += 1;
        }
    }

    /// True if any motion was told within the last tick.
    #[inline(always)]
    pub(super) fn are_told(&self) -> bool {
        cfg!(feature = "scrapes") && self.told_count > 0
    }

    /// Motion that was told within the last tick, from the first one on.
    pub(super) fn told(&self, index: usize) -> Option<Event> {
        self.told.get(..self.told_count)?.get(index).copied()
    }

    /// Forgets the motions that were told.
    pub(super) fn forget_told(&mut self) {
        self.told_count = 0;
    }

    /// True if a contact holds a position slot of a pad, at rest or not.
    pub(super) fn hold(&self, pad: u8, slot: u8) -> bool {
        let holds = |place: &Place<'_>| (place.pad, place.slot) == (pad, slot) && place.is_taken();
        cfg!(feature = "scrapes") && self.places.iter().any(holds)
    }

    /// Lets all contacts end with the sound that is ending.
    pub(super) fn end_soon(&mut self) {
        self.forget_told();
        for place in self.places.iter_mut().filter(|place| place.is_taken()) {
            place.ends_soon = true;
        }
    }

    /// Ends the contacts that were to end soon.
    pub(super) fn end_those(&mut self) {
        if !cfg!(feature = "scrapes") {
            return;
        }
        for place in self.places.iter_mut().filter(|place| place.ends_soon) {
            place.lift();
            place.ends_soon = false;
            place.scraper.stop();
        }
    }

    /// Nominal cycles of each contact's dearest tick, without those that fade and that of a pad's
    /// striker.
    pub(super) fn dearest_ticks(&self, (pad, striker): (u8, u8)) -> impl Iterator<Item = u32> {
        let touching =
            self.places.iter().filter(move |place| place.touches && (place.pad, place.striker) != (pad, striker));
        touching.map(|place| place.scraper.contact().dearest_tick())
    }

    /// Place in which a pad's striker touches.
    pub(super) fn touching(&mut self, pad: u8, striker: u8) -> Option<&mut Place<'k>> {
        self.places.iter_mut().find(|place| place.touches && (place.pad, place.striker) == (pad, striker))
    }

    /// Place for a new contact: a free one, or else one that fades after its lift.
    pub(super) fn vacant(&mut self) -> Option<&mut Place<'k>> {
        let index = self.places.iter().position(|place| !place.is_taken());
        let index = index.or_else(|| self.places.iter().position(|place| !place.touches))?;
        self.places.get_mut(index)
    }
}
