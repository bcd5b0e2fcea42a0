//! The `PADS` section: what each pad plays.

use zerocopy::FromBytes;

use super::check::{check_count, check_name, check_range, check_ranges, name_str};
use super::error::TableError;
use super::layout::{NO_NOTE, NO_STRIKER, PadRecord, STRIKERS_PER_PAD};
use super::place::{Field, Place};
use super::range;

/// A pad of a [`Kit`](super::Kit).
#[derive(Clone, Copy, Debug)]
pub struct Pad<'a> {
    record: &'a PadRecord,
}

/// Records of a `PADS` section.
pub(super) fn read(body: &[u8]) -> Result<&[PadRecord], TableError> {
    <[PadRecord]>::ref_from_bytes(body).map_err(|_| TableError::LengthMismatch {
        place: Place::Kit,
        expected: body.len() / size_of::<PadRecord>() * size_of::<PadRecord>(),
        found: body.len(),
    })
}

impl<'a> Pad<'a> {
    pub(super) fn new(record: &'a PadRecord) -> Self {
        Self { record }
    }

    pub(super) fn check(&self, index: usize, objects: usize, strikers: usize) -> Result<(), TableError> {
        let place = Place::Pad(index);
        check_name(&self.record.name, place)?;
        if self.object_index() >= objects {
            return Err(TableError::Dangling {
                place,
                field: Field::Object,
                index: self.object_index(),
                count: objects,
            });
        }
        if let Some(index) = self.striker_indices().find(|&index| index >= strikers) {
            return Err(TableError::Dangling { place, field: Field::Strikers, index, count: strikers });
        }
        check_count(place, Field::Strikers, self.striker_indices().count(), 1, STRIKERS_PER_PAD)?;
        let filled = self.striker_indices().count();
        let ordered = self.record.strikers.iter().skip(filled).all(|index| index.get() == NO_STRIKER);
        let notes_ordered = self.record.midi_notes.iter().skip(self.midi_notes().count()).all(|&note| note == NO_NOTE);
        if !ordered || !notes_ordered || self.record.note_off > 1 || self.record.reserved != 0 {
            return Err(TableError::NotZero { place, field: Field::Padding });
        }
        let ranges = const {
            &[
                (Field::LevelDb, range::LEVEL_DB),
                (Field::Pan, range::PAN),
                (Field::StrikerWeight, range::STRIKER_WEIGHT),
            ]
        };
        check_ranges(place, ranges, &[self.level_db(), self.pan(), self.striker_weight()])?;
        if self.choke_t60_s() != 0.0 {
            check_range(place, Field::ChokeT60S, self.choke_t60_s(), range::CHOKE_T60_S)?;
        }
        Ok(())
    }

    /// Name of the pad.
    pub fn name(&self) -> &'a str {
        name_str(&self.record.name)
    }

    /// Number of the object that the pad plays, counted from 0 in the kit.
    pub fn object_index(&self) -> usize {
        usize::from(self.record.object.get())
    }

    /// Numbers of the pad's strikers, counted from 0 in the kit, the default one first.
    pub fn striker_indices(&self) -> impl Iterator<Item = usize> + use<'a> {
        self.record.strikers.iter().map(|index| index.get()).take_while(|&index| index != NO_STRIKER).map(usize::from)
    }

    /// Level in dB.
    pub fn level_db(&self) -> f32 {
        self.record.level_db.get()
    }

    /// Constant-power pan, -1 (left) to 1 (right).
    pub fn pan(&self) -> f32 {
        self.record.pan.get()
    }

    /// Weight η of the strikers' own banks.
    pub fn striker_weight(&self) -> f32 {
        self.record.striker_weight.get()
    }

    /// T60 in seconds that a choke imposes; 0 if the pad cannot be choked.
    pub fn choke_t60_s(&self) -> f32 {
        self.record.choke_t60_s.get()
    }

    /// True if the end of a MIDI note chokes the pad.
    pub fn note_off_chokes(&self) -> bool {
        self.record.note_off == 1
    }

    /// MIDI notes that play the pad.
    pub fn midi_notes(&self) -> impl Iterator<Item = u8> + use<'a> {
        self.record.midi_notes.iter().copied().take_while(|&note| note != NO_NOTE)
    }
}
