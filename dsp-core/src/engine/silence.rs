//! End of all sound: what a clear engine forgets.

use super::cost::CostItem;
use super::held::Held;
use super::state::{Direct, Engine};
use crate::event::{Event, Time};
use crate::room::Sample;
use crate::voice::Voice;

/// Nominal cycles of clearing a mode, and of clearing all else but frames and a room.
const MODE_CYCLES: u32 = 12;
const OTHER_CYCLES: u32 = 4_000;

impl<S: Sample> Engine<'_, '_, S> {
    /// Clears all sound where the fader has ended it, and begins the strikes that have waited; on a
    /// tick. Gives its cost.
    pub(super) fn end_silencing(&mut self, direct: Option<Direct<'_>>) -> [(CostItem, u32); 1] {
        self.clear_sound();
        let held = core::mem::replace(&mut self.held, Held::NONE);
        for strike in held.strikes() {
            let strike = Event { time: Time::at_frame(self.now), ..*strike };
            self.count_event(&strike);
            self.apply(&strike, direct);
        }
        [(CostItem::ResidualCycle, self.modes_built * MODE_CYCLES + OTHER_CYCLES)]
    }

    /// Forgets all sound but the background, which begins anew on the way to the level.
    #[inline(never)] // rare
    pub(super) fn clear_sound(&mut self) {
        self.contacts.clear();
        self.scrapes.end_those();
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
