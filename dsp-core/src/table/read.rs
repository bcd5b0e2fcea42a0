//! Reading a kit in place: everything is checked once in [`Kit::parse`], after which the views cannot fail.

use zerocopy::FromBytes;
use zerocopy::byteorder::little_endian::F32;

use super::balance;
use super::check::{
    check_bank, check_count, check_distinct, check_name, check_range, check_ranges, name_str, read_bank,
};
use super::error::TableError;
use super::frame::{check_sections, head, is_known, only_section, optional_section, read_frame, sections, whole};
use super::layout::{
    GainRecord, MetaRecord, ModeRecord, NO_NOTE, NO_STRIKER, ObjectHeader, PadRecord, RoomBandRecord, SectionEntry,
    StrikerHeader, TriggerRecord, tag,
};
use super::place::{Field, Place};
use super::range;
use super::residual::{Background, Residual};
use super::room;
use super::trigger::Trigger;

/// A checked kit: views into the caller's bytes, nothing is copied.
#[derive(Clone, Copy, Debug)]
pub struct Kit<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) directory: &'a [SectionEntry],
    meta: &'a MetaRecord,
    pads: &'a [PadRecord],
    triggers: &'a [TriggerRecord],
    /// One for each striker, or none where all have the default.
    restitutions: &'a [F32],
}

/// A struck object of a [`Kit`].
#[derive(Clone, Copy, Debug)]
pub struct Object<'a> {
    header: &'a ObjectHeader,
    modes: &'a [ModeRecord],
    gains: &'a [GainRecord],
    source: &'a str,
    licence: &'a str,
}

/// A striker of a [`Kit`].
#[derive(Clone, Copy, Debug)]
pub struct Striker<'a> {
    header: &'a StrikerHeader,
    restitution: f32,
    modes: &'a [ModeRecord],
    gains: &'a [GainRecord],
    source: &'a str,
    licence: &'a str,
}

/// What contact a [`Striker`] makes: `m = m1 v^a`, `τ = τ1 v^b`. A pointer into the kit, so that a pad can keep one for each of its strikers.
#[derive(Clone, Copy, Debug)]
pub struct ContactTable<'a> {
    header: &'a StrikerHeader,
    restitution: f32,
}

/// A pad of a [`Kit`].
#[derive(Clone, Copy, Debug)]
pub struct Pad<'a> {
    record: &'a PadRecord,
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
            pads: only_section(directory, kit_bytes, tag::PADS).and_then(|body| {
                <[PadRecord]>::ref_from_bytes(body).map_err(|_| TableError::LengthMismatch {
                    place: Place::Kit,
                    expected: body.len() / size_of::<PadRecord>() * size_of::<PadRecord>(),
                    found: body.len(),
                })
            })?,
            triggers: super::trigger::read(optional_section(directory, kit_bytes, tag::TRIGGER)?)?,
            restitutions: read_restitutions(directory, kit_bytes)?,
        };
        kit.check()?;
        Ok(kit)
    }

    /// The kit's name.
    pub fn name(&self) -> &'a str {
        name_str(&self.meta.name)
    }

    /// The kit's length in bytes, without what may follow it in flash.
    pub fn len_bytes(&self) -> usize {
        self.bytes.len()
    }

    /// The objects, in the order in which pads count them.
    pub fn objects(&self) -> impl Iterator<Item = Object<'a>> + Clone + use<'a> {
        sections(self.directory, self.bytes, tag::OBJECT).filter_map(|body| Object::read(body, 0).ok())
    }

    /// The strikers, in the order in which pads count them.
    pub fn strikers(&self) -> impl Iterator<Item = Striker<'a>> + Clone + use<'a> {
        let bodies = sections(self.directory, self.bytes, tag::STRIKER).enumerate();
        let restitutions = self.restitutions;
        bodies.filter_map(move |(index, body)| Striker::read(body, index, restitutions).ok())
    }

    /// The pads.
    pub fn pads(&self) -> impl ExactSizeIterator<Item = Pad<'a>> + Clone + use<'a> {
        self.pads.iter().map(|record| Pad { record })
    }

    /// How pads are triggered, for the pads that say so, in the order of the pads. See [`crate::trigger::Settings::of_pad`].
    pub fn triggers(&self) -> impl ExactSizeIterator<Item = Trigger<'a>> + Clone + use<'a> {
        self.triggers.iter().map(Trigger::new)
    }

    /// The object that a pad plays. `None` only for a pad of another kit.
    pub fn object_of(&self, pad: Pad<'_>) -> Option<Object<'a>> {
        self.objects().nth(usize::from(pad.record.object.get()))
    }

    /// The strikers of a pad, the default one first.
    pub fn strikers_of<'p>(&self, pad: Pad<'p>) -> impl Iterator<Item = Striker<'a>> + use<'a, 'p> {
        let kit = *self;
        pad.striker_indices().filter_map(move |index| kit.strikers().nth(index))
    }

    /// Tags of sections that were skipped because this reader does not know them.
    pub fn skipped_sections(&self) -> impl Iterator<Item = [u8; 4]> + use<'a> {
        self.directory.iter().map(|entry| entry.tag).filter(|&tag| !is_known(tag))
    }

    /// What the object of an index sounds beside its modes.
    pub fn residual_of(&self, object: usize) -> Option<Residual<'a>> {
        self.residuals().find(|residual| residual.object_index() == object)
    }

    /// All residuals, in the order of their objects.
    pub fn residuals(&self) -> impl Iterator<Item = Residual<'a>> + Clone + use<'a> {
        sections(self.directory, self.bytes, tag::RESIDUAL).filter_map(|body| Residual::read(body).ok())
    }

    /// The background, where the kit has one.
    pub fn background(&self) -> Option<Background<'a>> {
        sections(self.directory, self.bytes, tag::BACKGROUND).next().and_then(|body| Background::read(body).ok())
    }

    /// The bands of the room, from the lowest up; none where the kit has no room.
    pub fn room(&self) -> &'a [RoomBandRecord] {
        sections(self.directory, self.bytes, tag::ROOM).next().and_then(|body| room::read(body).ok()).unwrap_or(&[])
    }

    /// Whether the acceleration sound of the object of an index is derived from its modes ([`crate::radiation`]).
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
            Pad { record }.check(index, objects, strikers)?;
        }
        check_distinct(self.objects().map(|object| object.name()), Place::Object)?;
        check_distinct(self.strikers().map(|striker| striker.name()), Place::Striker)?;
        check_distinct(self.pads().map(|pad| pad.name()), Place::Pad)?;
        self.check_notes()?;
        self.check_surroundings(objects)?;
        super::trigger::check(self.triggers, self.pads)
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

