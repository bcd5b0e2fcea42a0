//! Cost of strikes whose pad has to move to their position.

use super::cost::CostItem;
use super::state::Engine;
use crate::frames::InFrames;
use crate::room::Sample;
use crate::voice::VoiceSize;

/// Number of modes that take as long to move as a head between two others in frames.
const HEAD_MODES: u32 = 11;

/// Modes and register groups whose gains a strike derives anew.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moved {
    modes: u32,
    groups: u32,
}

impl Moved {
    /// A head between two others.
    const HEAD: Self = Self { modes: HEAD_MODES, groups: 0 };

    /// Modes and groups of the object of a pad of a size, which has several positions.
    pub(super) fn of_size(size: &VoiceSize) -> Self {
        if size.is_in_frames() {
            return Self::HEAD;
        }
        size.banks().first().map_or(Self::default(), |object| Self {
            modes: object.modes as u32, // banks count in 16 bits
            groups: object.groups as u32,
        })
    }

    pub(super) fn counts(self) -> [(CostItem, u32); 2] {
        [(CostItem::MovedMode, self.modes), (CostItem::MovedGroup, self.groups)]
    }

    pub(super) fn cycles(self) -> u32 {
        self.counts().iter().map(|(item, count)| item.cycles() * count).sum()
    }
}

impl<S: Sample> Engine<'_, '_, S> {
    /// Time in which a strike of a pad would move the pad to its position, as the number of strikes
    /// that take as long, rounded up; 0 if the pad has one position, or is there. NaN is a position
    /// where no pad is.
    pub fn moving_strikes(&self, pad: u8, position: f32) -> u32 {
        self.moved(pad, position).cycles().div_ceil(CostItem::Strike.cycles())
    }

    /// Modes and groups that a strike of a pad at a position derives anew.
    pub(super) fn moved(&self, pad: u8, position: f32) -> Moved {
        let Some(voice) = self.voices.get(usize::from(pad)) else { return Moved::default() };
        let place = voice.place_of(position, |slot| self.is_slot_taken(pad, slot));
        if place.moves { self.moved_slot(pad) } else { Moved::default() }
    }

    /// True if a contact under way or one that goes on drives a slot of a pad.
    pub(super) fn is_slot_taken(&self, pad: u8, slot: u8) -> bool {
        self.contacts.is_any_in(pad, slot) || self.scrapes.hold(pad, slot)
    }

    /// Modes and groups of a slot of a pad, which a move derives anew.
    pub(super) fn moved_slot(&self, pad: u8) -> Moved {
        let Some(voice) = self.voices.get(usize::from(pad)) else { return Moved::default() };
        match voice.frames() {
            Some(_) => Moved::HEAD,
            None => voice.banks().first().map_or(Moved::default(), |object| Moved {
                modes: object.mode_count() as u32,
                groups: object.group_count(),
            }),
        }
    }
}
