//! From a table of bands to a room.

use super::dimensions::BLOCK_FRAMES;
use super::error::RoomError;
use super::network::NetworkConfig;
use super::plan;
use super::sample::Sample;
use super::state::{Band, Room, Scratch};
use super::turn::Turn;
use super::upsample::Upsampler;
use crate::SampleRate;
use crate::memory::{Memory, OutOfMemory, Region};
use crate::table::layout::RoomBandRecord;

/// Size of a [`Room`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoomSize {
    /// Number of bands.
    pub bands: usize,
    /// Pairs of samples in all delay lines.
    pub pairs: usize,
}

impl<'m, T: Sample> Room<'m, T> {
    /// Size of the room of a table at a rate whose delays have at most `samples` samples.
    ///
    /// # Errors
    /// A [`RoomError`] for bands that make no room.
    pub fn size(bands: &[RoomBandRecord], rate: SampleRate, samples: usize) -> Result<RoomSize, RoomError> {
        let plans = plan::plan(bands, rate, samples)?;
        Ok(RoomSize { bands: bands.len(), pairs: plans.iter().flat_map(|plan| plan.delays).sum() })
    }

    /// Takes the memory of a room, which is silent until it is loaded.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, size: RoomSize) -> Result<Self, OutOfMemory> {
        let mut block = || memory.take(Region::Fast, BLOCK_FRAMES, || 0);
        let inputs = [block()?, block()?];
        let mut stereo = || memory.take(Region::Fast, BLOCK_FRAMES, || [0; 2]);
        Ok(Self {
            inputs,
            outputs: [stereo()?, stereo()?],
            rates: stereo()?,
            bands: memory.take(Region::Fast, size.bands, || Band::NONE)?,
            scratch: memory.take(Region::Fast, 1, || Scratch::EMPTY)?.first_mut(),
            lines: memory.take(Region::Fast, size.pairs, || [T::ZERO; 2])?,
            ..Self::none()
        })
    }

    /// Takes the memory of a room and of its structure; `None` from a memory that
    /// only counts.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn place(memory: &mut Memory<'m>, size: RoomSize) -> Result<Option<&'m mut Self>, OutOfMemory> {
        let room = Self::take(memory, size)?;
        let Some(place) = memory.take(Region::Fast, 1, Self::none)?.first_mut() else { return Ok(None) };
        *place = room;
        Ok(Some(place))
    }

    /// Derives the room of bands, from the lowest up, in the memory that was taken for its
    /// [`size`](Self::size) with as many `samples`, and begins in silence.
    ///
    /// # Errors
    /// A [`RoomError`]; the room is then not to be played.
    pub fn load(&mut self, bands: &[RoomBandRecord], rate: SampleRate, samples: usize) -> Result<(), RoomError> {
        (self.passed, self.silent_blocks) = (0, 0);
        let plans = plan::plan(bands, rate, samples)?;
        let (mut below, mut start) = (1, 0);
        for (band, plan) in self.bands.iter_mut().zip(&plans) {
            *band = Band {
                config: NetworkConfig::new(plan),
                split: plan.split,
                division: plan.division as u8,
                thins: below > plan.division,
                pairs: plan.delays.iter().sum::<usize>() as u16,
                start,
                ..Band::NONE
            };
            below = plan.division;
            start += band.pairs;
        }
        for (halvings, upsampler) in self.upsamplers.iter_mut().enumerate() {
            *upsampler = Upsampler::new(plan::highest_end(&plans, 1 << halvings));
        }
        self.turn = Turn::new(rate);
        self.levels = self.bands.first().map_or(0, |band| band.division.trailing_zeros() as usize);
        self.part_ends = plan::part_ends(&plans, bands.len());
        self.lines.fill([T::ZERO; 2]);
        self.clear();
        Ok(())
    }
}
