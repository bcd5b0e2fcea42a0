//! Stages whose memory lies apart from the engine's.

use super::noise::Place;
use super::{FilterRoom, Fitting, Left, LoadError, ResidualRoom, RoomStage};
use crate::SampleRate;
use crate::pad::FilterWork;
use crate::resonator::Bank;
use crate::table::Kit;
use crate::table::layout::RoomBandRecord;

/// [`Residuals`](super::Residuals), a [`Room`](crate::room::Room) or [`Filters`](super::Filters) in a memory of their own: a chip's RAM may be several
/// memories, none of which holds all of an engine ([`Engine::with_stages`](super::Engine::with_stages)). The same bits; a pointer more to follow.
#[derive(Debug)]
pub struct Apart<'m, T>(Option<&'m mut T>);

impl<'m, T> Apart<'m, T> {
    /// A stage that lies there.
    pub const fn new(stage: &'m mut T) -> Self {
        Self(Some(stage))
    }
}

impl<R: ResidualRoom> ResidualRoom for Apart<'_, R> {
    const EMPTY: Self = Self(None);

    #[inline(always)]
    fn places(&self) -> &[Place] {
        self.0.as_ref().map_or(&[], |residuals| residuals.places())
    }

    #[inline(always)]
    fn places_mut(&mut self) -> &mut [Place] {
        self.0.as_mut().map_or(&mut [], |residuals| residuals.places_mut())
    }
}

impl<M: RoomStage> RoomStage for Apart<'_, M> {
    const EMPTY: Self = Self(None);

    fn load(&mut self, bands: &[RoomBandRecord], rate: SampleRate) -> Result<(), crate::room::RoomError> {
        self.0.as_mut().map_or(Ok(()), |room| room.load(bands, rate))
    }

    fn render(&mut self, out: &mut [[i32; 2]]) {
        if let Some(room) = self.0.as_mut() {
            room.render(out);
        }
    }

    fn pass_silence(&mut self, frames: usize) {
        if let Some(room) = self.0.as_mut() {
            room.pass_silence(frames);
        }
    }

    fn is_silent(&self) -> bool {
        self.0.as_ref().is_none_or(|room| room.is_silent())
    }

    fn band_count(&self) -> usize {
        self.0.as_ref().map_or(0, |room| room.band_count())
    }
}

impl<F: FilterRoom> FilterRoom for Apart<'_, F> {
    const EMPTY: Self = Self(None);

    fn load<G: Fitting>(&mut self, kit: &Kit<'_>, rate: SampleRate, fitting: &mut G) -> Result<(), LoadError> {
        self.0.as_mut().map_or(Ok(()), |filters| filters.load(kit, rate, fitting))
    }

    #[inline(never)]
    fn join_in(&self, pad: u8, has_force: bool, banks: &[Bank]) -> bool {
        self.0.as_ref().is_some_and(|filters| filters.join_in(pad, has_force, banks))
    }

    fn takes_force(&self, pad: u8) -> bool {
        self.0.as_ref().is_some_and(|filters| filters.takes_force(pad))
    }

    fn takes_modes(&self, pad: u8) -> bool {
        self.0.as_ref().is_some_and(|filters| filters.takes_modes(pad))
    }

    fn has(&self, pad: u8) -> bool {
        self.0.as_ref().is_some_and(|filters| filters.has(pad))
    }

    fn strike(&mut self, pad: u8, level: f32, frame: usize, left: &mut Left) {
        if let Some(filters) = self.0.as_mut() {
            filters.strike(pad, level, frame, left);
        }
    }

    fn sounding_cycles(&self) -> u32 {
        self.0.as_ref().map_or(0, |filters| filters.sounding_cycles())
    }

    fn set_choked(&mut self, pad: u8, nepers: Option<f64>) {
        if let Some(filters) = self.0.as_mut() {
            filters.set_choked(pad, nepers);
        }
    }

    fn render(
        &mut self,
        pad: u8,
        frame: usize,
        force: Option<&[i32]>,
        modes: Option<&mut [i32]>,
        out: &mut [i32],
    ) -> FilterWork {
        let filters = self.0.as_mut();
        filters.map_or(FilterWork::default(), |filters| filters.render(pad, frame, force, modes, out))
    }

    fn ringing(&self) -> u32 {
        self.0.as_ref().map_or(0, |filters| filters.ringing())
    }

    fn cycles(&self, pad: u8, struck: bool) -> u32 {
        self.0.as_ref().map_or(0, |filters| filters.cycles(pad, struck))
    }

    fn hand_cycles(&self, pad: u8) -> u32 {
        self.0.as_ref().map_or(0, |filters| filters.hand_cycles(pad))
    }
}
