//! The `bala` section: objects whose acceleration sound is derived.

use zerocopy::FromBytes;
use zerocopy::byteorder::little_endian::U16;

use super::check::{check_count, check_object};
use super::error::TableError;
use super::frame::head;
use super::place::{Field, Place};

/// Numbers of the objects, as the section holds them. [`check`] compares them with the objects of
/// the kit.
pub(super) fn read(body: &[u8]) -> Result<&[U16], TableError> {
    let (count, rest) = head::<U16>(body, Place::Kit)?;
    let count = usize::from(count.get());
    check_count(Place::Kit, Field::Acceleration, count, 1, usize::from(u16::MAX))?;
    let expected = (size_of::<U16>() * (1 + count)).next_multiple_of(4);
    let mismatch = TableError::LengthMismatch { place: Place::Kit, expected, found: body.len() };
    if body.len() != expected {
        return Err(mismatch);
    }
    let (objects, padding) = <[U16]>::ref_from_prefix_with_elems(rest, count).map_err(|_| mismatch)?;
    if padding.iter().any(|&byte| byte != 0) {
        return Err(TableError::NotZero { place: Place::Kit, field: Field::Padding });
    }
    Ok(objects)
}

/// Checks that each number names an object of the kit and is above the number before it.
pub(super) fn check(numbers: &[U16], objects: usize) -> Result<(), TableError> {
    let mut next = 0;
    for number in numbers {
        let index = usize::from(number.get());
        check_object(index, objects, next, Place::Object(index))?;
        next = index + 1;
    }
    Ok(())
}
