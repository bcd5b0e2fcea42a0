//! The `head` section: the volume of a board's headphones.

use zerocopy::byteorder::little_endian::F32;

use super::check::check_ranges;
use super::error::TableError;
use super::frame::whole;
use super::place::{Field, Place};
use super::range;

/// Reads the volume in dB, `None` if there is no section.
pub(super) fn read(body: Option<&[u8]>) -> Result<Option<f32>, TableError> {
    let Some(body) = body else { return Ok(None) };
    let volume_db = whole::<F32>(body, Place::Kit)?.get();
    check_ranges(Place::Kit, &[(Field::HeadphoneDb, range::HEADPHONE_DB)], &[volume_db])?;
    Ok(Some(volume_db))
}
