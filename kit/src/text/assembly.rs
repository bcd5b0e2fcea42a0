//! Assembly of one kit from the documents of its files, with the place of each item.

use dsp_core::table::Place;
use toml::Spanned;

use super::document::{Document, Gains, ModeTable, ObjectTable, PadTable, RoomBandTable, StrikerTable};
use super::filters::{BiquadsTable, DynamicFilterTable};
use super::origin::{ItemOrigin, Origins};
use super::pair::Pair;
use super::residual::{BackgroundTable, ResidualTable};
use super::source::{SourceText, UNTITLED};
use super::surface::{SurfaceOfTable, usual_size_m};
use crate::content::{Gain, Kit, Mode, Object, Pad, RoomBand, Striker};
use crate::error::{Fault, KitError};
use crate::surface::ObjectSurface;

/// Kit to which the items of its files are added one by one.
pub(super) struct Assembly {
    kit: Kit,
    origins: Origins,
}

impl Assembly {
    /// Starts with an empty kit that has the name of the main text.
    pub(super) fn new(main: &SourceText, name: Option<&Spanned<String>>) -> Self {
        Self {
            kit: Kit {
                name: name.map_or(UNTITLED, |name| name.get_ref()).to_owned(),
                objects: Vec::new(),
                strikers: Vec::new(),
                pads: Vec::new(),
                background: None,
                room: Vec::new(),
                headphone_db: None,
                surfaces: Vec::new(),
            },
            origins: Origins::new(main, name.map_or(0, |name| name.span().start)),
        }
    }

    /// Adds all items of one file.
    pub(super) fn add(&mut self, source: &SourceText, document: Document) -> Result<(), KitError> {
        self.origins.begin_file(source);
        for surface in document.surface {
            let place = Place::Surface(self.kit.surfaces.len());
            let (offset, surface) = (surface.span().start, surface.into_inner());
            self.origins.surfaces.push(ItemOrigin::new(self.origins.current_file(), offset, &surface.name, &[]));
            self.kit.surfaces.push(surface.read());
            self.refuse_duplicate(place)?;
        }
        for object in document.object {
            let offset = object.span().start;
            self.object(offset, object.into_inner())?;
        }
        for table in document.surface_of {
            self.surface_of(table)?;
        }
        self.kit.headphone_db = document.headphone_db;
        if let Some(background) = document.background {
            let (background, origin) = BackgroundTable::read(background);
            self.kit.background = Some(background);
            self.origins.set_background(origin);
        }
        for band in document.room {
            self.origins.add_room_band(band.span().start);
            let RoomBandTable { from_hz, gain, decay_per_s } = band.into_inner();
            self.kit.room.push(RoomBand { from_hz, gain, decay_per_s });
        }
        for striker in document.striker {
            let offset = striker.span().start;
            self.striker(offset, striker.into_inner())?;
        }
        for pad in document.pad {
            let offset = pad.span().start;
            self.pad(offset, pad.into_inner())?;
        }
        Ok(())
    }

    /// Gives the kit and the places of its items.
    pub(super) fn finish(self) -> (Kit, Origins) {
        (self.kit, self.origins)
    }

    fn object(&mut self, offset: usize, table: ObjectTable) -> Result<(), KitError> {
        let index = self.kit.objects.len();
        self.origins.objects.push(ItemOrigin::new(self.origins.current_file(), offset, &table.name, &table.modes));
        self.kit.objects.push(Object {
            name: table.name.into_inner(),
            source: table.source,
            licence: table.licence,
            reference_force: table.reference_force,
            acceleration: table.acceleration,
            modes: Vec::new(),
            residual: None,
            dynamic_filter: None,
            biquads: None,
            surface: table.surface.map(|surface| {
                let Pair(size_m) = table.size_m.unwrap_or_else(usual_size_m);
                ObjectSurface { surface, size_m, level_db: table.surface_level_db.unwrap_or(0.0) }
            }),
        });
        self.refuse_duplicate(Place::Object(index))?;
        let modes = self.modes(table.modes, |mode| Place::ObjectMode(index, mode))?;
        let residual = table.residual.map(ResidualTable::read);
        let dynamic_filter = match table.dynamic_filter.map(DynamicFilterTable::read) {
            None => None,
            Some((origin, filter)) => {
                self.origins.set_filter(index, origin);
                let mixed = |breakpoint| self.refusal(Place::ObjectBreakpoint(index, breakpoint), Fault::MixedOrder);
                Some(filter.map_err(mixed)?)
            }
        };
        let biquads = table.biquads.map(|table| {
            let (origin, biquads) = BiquadsTable::read(table);
            self.origins.set_biquads(index, origin);
            biquads
        });
        if let Some(object) = self.kit.objects.last_mut() {
            (object.modes, object.dynamic_filter, object.biquads) = (modes, dynamic_filter, biquads);
            if let Some((residual, origin)) = residual {
                object.residual = Some(residual);
                self.origins.set_residual(index, origin);
            }
        }
        Ok(())
    }

    /// Gives an object its surface.
    fn surface_of(&mut self, table: SurfaceOfTable) -> Result<(), KitError> {
        let SurfaceOfTable { object: name, surface, size_m: Pair(size_m), surface_level_db: level_db } = table;
        if let Some(object) = self.kit.objects.iter_mut().find(|object| object.name == name) {
            object.surface = Some(ObjectSurface { surface, size_m, level_db });
            return Ok(());
        }
        let known = self.kit.objects.iter().map(|object| object.name.clone()).collect();
        let fault = Fault::Unknown { key: "object of surface_of", kind: "object", name, known };
        Err(self.refusal(Place::Kit, fault))
    }

