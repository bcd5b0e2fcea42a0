//! Noise of a voice or of the background, with the time that it takes.

use crate::SampleRate;
use crate::memory::{Memory, OutOfMemory, Region};
use crate::noise::Sfc32;
use crate::residual::{ResidualBand, Shaper};

/// Residual of a pad's object, or the background.
#[derive(Debug)]
pub struct Residual<'m> {
    /// Worst cycles of a tick in which it sounds.
    pub(crate) worst_cycles: u32,
    shaper: Shaper<'m>,
}

impl<'m> Residual<'m> {
    const fn none() -> Self {
        Self { worst_cycles: 0, shaper: Shaper::none() }
    }

    /// Takes the memory of noise in `bands` bands; `None` from a memory that only
    /// counts.
    ///
    /// # Errors
    /// [`OutOfMemory`] if too little is left.
    pub fn place(memory: &mut Memory<'m>, bands: usize) -> Result<Option<&'m mut Self>, OutOfMemory> {
        let shaper = Shaper::take(memory, bands)?;
        let place = memory.take(Region::Bulk, 1, Self::none)?.first_mut();
        let Some(place) = place else { return Ok(None) };
        place.shaper = shaper;
        Ok(Some(place))
    }

    /// Derives the noise for a rate, as [`Shaper::load_choked`] does.
    pub(crate) fn load(
        &mut self,
        laws: impl Iterator<Item = ResidualBand>,
        rate: SampleRate,
        noise: Sfc32,
        silence: f32,
        choke_db_per_s: f64,
    ) {
        self.shaper.load_choked(laws, rate, noise, silence, choke_db_per_s);
    }

    /// Begins stationary noise.
    pub(crate) fn begin(&mut self) {
        self.shaper.begin();
    }

    /// Ends the noise at once. A hand stays.
    pub(crate) fn rest(&mut self) {
        self.shaper.stop();
    }

    /// True if it sounds; otherwise rendering and ending a tick do nothing.
    #[inline(always)]
    pub(crate) fn is_active(&self) -> bool {
        self.shaper.is_active()
    }

    /// Begins the noise of a strike at a frame of the tick; `level` is its peak force over the
    /// reference force.
    #[inline(always)]
    pub(crate) fn strike(&mut self, level: f32, frame: usize) {
        self.shaper.strike(level, frame);
    }

    /// Chokes the noise, or releases it, on a tick.
    #[inline(always)]
    pub(crate) fn set_choked(&mut self, is_choked: bool) {
        self.shaper.set_choked(is_choked);
    }

    /// Adds a run of at most a tick to a bus.
    #[inline(always)]
    pub(crate) fn render(&mut self, bus: &mut [i32]) {
        self.shaper.render(bus);
    }

    /// Works on noise to come, behind the last run of a tick; `dear_ticks` as of
    /// [`Shaper::end_tick`].
    #[inline(always)]
    pub(crate) fn end_tick(&mut self, dear_ticks: u32) {
        self.shaper.end_tick(dear_ticks);
    }

    /// Nominal cycles of this tick's work on noise to come.
    #[inline(always)]
    pub(crate) fn cycles(&self, dear_ticks: u32) -> u32 {
        self.shaper.cycles_ahead(dear_ticks)
    }
}
