//! Events that wait for their frame.

use dsp_core::event::{Action, Event, Time};

/// Maximum number of events that wait. A press that chokes a whole kit makes one event per pad.
const WAITING: usize = 32;

/// Up to 32 events in order of time. Events of one frame keep the order in which they came.
pub(super) struct Waiting {
    events: [Event; WAITING],
    count: usize,
}

impl Waiting {
    /// No events.
    pub(super) const NONE: Self = Self { events: [Event::NOTHING; WAITING], count: 0 };

    /// Inserts an event; returns `false` if as many events wait as can.
    pub(super) fn insert(&mut self, event: Event) -> bool {
        let Some(waiting) = self.events.get_mut(..=self.count) else { return false };
        // From the event's place on, each event moves one place on.
        let mut moving = event;
        let mut is_found = false;
        for place in waiting.iter_mut().take(self.count) {
            is_found |= place.time > event.time;
            if is_found {
                core::mem::swap(place, &mut moving);
            }
        }
        if let Some(last) = waiting.last_mut() {
            *last = moving;
        }
        self.count += 1;
        true
    }

    /// Returns the events that happen before a frame.
    pub(super) fn before(&self, frame: u64) -> &[Event] {
        let waiting = self.events.get(..self.count).unwrap_or(&[]);
        let due = waiting.iter().take_while(|event| event.time.first_frame() < frame).count();
        waiting.get(..due).unwrap_or(&[])
    }

    /// Lets all events after the first `strikes` strikes that happen before a frame wait for that
    /// frame. Returns the number of strikes that are put off.
    pub(super) fn put_off(&mut self, strikes: usize, frame: u64) -> u32 {
        let (mut seen, mut late) = (0, 0);
        let due = self.events.iter_mut().take(self.count).take_while(|event| event.time.first_frame() < frame);
        for event in due {
            let is_strike = event.action == Action::Strike;
            seen += usize::from(is_strike);
            if seen > strikes {
                event.time = Time::at_frame(frame);
                late += u32::from(is_strike);
            }
        }
        late
    }

    /// Removes the first `due` events.
    pub(super) fn pass(&mut self, due: usize) {
        if due == 0 {
            return;
        }
        for place in 0..self.count.saturating_sub(due) {
            let later = self.events.get(place + due).copied();
            if let (Some(later), Some(slot)) = (later, self.events.get_mut(place)) {
                *slot = later;
            }
        }
        self.count = self.count.saturating_sub(due);
    }
}
