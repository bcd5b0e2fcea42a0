//! Cost of strikes whose pad has to move to their position.

use super::cost::CostItem;
use super::load_modes::HEAD_MODES;
use super::state::Engine;
use crate::frames::InFrames;
use crate::room::Sample;

impl<S: Sample> Engine<'_, '_, S> {
    /// Time in which a strike of a pad would move the pad to its position, as the number of strikes
    /// that take as long, rounded up; 0 if the pad has one position, or is there. NaN is a position
    /// where no pad is.
    pub fn moving_strikes(&self, pad: u8, position: f32) -> u32 {
        (self.moved_modes(pad, position) * CostItem::MovedMode.cycles()).div_ceil(CostItem::Strike.cycles())
    }

    /// Number of modes whose gains a strike derives anew.
    pub(super) fn moved_modes(&self, pad: u8, position: f32) -> u32 {
        let Some(voice) = self.voices.get(usize::from(pad)) else { return 0 };
        let place = voice.place_of(position, |slot| self.contacts.is_any_in(pad, slot));
        match (place.moves, voice.frames()) {
            (false, _) => 0,
            // A head between two others takes as long as the gains of eight modes.
            (true, Some(_)) => HEAD_MODES,
            (true, None) => voice.banks().first().map_or(0, |object| object.mode_count() as u32),
        }
    }
}
