//! From a kit to its bytes.

use dsp_core::SampleRate;
use dsp_core::radiation::balance;
use dsp_core::residual::MAX_BANDS;
use dsp_core::table::layout::{
    BackgroundHeader, FORMAT_VERSION, FileHeader, GainRecord, MAGIC, MIDI_NOTES_PER_PAD, MetaRecord, ModeRecord,
    NAME_BYTES, NO_INPUT, NO_NOTE, NO_STRIKER, ObjectHeader, PadRecord, ResidualBandRecord, ResidualHeader,
    RoomBandRecord, SECTION_VERSION, STRIKERS_PER_PAD, SectionEntry, StrikerHeader, TriggerRecord, tag,
};
use dsp_core::table::{Field, Place, TableError, checksum, range};
use dsp_core::trigger::{Mode as TriggerMode, Settings};
use zerocopy::byteorder::little_endian::{F32, U16, U32};
use zerocopy::{Immutable, IntoBytes};

use super::filters;
use crate::error::Fault;
use crate::{Acceleration, Background, Kit, KitError, Mode, Object, Pad, Pulse, Residual, RoomBand, Striker};

/// Builds the binary form: sections `META`, `OBJT` an object, `STRK` a striker, `PADS`, `trig` where
/// a pad says how it is triggered, `resi` an object with a residual, `bgnd` and `room` where there is a background or a room, `dynf` an object with a
/// dynamic filter, `biqd` an object with a biquad bank, `rest` where a striker's restitution is not the default, and `bala` where an object's acceleration
/// sound is derived, in this order. The same kit gives the same bytes.
///
/// # Errors
/// [`KitError::Item`] for what the form cannot hold (nothing is ever cut off) and for whatever [`dsp_core::table::Kit`] refuses in the result.
pub fn build(kit: &Kit) -> Result<Vec<u8>, KitError> {
    let build = Build { kit };
    let mut sections = vec![(tag::META, build.meta()?)];
    for (index, object) in kit.objects.iter().enumerate() {
        sections.push((tag::OBJECT, build.object(index, object)?));
    }
    for (index, striker) in kit.strikers.iter().enumerate() {
        sections.push((tag::STRIKER, build.striker(index, striker)?));
    }
    let mut pads = Vec::new();
    for (index, pad) in kit.pads.iter().enumerate() {
        append(&mut pads, &build.pad(index, pad)?);
    }
    sections.push((tag::PADS, pads));
    let mut triggers = Vec::new();
    for (index, pad) in kit.pads.iter().enumerate() {
        if let Some(settings) = &pad.trigger {
            append(&mut triggers, &build.trigger(index, settings)?);
        }
    }
    if !triggers.is_empty() {
        sections.push((tag::TRIGGER, triggers));
    }
    for (index, object) in kit.objects.iter().enumerate() {
        if let Some(residual) = &object.residual {
            sections.push((tag::RESIDUAL, build.residual(index, residual)?));
        }
    }
    if let Some(background) = &kit.background {
        sections.push((tag::BACKGROUND, build.background(background)?));
    }
    if !kit.room.is_empty() {
        sections.push((tag::ROOM, room(&kit.room)));
    }
    for (index, object) in kit.objects.iter().enumerate() {
        if let Some(filter) = &object.dynamic_filter {
            sections.push((tag::DYNAMIC_FILTER, build.dynamic_filter(index, filter)?));
        }
    }
    for (index, object) in kit.objects.iter().enumerate() {
        if let Some(biquads) = &object.biquads {
            sections.push((tag::BIQUADS, build.biquads(index, biquads)?));
        }
    }
    if kit.strikers.iter().any(|striker| striker.restitution != Striker::DEFAULT_RESTITUTION) {
        let mut restitutions = Vec::new();
        kit.strikers.iter().for_each(|striker| append(&mut restitutions, &F32::new(striker.restitution)));
        sections.push((tag::RESTITUTION, restitutions));
    }
    let balanced = build.balanced()?;
    if !balanced.is_empty() {
        sections.push((tag::BALANCE, balanced));
    }
    let bytes = build.frame(&sections)?;
    filters::parse(&bytes).map_err(|error| KitError::from_table(kit, error))?;
    Ok(bytes)
}