/// The restitutions of a kit: one for each striker, or none.
fn read_restitutions<'a>(directory: &'a [SectionEntry], kit: &'a [u8]) -> Result<&'a [F32], TableError> {
    let Some(body) = optional_section(directory, kit, tag::RESTITUTION)? else { return Ok(&[]) };
    // Counts of a directory in memory: the product cannot overflow.
    let expected = sections(directory, kit, tag::STRIKER).count() * size_of::<F32>();
    match <[F32]>::ref_from_bytes(body) {
        Ok(restitutions) if body.len() == expected => Ok(restitutions),
        _ => Err(TableError::LengthMismatch { place: Place::Kit, expected, found: body.len() }),
    }
}

impl<'a> Object<'a> {
    fn read(body: &'a [u8], index: usize) -> Result<Self, TableError> {
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

    fn check(&self, index: usize) -> Result<(), TableError> {
        let place = Place::Object(index);
        check_name(&self.header.name, place)?;
        check_range(place, Field::ReferenceForce, self.reference_force(), range::REFERENCE_FORCE)?;
        check_range(place, Field::Acceleration, self.acceleration(), range::ACCELERATION)?;
        check_bank(self.modes, self.gains, self.position_count(), |mode| Place::ObjectMode(index, mode))
    }

    /// The object's name.
    pub fn name(&self) -> &'a str {
        name_str(&self.header.name)
    }

    /// Newtons (1 where uncalibrated) that 1.0 on the force bus stands for.
    pub fn reference_force(&self) -> f32 {
        self.header.reference_force.get()
    }

    /// Acceleration sound α, output per newton; a fallback where [`Kit::is_balanced`].
    pub fn acceleration(&self) -> f32 {
        self.header.acceleration.get()
    }

    /// Number of positions at which gains are given, at least 1.
    pub fn position_count(&self) -> usize {
        usize::from(self.header.position_count.get())
    }

    /// The modes' poles.
    pub fn modes(&self) -> &'a [ModeRecord] {
        self.modes
    }

    /// The modes' gains: all positions of the first mode, then of the second ...
    pub fn gains(&self) -> &'a [GainRecord] {
        self.gains
    }

    /// Where the numbers come from.
    pub fn source(&self) -> &'a str {
        self.source
    }

    /// The licence of the numbers.
    pub fn licence(&self) -> &'a str {
        self.licence
    }
}

