//! The `STRK` sections: strikers, the contacts that they make, and the `rest` section with their
//! restitutions.

use zerocopy::FromBytes;
use zerocopy::byteorder::little_endian::F32;

use super::check::{check_bank, check_count, check_name, check_ranges, check_text, name_str, read_bank, text_str};
use super::error::TableError;
use super::frame::{head, optional_section, sections};
use super::layout::{GainRecord, ModeRecord, SectionEntry, StrikerHeader, tag};
use super::place::{Field, Place};
use super::range;

/// A striker of a [`Kit`](super::Kit).
#[derive(Clone, Copy, Debug)]
pub struct Striker<'a> {
    header: &'a StrikerHeader,
    restitution: f32,
    modes: &'a [ModeRecord],
    gains: &'a [GainRecord],
    source: &'a [u8],
    licence: &'a [u8],
}

/// Contact that a [`Striker`] makes at velocity `v`: peak force `m = m1 v^a`, contact time `τ = τ1
/// v^b`.
///
/// It is a pointer into the kit, so that a pad can keep one for each of its strikers.
#[derive(Clone, Copy, Debug)]
pub struct ContactTable<'a> {
    header: &'a StrikerHeader,
    restitution: f32,
}

/// Restitutions of a kit's strikers; empty if the kit has no `rest` section.
pub(super) fn read_restitutions<'a>(directory: &'a [SectionEntry], kit: &'a [u8]) -> Result<&'a [F32], TableError> {
    let Some(body) = optional_section(directory, kit, tag::RESTITUTION)? else { return Ok(&[]) };
    // The directory is in memory, so that its count times 4 cannot overflow.
    let expected = sections(directory, kit, tag::STRIKER).count() * size_of::<F32>();
    match <[F32]>::ref_from_bytes(body) {
        Ok(restitutions) if body.len() == expected => Ok(restitutions),
        _ => Err(TableError::LengthMismatch { place: Place::Kit, expected, found: body.len() }),
    }
}

impl<'a> Striker<'a> {
    pub(super) fn read(body: &'a [u8], index: usize, restitutions: &[F32]) -> Result<Self, TableError> {
        let place = Place::Striker(index);
        let (header, rest) = head::<StrikerHeader>(body, place)?;
        let modes = usize::from(header.mode_count.get());
        check_count(place, Field::Modes, modes, 0, range::MODES_PER_BANK)?;
        let texts = (usize::from(header.source_bytes.get()), usize::from(header.licence_bytes.get()));
        let (modes, gains, source, licence) = read_bank(body.len(), rest, modes, 1, texts, place)?;
        let restitution = restitutions.get(index).map_or(range::DEFAULT_RESTITUTION, |restitution| restitution.get());
        Ok(Self { header, restitution, modes, gains, source, licence })
    }

    pub(super) fn check(&self, index: usize) -> Result<(), TableError> {
        let place = Place::Striker(index);
        check_name(&self.header.name, place)?;
        [self.source, self.licence].iter().try_for_each(|text| check_text(text, place))?;
        check_count(place, Field::Pulse, self.header.pulse.get() as usize, 0, 1)?;
        let contact = self.contact();
        let ranges = const {
            &[
                (Field::PeakForce, range::PEAK_FORCE),
                (Field::PeakExponent, range::PEAK_EXPONENT),
                (Field::ContactTimeS, range::CONTACT_TIME_S),
                (Field::ContactExponent, range::CONTACT_EXPONENT),
                (Field::Restitution, range::RESTITUTION),
            ]
        };
        let values = [
            contact.peak_force(),
            contact.peak_exponent(),
            contact.contact_time_s(),
            contact.contact_exponent(),
            contact.restitution(),
        ];
        check_ranges(place, ranges, &values)?;
        if contact.is_gaussian() && self.restitution != range::DEFAULT_RESTITUTION {
            return Err(TableError::GaussianRestitution { place, value: self.restitution });
        }
        if self.header.reserved.get() != 0 {
            return Err(TableError::NotZero { place, field: Field::Padding });
        }
        check_bank(self.modes, self.gains, 1, |mode| Place::StrikerMode(index, mode))
    }

    /// Name of the striker.
    pub fn name(&self) -> &'a str {
        name_str(&self.header.name)
    }

    /// Contact that the striker makes.
    pub fn contact(&self) -> ContactTable<'a> {
        ContactTable { header: self.header, restitution: self.restitution }
    }

    /// Poles of the striker's own modes.
    pub fn modes(&self) -> &'a [ModeRecord] {
        self.modes
    }

    /// Gains of the striker's own modes, one for each.
    pub fn gains(&self) -> &'a [GainRecord] {
        self.gains
    }

    /// Source of the numbers, as text.
    pub fn source(&self) -> &'a str {
        text_str(self.source)
    }

    /// Licence of the numbers, as text.
    pub fn licence(&self) -> &'a str {
        text_str(self.licence)
    }
}

impl ContactTable<'_> {
    /// True if the contact pulse is Gaussian; otherwise it is a Hertz pulse with a restitution.
    pub fn is_gaussian(&self) -> bool {
        self.header.pulse.get() == 1
    }

    /// Peak force m1 at velocity 1, in newtons.
    pub fn peak_force(&self) -> f32 {
        self.header.peak_force.get()
    }

    /// Exponent a of the peak force.
    pub fn peak_exponent(&self) -> f32 {
        self.header.peak_exponent.get()
    }

    /// Contact time τ1 at velocity 1, in seconds.
    pub fn contact_time_s(&self) -> f32 {
        self.header.contact_time_s.get()
    }

    /// Exponent b of the contact time.
    pub fn contact_exponent(&self) -> f32 {
        self.header.contact_exponent.get()
    }

    /// Coefficient of restitution of a Hertz pulse, 0.1 to 1.
    pub fn restitution(&self) -> f32 {
        self.restitution
    }
}
