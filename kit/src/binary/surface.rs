//! Sections of surfaces, and of strikers that scrape and roll, and back.

use dsp_core::table::layout::{ObjectSurfaceRecord, RollRecord, ScrapeRecord, SurfaceHeader};
use dsp_core::table::{Field, Kit as TableView, Place, range};
use zerocopy::IntoBytes;
use zerocopy::byteorder::little_endian::{F32, I16, U16, U32};

use super::builder::{Build, append};
use super::slopes::Tables;
use super::{map, slopes};
use crate::content::{Object, Striker};
use crate::error::{Fault, KitError};
use crate::surface::{ObjectSurface, Roll, Scrape, Surface};

/// Least length of a map's side in shortest waves: 8 points of the grid.
const LEAST_WAVES: f64 = 3.0;

impl Build<'_> {
    /// Section of a surface: its heights, and the curvature and slopes that are derived from them.
    pub(super) fn surface(&self, index: usize, surface: &Surface) -> Result<Vec<u8>, KitError> {
        let place = Place::Surface(index);
        let [least, most] = range::HEIGHTS;
        self.count(place, Field::Heights, surface.heights.len(), least, most)?;
        self.count(place, Field::Rows, surface.rows, 1, surface.heights.len() / 2)?;
        if !surface.heights.len().is_multiple_of(surface.rows) {
            let fault = Fault::Uneven { heights: surface.heights.len(), rows: surface.rows };
            return Err(self.fault(place, fault));
        }
        let side_m = surface.rows.min(surface.heights.len() / surface.rows) as f64 * f64::from(surface.step_m);
        let shortest_m = f64::from(surface.shortest_m);
        if surface.rows > 1 && side_m < LEAST_WAVES * shortest_m {
            return Err(self.fault(place, Fault::Narrow { side_m, shortest_m }));
        }
        let limits_m = |curvature_rms_per_m| self.limits_m(surface, curvature_rms_per_m);
        let tables = if surface.rows > 1 { map::tables(surface, limits_m) } else { Tables::new(surface, limits_m) };
        let Some(tables) = tables? else { return Err(self.fault(place, Fault::Flat)) };
        let size = |length: usize| U32::new(length as u32);
        let header = SurfaceHeader {
            name: self.name(place, &surface.name)?,
            step_m: F32::new(surface.step_m),
            unit_m: F32::new(surface.unit_m),
            shortest_m: F32::new(surface.shortest_m),
            point_count: size(surface.heights.len()),
            grid_count: size(tables.grid),
            curvature_rms_per_m: F32::new(tables.curvature_rms_per_m as f32),
            curvature_unit_per_m: F32::new(tables.curvature_unit_per_m as f32),
            alpha_m: tables.alpha_m.map(|alpha_m| F32::new(alpha_m as f32)),
            slope_unit: tables.slope_unit.map(|unit| F32::new(unit as f32)),
            mix_gain: tables.mix_gain.map(|gain| F32::new(gain as f32)),
            mean_per_m: tables.mean_per_m.map(|mean| F32::new(mean as f32)),
            rows: U16::new(surface.rows as u16),
            source_bytes: self.text_bytes(place, "bytes of source", &surface.source)?,
            licence_bytes: self.text_bytes(place, "bytes of licence", &surface.licence)?,
            reserved: U16::ZERO,
        };
        let mut section = header.as_bytes().to_vec();
        tables.map.iter().for_each(|map| append(&mut section, map));
        let numbers = surface.heights.iter().chain(&tables.curvature).chain(tables.octaves.iter().flatten());
        numbers.for_each(|&number| append(&mut section, &I16::new(number)));
        if section.len() > range::SURFACE_BYTES {
            let fault = Fault::TooLarge {
                what: "bytes of a surface (fewer heights, or a longer shortest wave, make it smaller)",
                found: section.len(),
                max: range::SURFACE_BYTES,
            };
            return Err(self.fault(place, fault));
        }
        section.extend_from_slice(surface.source.as_bytes());
        section.extend_from_slice(surface.licence.as_bytes());
        Ok(section)
    }

    /// Least and largest limit α in metres of all strikers that scrape an object with the surface.
    fn limits_m(&self, surface: &Surface, curvature_rms_per_m: f64) -> Result<[f64; 2], KitError> {
        let usual = [1.0 / curvature_rms_per_m, 5.0 / curvature_rms_per_m];
        let mut all: Option<[f64; 2]> = None;
        for pad in &self.kit.pads {
            let object = self.kit.objects.iter().find(|object| object.name == pad.object);
            let is_here =
                object.and_then(|object| object.surface.as_ref()).is_some_and(|at| at.surface == surface.name);
            if !is_here {
                continue;
            }
            let strikers =
                self.kit.strikers.iter().enumerate().filter(|(_, striker)| pad.strikers.contains(&striker.name));
            for (index, scrape) in strikers.filter_map(|(index, striker)| Some((index, striker.scrape.as_ref()?))) {
                let own = [scrape.alpha_min_m, scrape.alpha_max_m].map(|own| own.filter(|&alpha_m| alpha_m > 0.0));
                let [least_m, most_m] = [0, 1].map(|end| own[end].map_or(usual[end], f64::from));
                if least_m > most_m {
                    return Err(self.fault(Place::StrikerScrape(index), upside_down(own, usual, &surface.name)));
                }
                let [least, most] = all.unwrap_or([least_m, most_m]);
                all = Some([least.min(least_m), most.max(most_m)]);
            }
        }
        let [least, most] = all.unwrap_or(usual);
        // Three limits must differ.
        Ok([least, most.max(least * 1.02)])
    }

    /// Section of the objects' surfaces.
    pub(super) fn object_surfaces(&self) -> Result<Vec<u8>, KitError> {
        let mut section = Vec::new();
        for (index, object) in self.kit.objects.iter().enumerate() {
            let Some(ObjectSurface { surface, size_m, level_db }) = &object.surface else { continue };
            let place = Place::Object(index);
            let names = self.kit.surfaces.iter().map(|surface| surface.name.as_str());
            let record = ObjectSurfaceRecord {
                object: self.count(place, Field::Object, index, 0, usize::from(u16::MAX))?,
                surface: self.reference(place, ("surface", "surface"), surface, names)?,
                size_m: size_m.map(F32::new),
                level_db: F32::new(*level_db),
            };
            append(&mut section, &record);
        }
        Ok(section)
    }

    /// Sections of the strikers that scrape and of those that roll.
    pub(super) fn scrapes_and_rolls(&self) -> Result<[Vec<u8>; 2], KitError> {
        let (mut scrapes, mut rolls) = (Vec::new(), Vec::new());
        for (index, striker) in self.kit.strikers.iter().enumerate() {
            let number = self.count(Place::Striker(index), Field::Strikers, index, 0, usize::from(u16::MAX))?;
            if let Some(scrape) = &striker.scrape {
                append(&mut scrapes, &scrape_record(number, scrape));
            }
            if let Some(roll) = &striker.roll {
                append(&mut rolls, &roll_record(number, roll));
            }
        }
        Ok([scrapes, rolls])
    }
}