    fn striker(&mut self, offset: usize, table: StrikerTable) -> Result<(), KitError> {
        let index = self.kit.strikers.len();
        self.origins.strikers.push(ItemOrigin::new(self.origins.current_file(), offset, &table.name, &table.modes));
        self.kit.strikers.push(Striker {
            name: table.name.into_inner(),
            source: table.source,
            licence: table.licence,
            pulse: table.pulse,
            peak_force: table.peak_force,
            peak_exponent: table.peak_exponent,
            contact_time_s: table.contact_time_s,
            contact_exponent: table.contact_exponent,
            restitution: table.restitution,
            scrape: None,
            roll: None,
            modes: Vec::new(),
        });
        self.refuse_duplicate(Place::Striker(index))?;
        let modes = self.modes(table.modes, |mode| Place::StrikerMode(index, mode))?;
        if let Some(striker) = self.kit.strikers.last_mut() {
            striker.modes = modes;
            let offset = table.scrape.as_ref().map(|scrape| scrape.span().start);
            striker.scrape = table.scrape.map(|scrape| scrape.into_inner().read());
            striker.roll = table.roll.map(|roll| roll.into_inner().read());
            self.origins.set_scrape(index, offset);
        }
        Ok(())
    }

    fn pad(&mut self, offset: usize, table: PadTable) -> Result<(), KitError> {
        let place = Place::Pad(self.kit.pads.len());
        self.origins.pads.push(ItemOrigin::new(self.origins.current_file(), offset, &table.name, &[]));
        self.kit.pads.push(Pad {
            name: table.name.into_inner(),
            object: table.object,
            strikers: table.strikers,
            level_db: table.level_db,
            pan: table.pan,
            striker_weight: table.striker_weight,
            choke_t60_s: table.choke_t60_s,
            midi_notes: Vec::new(),
            note_off: table.note_off,
            trigger: table.trigger.map(|trigger| trigger.settings(self.kit.pads.len())),
        });
        self.refuse_duplicate(place)?;
        let mut midi_notes = Vec::new();
        for note in table.midi_notes {
            midi_notes.push(u8::try_from(note).map_err(|_| self.refusal(place, Fault::MidiNote { note }))?);
        }
        if let Some(pad) = self.kit.pads.last_mut() {
            pad.midi_notes = midi_notes;
        }
        Ok(())
    }

    /// Converts modes with their gains.
    ///
    /// A mode without gains gets gains of 0, at as many positions as the other modes have.
    fn modes(&self, tables: Vec<Spanned<ModeTable>>, place: impl Fn(usize) -> Place) -> Result<Vec<Mode>, KitError> {
        let mut modes = Vec::with_capacity(tables.len());
        let positions = tables
            .iter()
            .find_map(|mode| mode.get_ref().gain_sine.as_ref().or(mode.get_ref().gain_cosine.as_ref()))
            .map_or(1, |gains| gains.0.len());
        for (index, mode) in tables.into_iter().map(Spanned::into_inner).enumerate() {
            let (sine, cosine) = match (mode.gain_sine, mode.gain_cosine) {
                (Some(sine), Some(cosine)) => (sine.0, cosine.0),
                (Some(Gains(sine)), None) => (sine.clone(), vec![0.0; sine.len()]),
                (None, Some(Gains(cosine))) => (vec![0.0; cosine.len()], cosine),
                (None, None) => (vec![0.0; positions], vec![0.0; positions]),
            };
            if sine.len() != cosine.len() {
                let why = "as many gain_cosine as gain_sine";
                let fault = Fault::GainCount { found: cosine.len(), expected: sine.len(), why };
                return Err(self.refusal(place(index), fault));
            }
            modes.push(Mode {
                frequency_hz: mode.frequency_hz,
                decay_per_s: mode.decay_per_s,
                gains: sine.into_iter().zip(cosine).map(|(sine, cosine)| Gain { sine, cosine }).collect(),
            });
        }
        Ok(modes)
    }

    /// Refuses the item at `place`, the last of its kind, if an earlier one has its name.
    ///
    /// The reader of the binary form would refuse it, too, but does not know the places in the
    /// text.
    fn refuse_duplicate(&self, place: Place) -> Result<(), KitError> {
        let (kind, names): (_, Vec<&str>) = match place {
            Place::Object(_) => ("object", self.kit.objects.iter().map(|object| object.name.as_str()).collect()),
            Place::Striker(_) => ("striker", self.kit.strikers.iter().map(|striker| striker.name.as_str()).collect()),
            Place::Surface(_) => ("surface", self.kit.surfaces.iter().map(|surface| surface.name.as_str()).collect()),
            Place::Pad(_) => ("pad", self.kit.pads.iter().map(|pad| pad.name.as_str()).collect()),
            _ => return Ok(()),
        };
        let Some((name, earlier)) = names.split_last() else { return Ok(()) };
        let Some(first) = earlier.iter().position(|earlier| earlier == name) else { return Ok(()) };
        let first = match place {
            Place::Object(_) => Place::Object(first),
            Place::Striker(_) => Place::Striker(first),
            Place::Surface(_) => Place::Surface(first),
            _ => Place::Pad(first),
        };
        Err(KitError::Duplicate {
            at: self.origins.name_of(place),
            kind,
            name: (*name).to_owned(),
            first: self.origins.name_of(first),
        })
    }

    fn refusal(&self, place: Place, fault: Fault) -> KitError {
        self.origins.locate(KitError::item(&self.kit, place, fault))
    }
}
