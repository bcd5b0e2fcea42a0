//! The `room` section.

use zerocopy::FromBytes;

use super::check::{check_count, check_ranges};
use super::error::TableError;
use super::layout::RoomBandRecord;
use super::place::{Field, Place};
use super::range::{self, Range};

/// Bands of a `room` section, from the lowest up. What depends on the sample rate is left
/// unchecked.
pub(super) fn read(body: &[u8]) -> Result<&[RoomBandRecord], TableError> {
    let bands = body.len() / size_of::<RoomBandRecord>();
    let expected = bands * size_of::<RoomBandRecord>();
    let mismatch = TableError::LengthMismatch { place: Place::Room, expected, found: body.len() };
    let bands = <[RoomBandRecord]>::ref_from_bytes(body).map_err(|_| mismatch)?;
    check_count(Place::Room, Field::FromHz, bands.len(), 1, range::ROOM_BANDS)?;
    let mut below = 0.0;
    for (band, record) in bands.iter().enumerate() {
        let (place, from_hz) = (Place::RoomBand(band), record.from_hz.get());
        let ranges = if band == 0 { &LOWEST } else { &HIGHER };
        check_ranges(place, ranges, &[from_hz, record.gain.get(), record.decay_per_s.get()])?;
        if band > 0 && from_hz - below < range::BAND_WIDTH_HZ {
            return Err(TableError::EdgeOrder { place, field: Field::FromHz, below, above: from_hz });
        }
        below = from_hz;
    }
    Ok(bands)
}

/// Ranges of the lowest band, which begins at 0 Hz.
const LOWEST: [(Field, Range); 3] = ranges(Range::new(0.0, 0.0));
/// Ranges of the bands above the lowest.
const HIGHER: [(Field, Range); 3] = ranges(range::EDGE_HZ);

const fn ranges(from_hz: Range) -> [(Field, Range); 3] {
    [(Field::FromHz, from_hz), (Field::Gain, range::ROOM_GAIN), (Field::DecayPerS, range::ROOM_DECAY_PER_S)]
}
