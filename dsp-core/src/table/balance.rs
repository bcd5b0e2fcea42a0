//! The `bala` section: objects whose acceleration sound is derived.

use zerocopy::FromBytes;
use zerocopy::byteorder::little_endian::U16;

use super::check::check_count;
use super::error::TableError;
use super::frame::head;
use super::place::{Field, Place};

/// The numbers of the objects, in rising order. Checks what concerns the section alone.
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

/// Checks that each number is that of an object of the kit, and above the one before it.
pub(super) fn check(numbers: &[U16], objects: usize) -> Result<(), TableError> {
    let mut next = 0;
    for number in numbers {
        let index = usize::from(number.get());
        if index >= objects {
            return Err(TableError::Dangling { place: Place::Kit, field: Field::Object, index, count: objects });
        }
        check_count(Place::Object(index), Field::Object, index, next, objects.saturating_sub(1))?;
        next = index + 1;
    }
    Ok(())
}
