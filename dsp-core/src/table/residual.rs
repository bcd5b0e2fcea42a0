//! The `resi` sections (bands of decaying noise that an object sounds beside its modes) and the
//! `bgnd` section (stationary noise behind all pads).

use zerocopy::FromBytes;
use zerocopy::byteorder::little_endian::F32;

use super::check::{check_count, check_object, check_range};
use super::error::TableError;
use super::frame::head;
use super::layout::{BackgroundHeader, ResidualBandRecord, ResidualHeader};
use super::place::{Field, Place};
use super::range;

/// Band of noise of a [`Residual`] or a [`Background`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualBand {
    /// Lower and upper edge in Hz.
    pub edges_hz: [f32; 2],
    /// Rms w at t = 0 (1.0 = full scale) of a strike whose peak force is the reference force.
    pub weight: f32,
    /// Decay γ in dB/s.
    pub decay_db_per_s: f32,
}

/// Residual of one object of a [`Kit`](super::Kit).
#[derive(Clone, Copy, Debug)]
pub struct Residual<'a> {
    header: &'a ResidualHeader,
    /// Edges in Hz, one more than there are bands.
    edges: &'a [F32],
    bands: &'a [ResidualBandRecord],
}

/// Background of a [`Kit`](super::Kit).
#[derive(Clone, Copy, Debug)]
pub struct Background<'a> {
    header: &'a BackgroundHeader,
    /// Edges in Hz, one more than there are bands.
    edges: &'a [F32],
    weights: &'a [F32],
}

impl<'a> Residual<'a> {
    pub(super) fn read(body: &'a [u8]) -> Result<Self, TableError> {
        let (header, rest) = head::<ResidualHeader>(body, Place::Kit)?;
        let place = Place::ObjectResidual(usize::from(header.object.get()));
        let count = usize::from(header.band_count.get());
        check_count(place, Field::Weight, count, 1, range::NOISE_BANDS)?;
        let expected = size_of::<ResidualHeader>() + 4 * (count + 1) + size_of::<ResidualBandRecord>() * count;
        let mismatch = TableError::LengthMismatch { place, expected, found: body.len() };
        let (edges, rest) = <[F32]>::ref_from_prefix_with_elems(rest, count + 1).map_err(|_| mismatch)?;
        let bands = <[ResidualBandRecord]>::ref_from_bytes(rest).map_err(|_| mismatch)?;
        if bands.len() != count {
            return Err(mismatch);
        }
        Ok(Self { header, edges, bands })
    }

    pub(super) fn check(&self, objects: usize, next_object: usize) -> Result<(), TableError> {
        let index = self.object_index();
        check_object(index, objects, next_object, Place::ObjectResidual(index))?;
        check_edges(self.edges, |edge| Place::ObjectEdge(index, edge))?;
        for (band, record) in self.bands.iter().enumerate() {
            let place = Place::ObjectBand(index, band);
            check_range(place, Field::Weight, record.weight.get(), range::WEIGHT)?;
            check_range(place, Field::DecayDbPerS, record.decay_db_per_s.get(), range::DECAY_DB_PER_S)?;
        }
        Ok(())
    }

    /// Number of the object, counted from 0.
    pub fn object_index(&self) -> usize {
        usize::from(self.header.object.get())
    }

    /// Seed of the noise.
    pub fn seed(&self) -> u32 {
        self.header.seed.get()
    }

    /// Bands, lowest first.
    pub fn bands(&self) -> impl ExactSizeIterator<Item = ResidualBand> + Clone + use<'a> {
        self.bands.iter().zip(self.edges.windows(2)).map(|(band, edges)| ResidualBand {
            edges_hz: [edge(edges, 0), edge(edges, 1)],
            weight: band.weight.get(),
            decay_db_per_s: band.decay_db_per_s.get(),
        })
    }
}

impl<'a> Background<'a> {
    pub(super) fn read(body: &'a [u8]) -> Result<Self, TableError> {
        let place = Place::Background;
        let (header, rest) = head::<BackgroundHeader>(body, place)?;
        let count = usize::from(header.band_count.get());
        check_count(place, Field::Weight, count, 1, range::NOISE_BANDS)?;
        let expected = size_of::<BackgroundHeader>() + 4 * (2 * count + 1);
        let mismatch = TableError::LengthMismatch { place, expected, found: body.len() };
        let (edges, rest) = <[F32]>::ref_from_prefix_with_elems(rest, count + 1).map_err(|_| mismatch)?;
        let weights = <[F32]>::ref_from_bytes(rest).map_err(|_| mismatch)?;
        if weights.len() != count {
            return Err(mismatch);
        }
        if header.reserved.get() != 0 {
            return Err(TableError::NotZero { place, field: Field::Padding });
        }
        Ok(Self { header, edges, weights })
    }

    pub(super) fn check(&self) -> Result<(), TableError> {
        check_edges(self.edges, Place::BackgroundEdge)?;
        for (band, weight) in self.weights.iter().enumerate() {
            check_range(Place::BackgroundBand(band), Field::Weight, weight.get(), range::WEIGHT)?;
        }
        Ok(())
    }

    /// Seed of the noise.
    pub fn seed(&self) -> u32 {
        self.header.seed.get()
    }

    /// Bands, lowest first; their decay is 0.
    pub fn bands(&self) -> impl ExactSizeIterator<Item = ResidualBand> + Clone + use<'a> {
        self.weights.iter().zip(self.edges.windows(2)).map(|(weight, edges)| ResidualBand {
            edges_hz: [edge(edges, 0), edge(edges, 1)],
            weight: weight.get(),
            decay_db_per_s: 0.0,
        })
    }
}

fn edge(edges: &[F32], index: usize) -> f32 {
    edges.get(index).map_or(0.0, |edge| edge.get())
}

/// Checks that each edge is in its range and at least [`range::BAND_WIDTH_HZ`] above the edge
/// before it.
fn check_edges(edges: &[F32], place: impl Fn(usize) -> Place) -> Result<(), TableError> {
    for (index, value) in edges.iter().enumerate() {
        check_range(place(index), Field::EdgesHz, value.get(), range::EDGE_HZ)?;
    }
    for (index, pair) in edges.windows(2).enumerate() {
        let (below, above) = (edge(pair, 0), edge(pair, 1));
        if above - below < range::BAND_WIDTH_HZ {
            return Err(TableError::EdgeOrder { place: place(index + 1), field: Field::EdgesHz, below, above });
        }
    }
    Ok(())
}
