//! A kit, read in place: [`Kit::parse`] checks everything once, after which the views cannot fail.

use zerocopy::byteorder::little_endian::F32;

use super::balance;
use super::check::{check_distinct, check_name, name_str};
use super::error::TableError;
use super::frame::{check_sections, is_known, only_section, optional_section, read_frame, sections, whole};
use super::headphone;
use super::layout::{MetaRecord, PadRecord, RoomBandRecord, SectionEntry, TriggerRecord, tag};
use super::object::Object;
use super::pad::{self, Pad};
use super::place::Place;
use super::residual::{Background, Residual};
use super::room;
use super::striker::{self, Striker};
use super::trigger::{self, Trigger};

/// A checked kit: views into the caller's bytes, without a copy.
#[derive(Clone, Copy, Debug)]
pub struct Kit<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) directory: &'a [SectionEntry],
    meta: &'a MetaRecord,
    pads: &'a [PadRecord],
    triggers: &'a [TriggerRecord],
    /// One restitution for each striker; empty if all have the default.
    restitutions: &'a [F32],
    headphone_db: Option<f32>,
}

impl<'a> Kit<'a> {
    /// Checks a kit's bytes and gives a view of them.
    ///
    /// Cost: one pass of CRC-32 and one over the records; no allocation, no copy.
    ///
    /// # Errors
    /// A [`TableError`] for the first thing that is wrong.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, TableError> {
        let (directory, kit_bytes) = read_frame(bytes)?;
        check_sections(directory, kit_bytes)?;
        let kit = Self {
            bytes: kit_bytes,
            directory,
            meta: only_section(directory, kit_bytes, tag::META)
                .and_then(|body| whole::<MetaRecord>(body, Place::Kit))?,
            pads: only_section(directory, kit_bytes, tag::PADS).and_then(pad::read)?,
            triggers: trigger::read(optional_section(directory, kit_bytes, tag::TRIGGER)?)?,
            restitutions: striker::read_restitutions(directory, kit_bytes)?,
            headphone_db: headphone::read(optional_section(directory, kit_bytes, tag::HEADPHONE)?)?,
        };
        kit.check()?;
        Ok(kit)
    }

    /// Name of the kit.
    pub fn name(&self) -> &'a str {
        name_str(&self.meta.name)
    }

    /// Volume of a board's headphones in dB; `None` if the kit gives none.
    pub fn headphone_db(&self) -> Option<f32> {
        self.headphone_db
    }

    /// Length of the kit in bytes, without the erased flash that may follow it.
    pub fn len_bytes(&self) -> usize {
        self.bytes.len()
    }

    /// Objects, in the order in which pads count them.
    pub fn objects(&self) -> impl Iterator<Item = Object<'a>> + Clone + use<'a> {
        sections(self.directory, self.bytes, tag::OBJECT).filter_map(|body| Object::read(body, 0).ok())
    }

    /// Strikers, in the order in which pads count them.
    pub fn strikers(&self) -> impl Iterator<Item = Striker<'a>> + Clone + use<'a> {
        let bodies = sections(self.directory, self.bytes, tag::STRIKER).enumerate();
        let restitutions = self.restitutions;
        bodies.filter_map(move |(index, body)| Striker::read(body, index, restitutions).ok())
    }

    /// Pads, in the order in which events count them.
    pub fn pads(&self) -> impl ExactSizeIterator<Item = Pad<'a>> + Clone + use<'a> {
        self.pads.iter().map(Pad::new)
    }

    /// Trigger settings of the pads that have some, in the order of the pads.
    /// [`crate::trigger::Settings::of_pad`] gives the settings of all pads.
    pub fn triggers(&self) -> impl ExactSizeIterator<Item = Trigger<'a>> + Clone + use<'a> {
        self.triggers.iter().map(Trigger::new)
    }

    /// Object that a pad of this kit plays. `None` can only come of a pad of another kit.
    pub fn object_of(&self, pad: Pad<'_>) -> Option<Object<'a>> {
        // Only this object is read: a strike at another position looks it up while sound plays.
        let body = sections(self.directory, self.bytes, tag::OBJECT).nth(pad.object_index())?;
        Object::read(body, 0).ok()
    }

    /// Strikers of a pad, the default one first.
    pub fn strikers_of<'p>(&self, pad: Pad<'p>) -> impl Iterator<Item = Striker<'a>> + use<'a, 'p> {
        let kit = *self;
        pad.striker_indices().filter_map(move |index| kit.strikers().nth(index))
    }

    /// Tags of the sections that this reader does not know and skips.
    pub fn skipped_sections(&self) -> impl Iterator<Item = [u8; 4]> + use<'a> {
        self.directory.iter().map(|entry| entry.tag).filter(|&tag| !is_known(tag))
    }

    /// Residual of the object of an index; `None` if the object has modes only.
    pub fn residual_of(&self, object: usize) -> Option<Residual<'a>> {
        self.residuals().find(|residual| residual.object_index() == object)
    }

    /// Residuals, in the order of their objects.
    pub fn residuals(&self) -> impl Iterator<Item = Residual<'a>> + Clone + use<'a> {
        sections(self.directory, self.bytes, tag::RESIDUAL).filter_map(|body| Residual::read(body).ok())
    }

    /// Background of the kit; `None` if the kit has no background.
    pub fn background(&self) -> Option<Background<'a>> {
        sections(self.directory, self.bytes, tag::BACKGROUND).next().and_then(|body| Background::read(body).ok())
    }

    /// Bands of the room, from the lowest up; empty if the kit has no room.
    pub fn room(&self) -> &'a [RoomBandRecord] {
        sections(self.directory, self.bytes, tag::ROOM).next().and_then(|body| room::read(body).ok()).unwrap_or(&[])
    }

    /// True if the acceleration sound of the object of an index is derived from its modes
    /// ([`crate::radiation`]).
    pub fn is_balanced(&self, object: usize) -> bool {
        let numbers = sections(self.directory, self.bytes, tag::BALANCE).next();
        let numbers = numbers.and_then(|body| balance::read(body).ok()).unwrap_or(&[]);
        numbers.iter().any(|number| usize::from(number.get()) == object)
    }

    fn check_surroundings(&self, objects: usize) -> Result<(), TableError> {
        let mut next_object = 0;
        for body in sections(self.directory, self.bytes, tag::RESIDUAL) {
            let residual = Residual::read(body)?;
            residual.check(objects, next_object)?;
            next_object = residual.object_index() + 1;
        }
        if let Some(body) = optional_section(self.directory, self.bytes, tag::BACKGROUND)? {
            Background::read(body)?.check()?;
        }
        if let Some(body) = optional_section(self.directory, self.bytes, tag::BALANCE)? {
            balance::check(balance::read(body)?, objects)?;
        }
        optional_section(self.directory, self.bytes, tag::ROOM)?.map_or(Ok(()), |body| room::read(body).map(|_| ()))
    }

    fn check(&self) -> Result<(), TableError> {
        check_name(&self.meta.name, Place::Kit)?;
        let mut objects = 0;
        for body in sections(self.directory, self.bytes, tag::OBJECT) {
            Object::read(body, objects)?.check(objects)?;
            objects += 1;
        }
        let mut strikers = 0;
        for body in sections(self.directory, self.bytes, tag::STRIKER) {
            Striker::read(body, strikers, self.restitutions)?.check(strikers)?;
            strikers += 1;
        }
        for (index, record) in self.pads.iter().enumerate() {
            Pad::new(record).check(index, objects, strikers)?;
        }
        check_distinct(self.objects().map(|object| object.name()), Place::Object)?;
        check_distinct(self.strikers().map(|striker| striker.name()), Place::Striker)?;
        check_distinct(self.pads().map(|pad| pad.name()), Place::Pad)?;
        self.check_notes()?;
        self.check_surroundings(objects)?;
        trigger::check(self.triggers, self.pads)
    }

    fn check_notes(&self) -> Result<(), TableError> {
        let mut claimed = [false; 128];
        for (index, pad) in self.pads().enumerate() {
            for note in pad.midi_notes() {
                match claimed.get_mut(usize::from(note)) {
                    Some(taken) if !*taken => *taken = true,
                    _ => {
                        return Err(TableError::BadNote { place: Place::Pad(index), note });
                    }
                }
            }
        }
        Ok(())
    }
}
