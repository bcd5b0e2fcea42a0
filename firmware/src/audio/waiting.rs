//! Events that wait for their frame.

use dsp_core::event::{Action, Event, Time};

/// Maximum number of events that wait. A press that chokes a whole kit makes one event per pad.
const WAITING: usize = 32;

/// Number of strikes that take as long as a cut of a half at another frame, where the engine
/// renders and predicts anew: on the BlackPill two strikes at two frames filled a half
/// (`cargo test -p virtual-board --test boards usb::times`).
const CUT: usize = 2;

/// Up to 32 events in order of time. Events of one frame keep the order in which they came.
pub(super) struct Waiting {
    events: [Event; WAITING],
    count: usize,
}

impl Waiting {
    /// No events.
    pub(super) const NONE: Self = Self { events: [Event::NOTHING; WAITING], count: 0 };

    /// Number of events for which there is room.
    pub(super) fn room(&self) -> usize {
        WAITING.saturating_sub(self.count)
    }

    /// Inserts an event; returns `false` if as many events wait as can.
    pub(super) fn insert(&mut self, event: Event) -> bool {
        if self.room() == 0 {
            return false;
        }
        // Most events come in order: the search for the place begins at the end.
        let mut place = self.count;
        while let Some(&before) = place.checked_sub(1).and_then(|before| self.events.get(before))
            && before.time > event.time
        {
            if let Some(slot) = self.events.get_mut(place) {
                *slot = before;
            }
            place -= 1;
        }
        if let Some(slot) = self.events.get_mut(place) {
            *slot = event;
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

    /// Returns all events; their times must stay in order.
    pub(super) fn all_mut(&mut self) -> &mut [Event] {
        self.events.get_mut(..self.count).unwrap_or_default()
    }

    /// Lets all events from the first strike on for which there is no time before a frame wait for
    /// that frame. Returns the number of strikes that are put off, and the work of the others.
    ///
    /// There is time for `most` pieces of work, and for the first strike. Each strike is one piece,
    /// and [`CUT`] more if it comes later than the strike before it. `moving` tells how many more
    /// it is because its pad has to move to its position, NaN if another strike moves the pad
    /// before.
    pub(super) fn put_off(&mut self, most: usize, frame: u64, moving: impl Fn(u8, f32) -> usize) -> (u32, usize) {
        let (mut work, mut late, mut moved_pads, mut last) = (0, 0, 0u32, None);
        let due = self.events.iter_mut().take(self.count).take_while(|event| event.time.first_frame() < frame);
        for event in due {
            let is_strike = event.action == Action::Strike;
            if is_strike && late == 0 {
                let bit = 1u32.checked_shl(event.pad.into()).unwrap_or(0);
                let position = if moved_pads & bit == 0 { event.position } else { f32::NAN };
                let moves = moving(event.pad, position);
                moved_pads |= if moves > 0 { bit } else { 0 };
                let strike_frame = event.time.first_frame();
                let more = 1 + moves + if last.is_some_and(|last| last != strike_frame) { CUT } else { 0 };
                if work == 0 || work + more <= most {
                    (work, last) = (work + more, Some(strike_frame));
                    continue;
                }
            }
            if is_strike || late > 0 {
                event.time = Time::at_frame(frame);
                late += u32::from(is_strike);
            }
        }
        (late, work)
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
