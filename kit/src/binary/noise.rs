//! Conversion of residuals, the background and the room to the sections `resi`, `bgnd` and `room`.

use dsp_core::residual::MAX_BANDS;
use dsp_core::table::layout::{BackgroundHeader, ResidualBandRecord, ResidualHeader, RoomBandRecord};
use dsp_core::table::{Field, Place};
use zerocopy::IntoBytes;
use zerocopy::byteorder::little_endian::{F32, U16, U32};

use super::builder::{Build, append};
use crate::content::{Background, Residual, RoomBand};
use crate::error::{Fault, KitError};

pub(super) fn room(bands: &[RoomBand]) -> Vec<u8> {
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

impl Build<'_> {
    pub(super) fn residual(&self, object: usize, residual: &Residual) -> Result<Vec<u8>, KitError> {
        let place = Place::ObjectResidual(object);
        let Residual { seed, edges_hz, weight, decay_db_per_s } = residual;
        let bands = weight.len();
        let header = ResidualHeader {
            // The field holds 16 bits; the reader checks the index itself.
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

    pub(super) fn background(&self, background: &Background) -> Result<Vec<u8>, KitError> {
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

    /// Refuses an array that has another number of numbers than expected.
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
}
