//! The `biqd` sections: the biquad bank of an object.

use zerocopy::FromBytes;

use super::check::{check_count, check_object, check_range, check_ranges};
use super::error::TableError;
use super::frame::{head, sections};
use super::kit::Kit;
use super::layout::{BiquadRecord, BiquadsHeader, tag};
use super::place::{Field, Place};
use super::range::{self, Range};

/// Biquad bank of one object of a [`Kit`]: chains side by side, each with the same number of
/// biquads.
#[derive(Clone, Copy, Debug)]
pub struct Biquads<'a> {
    header: &'a BiquadsHeader,
    biquads: &'a [BiquadRecord],
}

impl<'a> Kit<'a> {
    /// Biquad banks in the order of their objects, each checked as it is read.
    ///
    /// [`Kit::parse`] leaves the banks unchecked, because few engines play them.
    ///
    /// # Errors
    /// The first [`TableError`] of each section.
    pub fn biquads(&self) -> impl Iterator<Item = Result<Biquads<'a>, TableError>> + use<'a> {
        let (objects, mut next_object) = (self.objects().count(), 0);
        sections(self.directory, self.bytes, tag::BIQUADS).map(move |body| {
            let biquads = Biquads::read(body)?;
            biquads.check(objects, next_object)?;
            next_object = biquads.object_index() + 1;
            Ok(biquads)
        })
    }

    /// Biquad bank of the object of an index; `None` if the object has no bank.
    ///
    /// # Errors
    /// The first [`TableError`] of the biquad banks up to that of the object.
    pub fn biquads_of(&self, object: usize) -> Result<Option<Biquads<'a>>, TableError> {
        let mut banks = self.biquads();
        banks.find(|bank| bank.as_ref().map_or(true, |bank| bank.object_index() == object)).transpose()
    }
}

impl<'a> Biquads<'a> {
    fn read(body: &'a [u8]) -> Result<Self, TableError> {
        let (header, rest) = head::<BiquadsHeader>(body, Place::Kit)?;
        let place = Place::ObjectBiquads(usize::from(header.object.get()));
        let (chains, depth) = (usize::from(header.chain_count.get()), usize::from(header.depth.get()));
        check_count(place, Field::Chains, chains, 1, range::CHAINS)?;
        check_count(
            Place::ObjectChain(usize::from(header.object.get()), 0),
            Field::Biquads,
            depth,
            1,
            range::CHAIN_DEPTH,
        )?;
        let expected = size_of::<BiquadsHeader>() + size_of::<BiquadRecord>() * chains * depth;
        let mismatch = TableError::LengthMismatch { place, expected, found: body.len() };
        let biquads = <[BiquadRecord]>::ref_from_bytes(rest).map_err(|_| mismatch)?;
        if biquads.len() == chains * depth { Ok(Self { header, biquads }) } else { Err(mismatch) }
    }

    fn check(&self, objects: usize, next_object: usize) -> Result<(), TableError> {
        let object = self.object_index();
        let place = Place::ObjectBiquads(object);
        check_object(object, objects, next_object, place)?;
        check_range(place, Field::RateHz, self.rate_hz(), range::RATE_HZ)?;
        if self.header.reserved.get() != 0 {
            return Err(TableError::NotZero { place, field: Field::Padding });
        }
        for (chain, biquads) in self.chains().enumerate() {
            for (biquad, record) in biquads.iter().enumerate() {
                check_biquad(Place::ObjectBiquad(object, chain * range::CHAIN_DEPTH + biquad), record)?;
            }
        }
        Ok(())
    }

    /// Number of the object, counted from 0.
    pub fn object_index(&self) -> usize {
        usize::from(self.header.object.get())
    }

    /// Sample rate in Hz that poles and zeros are for.
    pub fn rate_hz(&self) -> f32 {
        self.header.rate_hz.get()
    }

    /// Number of biquads in each chain.
    pub fn depth(&self) -> usize {
        usize::from(self.header.depth.get())
    }

    /// Biquads of all chains, chain by chain.
    pub fn records(&self) -> &'a [BiquadRecord] {
        self.biquads
    }

    /// Chains, each a slice of [`Self::depth`] biquads.
    pub fn chains(&self) -> impl ExactSizeIterator<Item = &'a [BiquadRecord]> + use<'a> {
        self.biquads.chunks_exact(self.depth().max(1))
    }
}

fn check_biquad(place: Place, record: &BiquadRecord) -> Result<(), TableError> {
    let [pole_re, pole_im, zero_re, zero_im, gain] =
        [record.pole_re, record.pole_im, record.zero_re, record.zero_im, record.gain].map(|number| number.get());
    check_ranges(place, &BIQUAD, &[pole_re, pole_im, zero_re, zero_im, gain])?;
    let (re, im) = (f64::from(pole_re), f64::from(pole_im));
    let radius = libm::sqrt(re * re + im * im);
    match radius < 1.0 {
        true => Ok(()),
        false => Err(TableError::UnstablePole { place, field: Field::Pole, radius: radius as f32 }),
    }
}

const BIQUAD: [(Field, Range); 5] = [
    (Field::Pole, range::POLE),
    (Field::Pole, range::POLE),
    (Field::Zero, range::ZERO),
    (Field::Zero, range::ZERO),
    (Field::Gain, range::GAIN),
];
