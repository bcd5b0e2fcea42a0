//! Conversion of a kit to its binary form.

use dsp_core::SampleRate;
use dsp_core::radiation::balance;
use dsp_core::table::layout::{
    GainRecord, MIDI_NOTES_PER_PAD, MetaRecord, ModeRecord, NO_INPUT, NO_NOTE, NO_STRIKER, ObjectHeader, PadRecord,
    STRIKERS_PER_PAD, StrikerHeader, TriggerRecord, tag,
};
use dsp_core::table::{Field, Place, range};
use dsp_core::trigger::{Mode as TriggerMode, Settings};
use zerocopy::IntoBytes;
use zerocopy::byteorder::little_endian::{F32, U16, U32};

use super::builder::{Build, append};
use super::filters;
use super::noise::room;
use crate::content::{Acceleration, Kit, Mode, NoteOff, Object, Pad, Pulse, Striker};
use crate::error::{Fault, KitError};

/// Builds the binary form of a kit. Equal kits give equal bytes.
///
/// Its sections are, in this order: `META`; one `OBJT` per object; one `STRK` per striker; `PADS`;
/// `trig` if a pad has its own trigger settings; one `resi` per residual; `bgnd` and `room` if the
/// kit has a background or a room; one `dynf` per dynamic filter; one `biqd` per biquad bank;
/// `rest` if a striker's restitution is not the default; `bala` if an object's acceleration sound
/// is derived; `head` if the kit gives a volume of the headphones; one `surf` per surface; `osur`,
/// `scrp` and `roll` if objects have surfaces and strikers scrape or roll.
///
/// # Errors
/// [`KitError::Item`] for a number, name or text that the form cannot hold (nothing is ever cut
/// off), and for all that [`dsp_core::table::Kit`] refuses in the result.
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
    if let Some(volume_db) = kit.headphone_db {
        sections.push((tag::HEADPHONE, F32::new(volume_db).as_bytes().to_vec()));
    }
    for (index, surface) in kit.surfaces.iter().enumerate() {
        sections.push((tag::SURFACE, build.surface(index, surface)?));
    }
    let [scrapes, rolls] = build.scrapes_and_rolls()?;
    let records = [(tag::OBJECT_SURFACES, build.object_surfaces()?), (tag::SCRAPE, scrapes), (tag::ROLL, rolls)];
    sections.extend(records.into_iter().filter(|(_, records)| !records.is_empty()));
    let bytes = build.frame(&sections)?;
    filters::parse(&bytes).map_err(|error| KitError::from_table(kit, error))?;
    Ok(bytes)
}

/// Factor α of a balanced object for readers that cannot derive it: that at 48 kHz and at the first
/// position, clamped to the range of a table's number.
///
/// Invalid modes, which the reader refuses later, give 0.
fn fallback(modes: &[ModeRecord], gains: &[GainRecord], positions: usize) -> f32 {
    let alpha = balance(modes, gains, positions, SampleRate::HZ_48000) as f32;
    if alpha.is_nan() { 0.0 } else { alpha.clamp(range::ACCELERATION.min, range::ACCELERATION.max) }
}

impl Build<'_> {
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

    /// Section with the number of objects whose acceleration sound is derived, and their indices;
    /// empty if there is no such object.
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
            // 255 would read as "no note", which the reader cannot tell from a wrong note.
            if note == NO_NOTE {
                return Err(self.fault(place, Fault::MidiNote { note: i64::from(note) }));
            }
            *slot = note;
        }
        let names = self.kit.objects.iter().map(|object| object.name.as_str());
        Ok(PadRecord {
            name: self.name(place, &pad.name)?,
            object: self.reference(place, ("object", "object"), &pad.object, names)?,
            note_off: u8::from(pad.note_off == NoteOff::Choke),
            reserved: 0,
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
        // 255 would read as "no input", which the reader cannot tell from a wrong input.
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
}

fn append_texts(section: &mut Vec<u8>, source: &str, licence: &str) {
    section.extend_from_slice(source.as_bytes());
    section.extend_from_slice(licence.as_bytes());
}