impl<'a> Striker<'a> {
    fn read(body: &'a [u8], index: usize, restitutions: &[F32]) -> Result<Self, TableError> {
        let place = Place::Striker(index);
        let (header, rest) = head::<StrikerHeader>(body, place)?;
        let modes = usize::from(header.mode_count.get());
        check_count(place, Field::Modes, modes, 0, range::MODES_PER_BANK)?;
        let texts = (usize::from(header.source_bytes.get()), usize::from(header.licence_bytes.get()));
        let (modes, gains, source, licence) = read_bank(body.len(), rest, modes, 1, texts, place)?;
        let restitution = restitutions.get(index).map_or(range::DEFAULT_RESTITUTION, |restitution| restitution.get());
        Ok(Self { header, restitution, modes, gains, source, licence })
    }

    fn check(&self, index: usize) -> Result<(), TableError> {
        let place = Place::Striker(index);
        check_name(&self.header.name, place)?;
        check_count(place, Field::Pulse, self.header.pulse.get() as usize, 0, 1)?;
        let contact = self.contact();
        let ranges = const {
            &[
                (Field::PeakForce, range::PEAK_FORCE),
                (Field::PeakExponent, range::PEAK_EXPONENT),
                (Field::ContactTimeS, range::CONTACT_TIME_S),
                (Field::ContactExponent, range::CONTACT_EXPONENT),
                (Field::Restitution, range::RESTITUTION),
            ]
        };
        let values = [
            contact.peak_force(),
            contact.peak_exponent(),
            contact.contact_time_s(),
            contact.contact_exponent(),
            contact.restitution(),
        ];
        check_ranges(place, ranges, &values)?;
        if contact.is_gaussian() && self.restitution != range::DEFAULT_RESTITUTION {
            return Err(TableError::GaussianRestitution { place, value: self.restitution });
        }
        if self.header.reserved.get() != 0 {
            return Err(TableError::NotZero { place, field: Field::Padding });
        }
        check_bank(self.modes, self.gains, 1, |mode| Place::StrikerMode(index, mode))
    }

    /// The striker's name.
    pub fn name(&self) -> &'a str {
        name_str(&self.header.name)
    }

    /// The contact that it makes.
    pub fn contact(&self) -> ContactTable<'a> {
        ContactTable { header: self.header, restitution: self.restitution }
    }

    /// The poles of the striker's own modes.
    pub fn modes(&self) -> &'a [ModeRecord] {
        self.modes
    }

    /// The gains of the striker's own modes.
    pub fn gains(&self) -> &'a [GainRecord] {
        self.gains
    }

    /// Where the numbers come from.
    pub fn source(&self) -> &'a str {
        self.source
    }

    /// The licence of the numbers.
    pub fn licence(&self) -> &'a str {
        self.licence
    }
}

impl ContactTable<'_> {
    /// True if the contact pulse is Gaussian; otherwise it is a Hertz pulse with a restitution.
    pub fn is_gaussian(&self) -> bool {
        self.header.pulse.get() == 1
    }

    /// Peak force m1 at velocity 1, in newtons.
    pub fn peak_force(&self) -> f32 {
        self.header.peak_force.get()
    }

    /// Exponent a of the peak force.
    pub fn peak_exponent(&self) -> f32 {
        self.header.peak_exponent.get()
    }

    /// Contact time τ1 at velocity 1, in seconds.
    pub fn contact_time_s(&self) -> f32 {
        self.header.contact_time_s.get()
    }

    /// Exponent b of the contact time.
    pub fn contact_exponent(&self) -> f32 {
        self.header.contact_exponent.get()
    }

    /// Coefficient of restitution of a Hertz pulse, 0.1 to 1.
    pub fn restitution(&self) -> f32 {
        self.restitution
    }
}

impl<'a> Pad<'a> {
    fn check(&self, index: usize, objects: usize, strikers: usize) -> Result<(), TableError> {
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
        check_count(place, Field::Strikers, self.striker_indices().count(), 1, super::layout::STRIKERS_PER_PAD)?;
        let filled = self.striker_indices().count();
        let ordered = self.record.strikers.iter().skip(filled).all(|index| index.get() == NO_STRIKER);
        let notes_ordered = self.record.midi_notes.iter().skip(self.midi_notes().count()).all(|&note| note == NO_NOTE);
        if !ordered || !notes_ordered || self.record.reserved.get() != 0 {
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

    /// The pad's name.
    pub fn name(&self) -> &'a str {
        name_str(&self.record.name)
    }

    /// Which object it plays, counted from 0.
    pub fn object_index(&self) -> usize {
        usize::from(self.record.object.get())
    }

    /// Its strikers, counted from 0 in the kit, the default one first.
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

    /// T60 in seconds that a choke imposes; 0 for a pad that cannot be choked.
    pub fn choke_t60_s(&self) -> f32 {
        self.record.choke_t60_s.get()
    }

    /// MIDI notes that play it.
    pub fn midi_notes(&self) -> impl Iterator<Item = u8> + use<'a> {
        self.record.midi_notes.iter().copied().take_while(|&note| note != NO_NOTE)
    }
}