/// The α of a balanced object for readers that cannot derive it: that at 48 kHz and at the first position, within the
/// range of a table's number. Modes that the reader of tables refuses have none.
fn fallback(modes: &[ModeRecord], gains: &[GainRecord], positions: usize) -> f32 {
    let alpha = balance(modes, gains, positions, SampleRate::HZ_48000) as f32;
    if alpha.is_nan() { 0.0 } else { alpha.clamp(range::ACCELERATION.min, range::ACCELERATION.max) }
}

fn room(bands: &[RoomBand]) -> Vec<u8> {
    let mut section = Vec::new();
    for band in bands {
        let record = RoomBandRecord {
            from_hz: F32::new(band.from_hz),
            gain: F32::new(band.gain),
            decay_per_s: F32::new(band.decay_per_s),
        };
        append(&mut section, &record);
    }
    section
}

pub(super) struct Build<'a> {
    kit: &'a Kit,
}

impl Build<'_> {
    pub(super) fn fault(&self, place: Place, fault: Fault) -> KitError {
        KitError::item(self.kit, place, fault)
    }

    fn meta(&self) -> Result<Vec<u8>, KitError> {
        let record = MetaRecord { name: self.name(Place::Kit, &self.kit.name)? };
        Ok(record.as_bytes().to_vec())
    }

    fn object(&self, index: usize, object: &Object) -> Result<Vec<u8>, KitError> {
        let place = Place::Object(index);
        let positions = object.position_count();
        let header = ObjectHeader {
            name: self.name(place, &object.name)?,
            reference_force: F32::new(object.reference_force),
            acceleration: F32::ZERO,
            mode_count: self.count(place, Field::Modes, object.modes.len(), 0, range::MODES_PER_BANK)?,
            position_count: self.count(place, Field::Positions, positions, 1, range::POSITIONS)?,
            source_bytes: self.text_bytes(place, "bytes of source", &object.source)?,
            licence_bytes: self.text_bytes(place, "bytes of licence", &object.licence)?,
        };
        let why = "as many as the object's first mode has";
        let (modes, gains) = self.modes(&object.modes, (positions, why), |mode| Place::ObjectMode(index, mode))?;
        let acceleration = match object.acceleration {
            Acceleration::Factor(factor) => factor,
            Acceleration::Balance => fallback(&modes, &gains, positions),
        };
        let header = ObjectHeader { acceleration: F32::new(acceleration), ..header };
        let mut section = header.as_bytes().to_vec();
        section.extend_from_slice(modes.as_bytes());
        section.extend_from_slice(gains.as_bytes());
        append_texts(&mut section, &object.source, &object.licence);
        Ok(section)
    }

    /// The numbers of the objects whose acceleration sound is derived; nothing where none is.
    fn balanced(&self) -> Result<Vec<u8>, KitError> {
        let objects = self.kit.objects.iter().enumerate();
        let balanced: Vec<usize> = objects
            .filter(|(_, object)| object.acceleration == Acceleration::Balance)
            .map(|(index, _)| index)
            .collect();
        let mut section = Vec::new();
        if !balanced.is_empty() {
            append(
                &mut section,
                &self.count(Place::Kit, Field::Acceleration, balanced.len(), 1, usize::from(u16::MAX))?,
            );
        }
        for index in balanced {
            append(&mut section, &self.count(Place::Object(index), Field::Object, index, 0, usize::from(u16::MAX))?);
        }
        Ok(section)
    }

    fn striker(&self, index: usize, striker: &Striker) -> Result<Vec<u8>, KitError> {
        let place = Place::Striker(index);
        let header = StrikerHeader {
            name: self.name(place, &striker.name)?,
            pulse: U32::new(match striker.pulse {
                Pulse::Hertz => 0,
                Pulse::Gaussian => 1,
            }),
            peak_force: F32::new(striker.peak_force),
            peak_exponent: F32::new(striker.peak_exponent),
            contact_time_s: F32::new(striker.contact_time_s),
            contact_exponent: F32::new(striker.contact_exponent),
            mode_count: self.count(place, Field::Modes, striker.modes.len(), 0, range::MODES_PER_BANK)?,
            source_bytes: self.text_bytes(place, "bytes of source", &striker.source)?,
            licence_bytes: self.text_bytes(place, "bytes of licence", &striker.licence)?,
            reserved: U16::ZERO,
        };
        let why = "since a striker has one position";
        let (modes, gains) = self.modes(&striker.modes, (1, why), |mode| Place::StrikerMode(index, mode))?;
        let mut section = header.as_bytes().to_vec();
        section.extend_from_slice(modes.as_bytes());
        section.extend_from_slice(gains.as_bytes());
        append_texts(&mut section, &striker.source, &striker.licence);
        Ok(section)
    }

    fn modes(
        &self,
        modes: &[Mode],
        (positions, why): (usize, &'static str),
        place: impl Fn(usize) -> Place,
    ) -> Result<(Vec<ModeRecord>, Vec<GainRecord>), KitError> {
        for (index, mode) in modes.iter().enumerate() {
            if mode.gains.len() != positions {
                let fault = Fault::GainCount { found: mode.gains.len(), expected: positions, why };
                return Err(self.fault(place(index), fault));
            }
        }
        let records = modes.iter().map(|mode| ModeRecord {
            frequency_hz: F32::new(mode.frequency_hz),
            decay_per_s: F32::new(mode.decay_per_s),
        });
        let gains = modes.iter().flat_map(|mode| &mode.gains);
        let gains = gains.map(|gain| GainRecord { sine: F32::new(gain.sine), cosine: F32::new(gain.cosine) });
        Ok((records.collect(), gains.collect()))
    }

    fn pad(&self, index: usize, pad: &Pad) -> Result<PadRecord, KitError> {
        let place = Place::Pad(index);
        let mut strikers = [U16::new(NO_STRIKER); STRIKERS_PER_PAD];
        self.count(place, Field::Strikers, pad.strikers.len(), 1, STRIKERS_PER_PAD)?;
        for (slot, name) in strikers.iter_mut().zip(&pad.strikers) {
            let names = self.kit.strikers.iter().map(|striker| striker.name.as_str());
            *slot = self.reference(place, ("strikers", "striker"), name, names)?;
        }
        let mut midi_notes = [NO_NOTE; MIDI_NOTES_PER_PAD];
        self.count(place, Field::MidiNotes, pad.midi_notes.len(), 0, MIDI_NOTES_PER_PAD)?;
        for (slot, &note) in midi_notes.iter_mut().zip(&pad.midi_notes) {
            // 255 would read as "no note"; the table reader cannot tell.
            if note == NO_NOTE {
                return Err(self.fault(place, Fault::MidiNote { note: i64::from(note) }));
            }
            *slot = note;
        }
        let names = self.kit.objects.iter().map(|object| object.name.as_str());
        Ok(PadRecord {
            name: self.name(place, &pad.name)?,
            object: self.reference(place, ("object", "object"), &pad.object, names)?,
            reserved: U16::ZERO,
            strikers,
            level_db: F32::new(pad.level_db),
            pan: F32::new(pad.pan),
            striker_weight: F32::new(pad.striker_weight),
            choke_t60_s: F32::new(pad.choke_t60_s),
            midi_notes,
        })
    }

    fn trigger(&self, pad: usize, settings: &Settings) -> Result<TriggerRecord, KitError> {
        let place = Place::Pad(pad);
        // 255 would read as "none"; the table reader cannot tell.
        let input = |field, input: Option<u8>, last| match input {
            Some(input) => self.count(place, field, input.into(), 0, last).map(|_| input),
            None => Ok(NO_INPUT),
        };
        Ok(TriggerRecord {
            pad: self.count(place, Field::TriggerPad, pad, 0, usize::from(u8::MAX))?,
            mode: match settings.mode {
                TriggerMode::Velocity => 0,
                TriggerMode::Direct => 1,
                TriggerMode::Off => 2,
            },
            channel: input(Field::Channel, Some(settings.channel), range::LAST_CHANNEL)?,
            rim_channel: input(Field::RimChannel, settings.rim_channel, range::LAST_CHANNEL)?,
            rim_striker: settings.rim_striker,
            button: input(Field::Button, settings.button, range::LAST_BUTTON)?,
            choke_button: input(Field::ChokeButton, settings.choke_button, range::LAST_BUTTON)?,
            threshold: F32::new(settings.threshold),
            scan_time_s: F32::new(settings.scan_time_s),
            mask_time_s: F32::new(settings.mask_time_s),
            mask_decay_per_s: F32::new(settings.mask_decay_per_s),
            full_scale: F32::new(settings.full_scale),
            velocity_exponent: F32::new(settings.velocity_exponent),
            crosstalk_db: F32::new(settings.crosstalk_db),
            rim_db: F32::new(settings.rim_db),
            direct_gain: F32::new(settings.direct_gain),
            button_velocity: F32::new(settings.button_velocity),
        })
    }

    fn residual(&self, object: usize, residual: &Residual) -> Result<Vec<u8>, KitError> {
        let place = Place::ObjectResidual(object);
        let Residual { seed, edges_hz, weight, decay_db_per_s } = residual;
        let bands = weight.len();
        let header = ResidualHeader {
            // One less than 16 bits hold; the reader says what it allows.
            object: self.count(place, Field::Object, object, 0, usize::from(u16::MAX))?,
            band_count: self.count(place, Field::Weight, bands, 1, MAX_BANDS)?,
            seed: U32::new(*seed),
        };
        self.same_count(place, ("edges_hz", edges_hz.len()), (bands + 1, "one more than weight has"))?;
        self.same_count(place, ("decay_db_per_s", decay_db_per_s.len()), (bands, "as many as weight has"))?;
        let mut section = header.as_bytes().to_vec();
        edges_hz.iter().for_each(|&edge| append(&mut section, &F32::new(edge)));
        for (&weight, &decay) in weight.iter().zip(decay_db_per_s) {
            append(&mut section, &ResidualBandRecord { weight: F32::new(weight), decay_db_per_s: F32::new(decay) });
        }
        Ok(section)
    }

    fn background(&self, background: &Background) -> Result<Vec<u8>, KitError> {
        let place = Place::Background;
        let Background { seed, edges_hz, weight } = background;
        let bands = weight.len();
        let header = BackgroundHeader {
            band_count: self.count(place, Field::Weight, bands, 1, MAX_BANDS)?,
            reserved: U16::ZERO,
            seed: U32::new(*seed),
        };
        self.same_count(place, ("edges_hz", edges_hz.len()), (bands + 1, "one more than weight has"))?;
        let mut section = header.as_bytes().to_vec();
        edges_hz.iter().chain(weight).for_each(|&number| append(&mut section, &F32::new(number)));
        Ok(section)
    }

    fn same_count(
        &self,
        place: Place,
        (key, found): (&'static str, usize),
        (expected, why): (usize, &'static str),
    ) -> Result<(), KitError> {
        if found == expected {
            return Ok(());
        }
        Err(self.fault(place, Fault::NumberCount { key, found, expected, why }))
    }

    /// Header and directory in front of the sections, each filled up to 4 bytes.
    fn frame(&self, sections: &[([u8; 4], Vec<u8>)]) -> Result<Vec<u8>, KitError> {
        let offset_and_length = |value: usize| {
            u32::try_from(value).map(U32::new).map_err(|_| {
                let fault = Fault::TooLarge { what: "bytes of the kit", found: value, max: u32::MAX as usize };
                self.fault(Place::Kit, fault)
            })
        };
        let mut offset = size_of::<FileHeader>() + 4 + size_of::<SectionEntry>() * sections.len();
        let mut body = Vec::new();
        append(&mut body, &offset_and_length(sections.len())?);
        for (tag, section) in sections {
            let length = section.len().next_multiple_of(4);
            let entry = SectionEntry {
                tag: *tag,
                version: U32::new(SECTION_VERSION),
                offset: offset_and_length(offset)?,
                length: offset_and_length(length)?,
            };
            append(&mut body, &entry);
            offset += length;
        }
        for (_, section) in sections {
            body.extend_from_slice(section);
            body.resize(body.len().next_multiple_of(4), 0);
        }
        let header = FileHeader {
            magic: MAGIC,
            version: U32::new(FORMAT_VERSION),
            length: offset_and_length(offset)?,
            crc: U32::new(checksum(&body)),
        };
        let mut bytes = header.as_bytes().to_vec();
        bytes.append(&mut body);
        Ok(bytes)
    }

    /// A name padded with zeros. One that does not fit, or would lose zeros at its end, is refused here; the rest the reader judges.
    fn name(&self, place: Place, name: &str) -> Result<[u8; NAME_BYTES], KitError> {
        let mut padded = [0; NAME_BYTES];
        match padded.get_mut(..name.len()) {
            Some(start) if !name.contains('\0') => start.copy_from_slice(name.as_bytes()),
            _ => return Err(self.fault(place, Fault::Table(TableError::BadName { place }))),
        }
        Ok(padded)
    }

    pub(super) fn count(
        &self,
        place: Place,
        field: Field,
        value: usize,
        min: usize,
        max: usize,
    ) -> Result<U16, KitError> {
        match u16::try_from(value) {
            Ok(count) if (min..=max).contains(&value) => Ok(U16::new(count)),
            _ => Err(self.fault(place, Fault::Table(TableError::Count { place, field, value, min, max }))),
        }
    }

    fn text_bytes(&self, place: Place, what: &'static str, text: &str) -> Result<U16, KitError> {
        u16::try_from(text.len())
            .map(U16::new)
            .map_err(|_| self.fault(place, Fault::TooLarge { what, found: text.len(), max: usize::from(u16::MAX) }))
    }

    /// The index of the object or striker of a name.
    fn reference<'n>(
        &self,
        place: Place,
        (key, kind): (&'static str, &'static str),
        name: &str,
        names: impl Iterator<Item = &'n str> + Clone,
    ) -> Result<U16, KitError> {
        let Some(index) = names.clone().position(|known| known == name) else {
            let known = names.map(str::to_owned).collect();
            return Err(self.fault(place, Fault::Unknown { key, kind, name: name.to_owned(), known }));
        };
        // One less than 16 bits hold: the largest stands for "no striker".
        let max = usize::from(NO_STRIKER) - 1;
        match u16::try_from(index) {
            Ok(number) if index <= max => Ok(U16::new(number)),
            _ => {
                Err(self
                    .fault(place, Fault::TooLarge { what: "number of the item that a pad names", found: index, max }))
            }
        }
    }
}

pub(super) fn append(bytes: &mut Vec<u8>, record: &(impl IntoBytes + Immutable)) {
    bytes.extend_from_slice(record.as_bytes());
}

fn append_texts(section: &mut Vec<u8>, source: &str, licence: &str) {
    section.extend_from_slice(source.as_bytes());
    section.extend_from_slice(licence.as_bytes());
}
