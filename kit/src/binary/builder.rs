//! Parts that all sections of the binary form share: counts, names, references, and the frame.

use dsp_core::table::layout::{
    FORMAT_VERSION, FileHeader, MAGIC, NAME_BYTES, NO_STRIKER, SECTION_VERSION, SectionEntry,
};
use dsp_core::table::{Field, Place, TableError, checksum};
use zerocopy::byteorder::little_endian::{U16, U32};
use zerocopy::{Immutable, IntoBytes};

use crate::content::Kit;
use crate::error::{Fault, KitError};
use crate::name::item_name;

/// Kit whose sections are built.
pub(super) struct Build<'a> {
    pub(super) kit: &'a Kit,
}

impl Build<'_> {
    /// Refusal of the item at `place`.
    pub(super) fn fault(&self, place: Place, fault: Fault) -> KitError {
        KitError::item(self.kit, place, fault)
    }

    /// Bytes of the whole kit: header, directory, and the sections, each filled up to 4 bytes.
    pub(super) fn frame(&self, sections: &[([u8; 4], Vec<u8>)]) -> Result<Vec<u8>, KitError> {
        let offset_and_length = |value: usize| {
            u32::try_from(value).map(U32::new).map_err(|_| {
                let fault = Fault::TooLarge { what: "bytes of the kit", found: value, max: u32::MAX as usize };
                self.fault(Place::Kit, fault)
            })
        };
        let mut offset = size_of::<FileHeader>() + 4 + size_of::<SectionEntry>() * sections.len();
        let mut body = Vec::new();
        append(&mut body, &offset_and_length(sections.len())?);
        for (tag, section) in sections {
            let length = section.len().next_multiple_of(4);
            let entry = SectionEntry {
                tag: *tag,
                version: U32::new(SECTION_VERSION),
                offset: offset_and_length(offset)?,
                length: offset_and_length(length)?,
            };
            append(&mut body, &entry);
            offset += length;
        }
        for (_, section) in sections {
            body.extend_from_slice(section);
            body.resize(body.len().next_multiple_of(4), 0);
        }
        let header = FileHeader {
            magic: MAGIC,
            version: U32::new(FORMAT_VERSION),
            length: offset_and_length(offset)?,
            crc: U32::new(checksum(&body)),
        };
        let mut bytes = header.as_bytes().to_vec();
        bytes.append(&mut body);
        Ok(bytes)
    }

    /// Bytes of a name, padded with zeros.
    ///
    /// A name that is too long or holds a zero is refused here, because the bytes would not show
    /// it. All other rules of names are checked here and by the reader. Without the check here,
    /// messages would suggest names that no kit may have.
    pub(super) fn name(&self, place: Place, name: &str) -> Result<[u8; NAME_BYTES], KitError> {
        let mut padded = [0; NAME_BYTES];
        match padded.get_mut(..name.len()) {
            Some(start) if item_name(name, "") == name => start.copy_from_slice(name.as_bytes()),
            _ => return Err(self.fault(place, Fault::Table(TableError::BadName { place }))),
        }
        Ok(padded)
    }

    /// A count or index as 16 bits, if it lies from `min` to `max`.
    pub(super) fn count(
        &self,
        place: Place,
        field: Field,
        value: usize,
        min: usize,
        max: usize,
    ) -> Result<U16, KitError> {
        match u16::try_from(value) {
            Ok(count) if (min..=max).contains(&value) => Ok(U16::new(count)),
            _ => Err(self.fault(place, Fault::Table(TableError::Count { place, field, value, min, max }))),
        }
    }

    /// Number of bytes of a text, named `what` in a refusal.
    pub(super) fn text_bytes(&self, place: Place, what: &'static str, text: &str) -> Result<U16, KitError> {
        u16::try_from(text.len())
            .map(U16::new)
            .map_err(|_| self.fault(place, Fault::TooLarge { what, found: text.len(), max: usize::from(u16::MAX) }))
    }

    /// Index of the object or striker that has a name.
    pub(super) fn reference<'n>(
        &self,
        place: Place,
        (key, kind): (&'static str, &'static str),
        name: &str,
        names: impl Iterator<Item = &'n str> + Clone,
    ) -> Result<U16, KitError> {
        let Some(index) = names.clone().position(|known| known == name) else {
            let known = names.map(str::to_owned).collect();
            return Err(self.fault(place, Fault::Unknown { key, kind, name: name.to_owned(), known }));
        };
        // The largest number of 16 bits stands for "no striker".
        let max = usize::from(NO_STRIKER) - 1;
        match u16::try_from(index) {
            Ok(number) if index <= max => Ok(U16::new(number)),
            _ => {
                Err(self
                    .fault(place, Fault::TooLarge { what: "number of the item that a pad names", found: index, max }))
            }
        }
    }
}

/// Appends the bytes of a record.
pub(super) fn append(bytes: &mut Vec<u8>, record: &(impl IntoBytes + Immutable)) {
    bytes.extend_from_slice(record.as_bytes());
}
