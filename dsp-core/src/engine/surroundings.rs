//! What an engine may have beside its pads: noise and a room, or neither.

use super::{Engine, FilterRoom, Fitting, LoadError, NoFilters, NoResiduals, ResidualRoom, Residuals, Stage};
use crate::SampleRate;
use crate::room::{Room, RoomError, Sample};
use crate::table::Kit;
use crate::table::layout::RoomBandRecord;

/// What an engine has memory and code for: [`NoResiduals`] (neither noise nor a room), [`Residuals`] (noise, no room), a pair of noise and
/// room, such as `(NoResiduals, Room<i16, 24576>)`, or noise, room and filters, such as `(NoResiduals, NoRoom, Filters<2, 16, 4, 512, 64>)`. What
/// a kit has beyond that is not heard.
pub trait Surroundings {
    /// Residuals and background.
    type Residuals: ResidualRoom;
    /// The room.
    type Room: RoomStage;
    /// Dynamic filters and biquad banks.
    type Filters: FilterRoom;
}

impl Surroundings for NoResiduals {
    type Residuals = Self;
    type Room = NoRoom;
    type Filters = NoFilters;
}

impl<const COUNT: usize> Surroundings for Residuals<COUNT> {
    type Residuals = Self;
    type Room = NoRoom;
    type Filters = NoFilters;
}

impl<R: ResidualRoom, M: RoomStage> Surroundings for (R, M) {
    type Residuals = R;
    type Room = M;
    type Filters = NoFilters;
}

impl<R: ResidualRoom, M: RoomStage, F: FilterRoom> Surroundings for (R, M, F) {
    type Residuals = R;
    type Room = M;
    type Filters = F;
}

/// An engine's last stage before the output: [`NoRoom`], or a [`Room`] of some memory.
pub trait RoomStage {
    /// No room, silent.
    const EMPTY: Self;

    /// Derives the room from its bands and begins in silence.
    ///
    /// # Errors
    /// A [`RoomError`]; there is then no room.
    fn load(&mut self, bands: &[RoomBandRecord], rate: SampleRate) -> Result<(), RoomError>;

    /// Adds the answer to a run of the stereo bus.
    fn render(&mut self, out: &mut [[i32; 2]]);

    /// Lets frames of silence pass of a room that is silent.
    fn pass_silence(&mut self, frames: usize);

    /// Whether nothing goes out until something comes in.
    fn is_silent(&self) -> bool;

    /// Number of bands; 0 where there is no room.
    fn band_count(&self) -> usize;
}

/// No memory and no code.
#[derive(Clone, Copy, Debug)]
pub struct NoRoom;

impl RoomStage for NoRoom {
    const EMPTY: Self = Self;

    fn load(&mut self, _: &[RoomBandRecord], _: SampleRate) -> Result<(), RoomError> {
        Ok(())
    }

    #[inline(always)]
    fn render(&mut self, _: &mut [[i32; 2]]) {}

    #[inline(always)]
    fn pass_silence(&mut self, _: usize) {}

    #[inline(always)]
    fn is_silent(&self) -> bool {
        true
    }

    #[inline(always)]
    fn band_count(&self) -> usize {
        0
    }
}

impl<T: Sample, const SAMPLES: usize> RoomStage for Room<T, SAMPLES> {
    const EMPTY: Self = Self::new();

    fn load(&mut self, bands: &[RoomBandRecord], rate: SampleRate) -> Result<(), RoomError> {
        Room::load(self, bands, rate)
    }

    fn render(&mut self, out: &mut [[i32; 2]]) {
        Room::render(self, out);
    }

    fn pass_silence(&mut self, frames: usize) {
        Room::pass_silence(self, frames);
    }

    fn is_silent(&self) -> bool {
        Room::is_silent(self)
    }

    fn band_count(&self) -> usize {
        Room::band_count(self)
    }
}

/// Nominal cycles of the dearest tick of a room that sounds, and of each band of it, with some to spare (`cargo test -p host-tests --test on_chip room -- --nocapture`:
/// up to 430 a frame with 4 bands). Bands of octaves and more are meant; several bands near the full rate cost more.
const ROOM_TICK: u32 = 11_200;
const ROOM_BAND_TICK: u32 = 950;
/// The same of one that is silent.
const SILENT_ROOM_TICK: u32 = 520;

impl<
    'k,
    const PADS: usize,
    const BANKS: usize,
    const MODES: usize,
    const GROUPS: usize,
    const ORIGINS: usize,
    const CONTACTS: usize,
    S: Surroundings,
> Engine<'k, PADS, BANKS, MODES, GROUPS, ORIGINS, CONTACTS, S>
{
    /// Derives the room, and begins it in silence.
    pub(super) fn load_room(
        &mut self,
        kit: &Kit<'_>,
        rate: SampleRate,
        fitting: &mut impl Fitting,
    ) -> Result<(), LoadError> {
        let bands = kit.room();
        if let Err(error) = self.room.load(bands, rate) {
            return fitting.leave_out(LoadError::Room(error));
        }
        match self.room.band_count() as u32 {
            0 if !bands.is_empty() => fitting.pass_over(Stage::Room),
            0 => {}
            count if fitting.take(Stage::Room, ROOM_TICK + count * ROOM_BAND_TICK) => {}
            _ => return self.room.load(&[], rate).map_err(LoadError::Room),
        }
        Ok(())
    }

    /// Lets the room answer a run of the stereo bus.
    #[inline(always)]
    pub(super) fn render_room(&mut self, out: &mut [[i32; 2]]) {
        if self.room.band_count() > 0 {
            self.add_room(out);
        }
    }

    #[inline(never)]
    fn add_room(&mut self, out: &mut [[i32; 2]]) {
        self.room.render(out);
        self.report.room_frames += if self.room.is_silent() { 0 } else { out.len() as u32 };
    }

    /// Cycles that the room takes in this tick.
    #[inline(always)]
    pub(super) fn room_cycles(&self) -> u32 {
        match self.room.band_count() as u32 {
            0 => 0,
            _ if self.room.is_silent() && self.is_silent() => SILENT_ROOM_TICK,
            bands => ROOM_TICK + bands * ROOM_BAND_TICK,
        }
    }
}
