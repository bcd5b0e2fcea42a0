//! The `OBJT` sections: objects to strike.

use super::check::{check_bank, check_count, check_name, check_range, check_text, name_str, read_bank, text_str};
use super::error::TableError;
use super::frame::head;
use super::layout::{GainRecord, ModeRecord, ObjectHeader};
use super::place::{Field, Place};
use super::range;

/// A struck object of a [`Kit`](super::Kit).
#[derive(Clone, Copy, Debug)]
pub struct Object<'a> {
    header: &'a ObjectHeader,
    modes: &'a [ModeRecord],
    gains: &'a [GainRecord],
    source: &'a [u8],
    licence: &'a [u8],
}

impl<'a> Object<'a> {
    pub(super) fn read(body: &'a [u8], index: usize) -> Result<Self, TableError> {
        let place = Place::Object(index);
        let (header, rest) = head::<ObjectHeader>(body, place)?;
        let modes = usize::from(header.mode_count.get());
        let positions = usize::from(header.position_count.get());
        check_count(place, Field::Positions, positions, 1, range::POSITIONS)?;
        check_count(place, Field::Modes, modes, 0, range::MODES_PER_BANK)?;
        let texts = (usize::from(header.source_bytes.get()), usize::from(header.licence_bytes.get()));
        let (modes, gains, source, licence) = read_bank(body.len(), rest, modes, positions, texts, place)?;
        Ok(Self { header, modes, gains, source, licence })
    }

    pub(super) fn check(&self, index: usize) -> Result<(), TableError> {
        let place = Place::Object(index);
        check_name(&self.header.name, place)?;
        [self.source, self.licence].iter().try_for_each(|text| check_text(text, place))?;
        check_range(place, Field::ReferenceForce, self.reference_force(), range::REFERENCE_FORCE)?;
        check_range(place, Field::Acceleration, self.acceleration(), range::ACCELERATION)?;
        check_bank(self.modes, self.gains, self.position_count(), |mode| Place::ObjectMode(index, mode))
    }

    /// Name of the object.
    pub fn name(&self) -> &'a str {
        name_str(&self.header.name)
    }

    /// Reference force in newtons: the force that 1.0 on the force bus stands for. It is 1 if the
    /// object is not calibrated.
    pub fn reference_force(&self) -> f32 {
        self.header.reference_force.get()
    }

    /// Acceleration sound α, output per newton. An object of which
    /// [`Kit::is_balanced`](super::Kit::is_balanced) is true derives its own instead.
    pub fn acceleration(&self) -> f32 {
        self.header.acceleration.get()
    }

    /// Number of positions at which gains are given, at least 1.
    pub fn position_count(&self) -> usize {
        usize::from(self.header.position_count.get())
    }

    /// Poles of the modes.
    pub fn modes(&self) -> &'a [ModeRecord] {
        self.modes
    }

    /// Gains of the modes: all positions of the first mode, then of the second ...
    pub fn gains(&self) -> &'a [GainRecord] {
        self.gains
    }

    /// Source of the numbers, as text.
    pub fn source(&self) -> &'a str {
        text_str(self.source)
    }

    /// Licence of the numbers, as text.
    pub fn licence(&self) -> &'a str {
        text_str(self.licence)
    }
}
