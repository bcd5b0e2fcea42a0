//! End of all sound: what a clear engine forgets, and the strikes that wait for it.

use super::cost::CostItem;
use super::state::{Direct, Engine};
use crate::event::{Event, Time};
use crate::room::Sample;
use crate::voice::Voice;

/// Maximum number of strikes that wait for the end of a sound; more displace the oldest.
const WAITING: usize = 8;
/// Nominal cycles of clearing a mode, and of clearing all else but frames and a room.
const MODE_CYCLES: u32 = 12;
const OTHER_CYCLES: u32 = 4_000;

/// Strikes that wait until the sound before them has ended, at most 5 ms.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    strikes: [Event; WAITING],
    count: usize,
}

impl Held {
    /// No strikes.
    pub(super) const NONE: Self = Self { strikes: [Event::NOTHING; WAITING], count: 0 };

    /// Lets a strike wait.
    pub(super) fn push(&mut self, strike: &Event) {
        if self.count == WAITING {
            self.strikes.rotate_left(1);
            self.count -= 1;
        }
        if let Some(place) = self.strikes.get_mut(self.count) {
            *place = *strike;
            self.count += 1;
        }
    }

    /// True if no strike waits.
    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }
}

impl<S: Sample> Engine<'_, '_, S> {
    /// Clears all sound where the fader has ended it, and begins the strikes that have waited; on a
    /// tick. Gives its cost.
    pub(super) fn end_silencing(&mut self, direct: Option<Direct<'_>>) -> [(CostItem, u32); 1] {
        self.clear_sound();
        let held = core::mem::replace(&mut self.held, Held::NONE);
        for strike in held.strikes.iter().take(held.count) {
            self.apply(&Event { time: Time::at_frame(self.now), ..*strike }, direct);
        }
        [(CostItem::ResidualCycle, self.modes_built * MODE_CYCLES + OTHER_CYCLES)]
    }

    /// Forgets all sound but the background, which begins anew on the way to the level.
    #[inline(never)] // rare
    pub(super) fn clear_sound(&mut self) {
        self.contacts.clear();
        self.expects = false;
        self.voices.iter_mut().for_each(Voice::rest);
        if let Some(mixer) = &mut self.frames {
            mixer.rest();
        }
        if let Some(room) = self.room.as_deref_mut() {
            room.rest();
        }
        (self.retired_amplitude, self.retired_in_frames) = (0.0, 0.0);
        match self.background {
            Some(_) => self.fader.begin(self.rate),
            None => self.fader.settle(),
        }
    }
}