impl Surface {
    /// Largest curvature of the surface in any direction, 1/m; between heights it is taken at three
    /// places, in a map at one.
    pub fn largest_curvature_per_m(&self) -> f64 {
        if self.rows > 1 { map::largest_curvature_per_m(self) } else { slopes::largest_curvature_per_m(self) }
    }
}

/// Fault of a scraper's own limits in metres, where the first of both limits lies above the second.
fn upside_down(own: [Option<f32>; 2], usual_m: [f64; 2], surface: &str) -> Fault {
    let surface = surface.to_owned();
    let [least, most] = ["alpha_min_m", "alpha_max_m"];
    match own {
        [Some(least_m), Some(most_m)] => Fault::Limits { least_m, most_m },
        [Some(own_m), None] => {
            Fault::LimitOnSurface { key: least, own_m, bound: "most", other: most, usual_m: usual_m[1], surface }
        }
        [None, own_m] => Fault::LimitOnSurface {
            key: most,
            own_m: own_m.unwrap_or(0.0),
            bound: "least",
            other: least,
            usual_m: usual_m[0],
            surface,
        },
    }
}

fn scrape_record(striker: U16, scrape: &Scrape) -> ScrapeRecord {
    ScrapeRecord {
        striker,
        reserved: U16::ZERO,
        mass_kg: F32::new(scrape.mass_kg),
        slope_gain: F32::new(scrape.slope_gain),
        slope_exponent: F32::new(scrape.slope_exponent),
        alpha_min_m: F32::new(scrape.alpha_min_m.unwrap_or(0.0)),
        alpha_max_m: F32::new(scrape.alpha_max_m.unwrap_or(0.0)),
        alpha_exponent: F32::new(scrape.alpha_exponent),
        smoothing_s: F32::new(scrape.smoothing_s),
        tilt_rad: F32::new(scrape.tilt_rad),
        friction: F32::new(scrape.friction),
    }
}

