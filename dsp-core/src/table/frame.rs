//! The frame of a kit: header, checksum, directory, and the sections that it leads to.

use zerocopy::byteorder::little_endian::U32;
use zerocopy::{FromBytes, Immutable, KnownLayout, Unaligned};

use super::checksum::checksum;
use super::error::TableError;
use super::layout::{FORMAT_VERSION, FileHeader, MAGIC, SECTION_VERSION, SectionEntry, tag};
use super::place::Place;

/// Checks header and checksum, and gives the directory and the kit's own bytes.
pub(super) fn read_frame(bytes: &[u8]) -> Result<(&[SectionEntry], &[u8]), TableError> {
    let truncated = |needed| TableError::Truncated { needed, found: bytes.len() };
    // The magic first: it tells more about a short file of another kind than its length does.
    let found = *bytes.first_chunk().ok_or(truncated(size_of::<FileHeader>()))?;
    if found != MAGIC {
        return Err(TableError::WrongMagic { found });
    }
    let (header, _) = FileHeader::ref_from_prefix(bytes).map_err(|_| truncated(size_of::<FileHeader>()))?;
    if header.version.get() != FORMAT_VERSION {
        return Err(TableError::NewerVersion { found: header.version.get() });
    }
    let length = header.length.get() as usize;
    let kit = bytes.get(..length).ok_or(truncated(length))?;
    let body = kit
        .get(size_of::<FileHeader>()..)
        .ok_or(TableError::Truncated { needed: size_of::<FileHeader>(), found: length })?;
    let computed = checksum(body);
    if computed != header.crc.get() {
        return Err(TableError::WrongCrc { stored: header.crc.get(), computed });
    }
    if let Some(extra) = bytes.iter().skip(length).position(|&byte| byte != 0xFF) {
        return Err(TableError::TrailingBytes { offset: length + extra });
    }
    let (count, rest) = U32::ref_from_prefix(body)
        .map_err(|_| TableError::Truncated { needed: size_of::<FileHeader>() + 4, found: length })?;
    let (directory, _) = <[SectionEntry]>::ref_from_prefix_with_elems(rest, count.get() as usize).map_err(|_| {
        TableError::Truncated {
            needed: (count.get() as usize)
                .saturating_mul(size_of::<SectionEntry>())
                .saturating_add(size_of::<FileHeader>() + 4),
            found: length,
        }
    })?;
    Ok((directory, kit))
}

/// True if this reader knows the tag.
pub(super) fn is_known(tag: [u8; 4]) -> bool {
    tag::KNOWN.contains(&tag)
}

/// Checks that the sections tile the kit from the directory's end to the kit's end, and that their
/// tags and versions are known.
pub(super) fn check_sections(directory: &[SectionEntry], kit: &[u8]) -> Result<(), TableError> {
    let mut expected_offset = size_of::<FileHeader>() + 4 + size_of_val(directory);
    for (section, entry) in directory.iter().enumerate() {
        let (offset, length) = (entry.offset.get() as usize, entry.length.get() as usize);
        let end = offset.checked_add(length).filter(|&end| end <= kit.len());
        let is_last = section + 1 == directory.len();
        match end {
            Some(end) if offset == expected_offset && length % 4 == 0 && (!is_last || end == kit.len()) => {
                expected_offset = end;
            }
            _ => {
                return Err(TableError::SectionBounds {
                    section,
                    tag: entry.tag,
                    offset,
                    length,
                    expected_offset,
                    kit_length: kit.len(),
                });
            }
        }
        if is_known(entry.tag) {
            if entry.version.get() != SECTION_VERSION {
                return Err(TableError::NewerSection { tag: entry.tag, found: entry.version.get() });
            }
        } else if !entry.tag.first().is_some_and(u8::is_ascii_lowercase) {
            return Err(TableError::UnknownSection { tag: entry.tag });
        }
    }
    Ok(())
}

/// Bodies of all sections with a tag, in the order of the directory.
pub(super) fn sections<'a>(
    directory: &'a [SectionEntry],
    kit: &'a [u8],
    tag: [u8; 4],
) -> impl Iterator<Item = &'a [u8]> + Clone {
    directory.iter().filter(move |entry| entry.tag == tag).filter_map(|entry| {
        let offset = entry.offset.get() as usize;
        kit.get(offset..offset.checked_add(entry.length.get() as usize)?)
    })
}

/// Body of a section that a kit must have exactly once.
pub(super) fn only_section<'a>(
    directory: &'a [SectionEntry],
    kit: &'a [u8],
    tag: [u8; 4],
) -> Result<&'a [u8], TableError> {
    let mut found = sections(directory, kit, tag);
    match (found.next(), found.count()) {
        (Some(body), 0) => Ok(body),
        (first, more) => Err(TableError::SectionCount { tag, found: usize::from(first.is_some()) + more }),
    }
}

/// Body of a section that a kit may have at most once.
pub(super) fn optional_section<'a>(
    directory: &'a [SectionEntry],
    kit: &'a [u8],
    tag: [u8; 4],
) -> Result<Option<&'a [u8]>, TableError> {
    let mut found = sections(directory, kit, tag);
    match (found.next(), found.count()) {
        (body, 0) => Ok(body),
        (_, more) => Err(TableError::SectionCount { tag, found: 1 + more }),
    }
}

/// Record that is all of a body.
pub(super) fn whole<T: FromBytes + KnownLayout + Immutable + Unaligned>(
    body: &[u8],
    place: Place,
) -> Result<&T, TableError> {
    T::ref_from_bytes(body).map_err(|_| TableError::LengthMismatch {
        place,
        expected: size_of::<T>(),
        found: body.len(),
    })
}

/// Record at the beginning of a body, and the bytes behind it.
pub(super) fn head<T: FromBytes + KnownLayout + Immutable + Unaligned>(
    body: &[u8],
    place: Place,
) -> Result<(&T, &[u8]), TableError> {
    T::ref_from_prefix(body).map_err(|_| TableError::LengthMismatch {
        place,
        expected: size_of::<T>(),
        found: body.len(),
    })
}
