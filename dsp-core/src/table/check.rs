//! Checks of single fields, and of the records that objects and strikers have in common.

use zerocopy::FromBytes;

use super::error::TableError;
use super::layout::{GainRecord, ModeRecord};
use super::place::{Field, Place};
use super::range::{self, Range};

pub(super) type BankView<'a> = (&'a [ModeRecord], &'a [GainRecord], &'a [u8], &'a [u8]);

/// Modes, gains, source and licence behind a section's head. The section must be exactly as long as
/// its head says.
pub(super) fn read_bank<'a>(
    section_bytes: usize,
    rest: &'a [u8],
    modes: usize,
    positions: usize,
    (source_bytes, licence_bytes): (usize, usize),
    place: Place,
) -> Result<BankView<'a>, TableError> {
    // The counts are 16-bit fields that `range` bounds, so that the sum cannot overflow 32 bits.
    let gains = modes * positions;
    let announced = modes * size_of::<ModeRecord>() + gains * size_of::<GainRecord>() + source_bytes + licence_bytes;
    let padded = announced.next_multiple_of(4);
    let mismatch = TableError::LengthMismatch {
        place,
        expected: section_bytes.saturating_sub(rest.len()).saturating_add(padded),
        found: section_bytes,
    };
    if rest.len() != padded {
        return Err(mismatch);
    }
    let (modes, rest) = <[ModeRecord]>::ref_from_prefix_with_elems(rest, modes).map_err(|_| mismatch)?;
    let (gains, rest) = <[GainRecord]>::ref_from_prefix_with_elems(rest, gains).map_err(|_| mismatch)?;
    let (source, rest) = rest.split_at_checked(source_bytes).ok_or(mismatch)?;
    let (licence, padding) = rest.split_at_checked(licence_bytes).ok_or(mismatch)?;
    if padding.iter().any(|&byte| byte != 0) {
        return Err(TableError::NotZero { place, field: Field::Padding });
    }
    Ok((modes, gains, source, licence))
}

/// Text of a source or licence; empty if it is not UTF-8.
pub(super) fn text_str(text: &[u8]) -> &str {
    core::str::from_utf8(text).unwrap_or("")
}

pub(super) fn check_text(text: &[u8], place: Place) -> Result<(), TableError> {
    core::str::from_utf8(text).map(|_| ()).map_err(|_| TableError::BadText { place })
}

pub(super) fn check_bank(
    modes: &[ModeRecord],
    gains: &[GainRecord],
    positions: usize,
    place: impl Fn(usize) -> Place,
) -> Result<(), TableError> {
    for (index, mode) in modes.iter().enumerate() {
        check_range(place(index), Field::FrequencyHz, mode.frequency_hz.get(), range::FREQUENCY_HZ)?;
        check_range(place(index), Field::DecayPerS, mode.decay_per_s.get(), range::DECAY_PER_S)?;
    }
    for (index, gains) in gains.chunks(positions.max(1)).enumerate() {
        for gain in gains {
            check_range(place(index), Field::GainSine, gain.sine.get(), range::GAIN)?;
            check_range(place(index), Field::GainCosine, gain.cosine.get(), range::GAIN)?;
        }
    }
    Ok(())
}

pub(super) fn check_range(place: Place, field: Field, value: f32, allowed: Range) -> Result<(), TableError> {
    if allowed.holds(value) { Ok(()) } else { Err(TableError::OutOfRange { place, field, value, allowed }) }
}

/// Checks the numbers of a place against `fields`, in their order.
#[inline(never)] // a list takes less flash than a call for each number
pub(super) fn check_ranges(place: Place, fields: &'static [(Field, Range)], values: &[f32]) -> Result<(), TableError> {
    fields.iter().zip(values).try_for_each(|(&(field, allowed), &value)| check_range(place, field, value, allowed))
}

pub(super) fn check_count(place: Place, field: Field, value: usize, min: usize, max: usize) -> Result<(), TableError> {
    if (min..=max).contains(&value) { Ok(()) } else { Err(TableError::Count { place, field, value, min, max }) }
}

/// Checks the number of a section's object: sections of one kind stand in the order of their
/// objects, at most one for each. `next` is the lowest number that may follow the section before.
pub(super) fn check_object(object: usize, objects: usize, next: usize, place: Place) -> Result<(), TableError> {
    if object >= objects {
        return Err(TableError::Dangling { place: Place::Kit, field: Field::Object, index: object, count: objects });
    }
    check_count(place, Field::Object, object, next, objects.saturating_sub(1))
}

/// Text of a zero-padded name; empty if it is not UTF-8.
pub(super) fn name_str(name: &[u8]) -> &str {
    let end = name.iter().position(|&byte| byte == 0).unwrap_or(name.len());
    name.get(..end).and_then(|name| core::str::from_utf8(name).ok()).unwrap_or("")
}

pub(super) fn check_name(name: &[u8], place: Place) -> Result<(), TableError> {
    let text = name_str(name);
    let padded_with_zeros = name.iter().skip(text.len()).all(|&byte| byte == 0);
    let allowed = |c: &u8| (b' '..=b'~').contains(c) && *c != b',' && *c != b'"';
    let text = text.as_bytes();
    let is_trimmed = text.first() != Some(&b' ') && text.last() != Some(&b' ');
    if text.is_empty() || !is_trimmed || !text.iter().all(allowed) || !padded_with_zeros {
        return Err(TableError::BadName { place });
    }
    Ok(())
}

pub(super) fn check_distinct<'a>(
    names: impl Iterator<Item = &'a str> + Clone,
    place: impl Fn(usize) -> Place,
) -> Result<(), TableError> {
    for (index, name) in names.clone().enumerate() {
        if names.clone().take(index).any(|earlier| earlier == name) {
            return Err(TableError::DuplicateName { place: place(index) });
        }
    }
    Ok(())
}
