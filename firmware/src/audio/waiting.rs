//! Events that wait for their frame.

use dsp_core::event::Event;

/// Events that may wait at once. A press that chokes a whole kit makes as many as there are pads.
const WAITING: usize = 32;

/// Up to 32 events in order of time; those of the same frame in the order in which they came.
pub(super) struct Waiting {
    events: [Event; WAITING],
    count: usize,
}

impl Waiting {
    pub(super) const NONE: Self = Self { events: [Event::NOTHING; WAITING], count: 0 };

    /// `false` where there is no room.
    pub(super) fn insert(&mut self, event: Event) -> bool {
        let Some(waiting) = self.events.get_mut(..=self.count) else { return false };
        // What was at a place moves on to the next, from the event's own place on.
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

    /// Those that happen before a frame.
    pub(super) fn before(&self, frame: u64) -> &[Event] {
        let waiting = self.events.get(..self.count).unwrap_or(&[]);
        let due = waiting.iter().take_while(|event| event.time.first_frame() < frame).count();
        waiting.get(..due).unwrap_or(&[])
    }

    /// Takes the first `due` away.
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