fn roll_record(striker: U16, roll: &Roll) -> RollRecord {
    RollRecord {
        striker,
        reserved: U16::ZERO,
        radius_m: F32::new(roll.radius_m),
        offset_m: F32::new(roll.offset_m),
        stiffness: F32::new(roll.stiffness),
        dissipation: F32::new(roll.dissipation),
        modulation: F32::new(roll.modulation),
        slip: F32::new(roll.slip),
    }
}

/// Reads the surfaces of a checked view, and adds theirs to objects and strikers.
pub(super) fn read(view: &TableView<'_>, objects: &mut [Object], strikers: &mut [Striker]) -> Vec<Surface> {
    let surfaces: Vec<Surface> = view
        .surfaces()
        .map(|surface| Surface {
            name: surface.name().to_owned(),
            source: surface.source().to_owned(),
            licence: surface.licence().to_owned(),
            step_m: surface.step_m(),
            rows: surface.rows(),
            unit_m: surface.unit_m(),
            shortest_m: surface.shortest_m(),
            heights: surface.heights().iter().map(|height| height.get()).collect(),
        })
        .collect();
    for record in view.object_surfaces() {
        let surface = surfaces.get(usize::from(record.surface.get()));
        if let (Some(object), Some(surface)) = (objects.get_mut(usize::from(record.object.get())), surface) {
            let size_m = record.size_m.map(|size_m| size_m.get());
            let level_db = record.level_db.get();
            object.surface = Some(ObjectSurface { surface: surface.name.clone(), size_m, level_db });
        }
    }
    let given = |alpha_m: F32| Some(alpha_m.get()).filter(|&alpha_m| alpha_m > 0.0);
    for record in view.scrapes() {
        if let Some(striker) = strikers.get_mut(usize::from(record.striker.get())) {
            striker.scrape = Some(Scrape {
                mass_kg: record.mass_kg.get(),
                slope_gain: record.slope_gain.get(),
                slope_exponent: record.slope_exponent.get(),
                alpha_min_m: given(record.alpha_min_m),
                alpha_max_m: given(record.alpha_max_m),
                alpha_exponent: record.alpha_exponent.get(),
                smoothing_s: record.smoothing_s.get(),
                tilt_rad: record.tilt_rad.get(),
                friction: record.friction.get(),
            });
        }
    }
    for record in view.rolls() {
        if let Some(striker) = strikers.get_mut(usize::from(record.striker.get())) {
            striker.roll = Some(Roll {
                radius_m: record.radius_m.get(),
                offset_m: record.offset_m.get(),
                stiffness: record.stiffness.get(),
                dissipation: record.dissipation.get(),
                modulation: record.modulation.get(),
                slip: record.slip.get(),
            });
        }
    }
    surfaces
}
