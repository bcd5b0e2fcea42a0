//! The noise of one pad: its strikes, its frames and the work of its ticks.

use super::bands::{Bands, FRAME_TICKS, Passage, power_of};
use super::job::Job;
use super::making::Making;
use super::onset::Onset;
use super::stream::Stream;
use crate::SampleRate;
use crate::fixed;
use crate::fourier::{Complex, MAX_POINTS};
use crate::memory::{Memory, OutOfMemory, Region};
use crate::noise::Sfc32;
use crate::square_root::square_root;
use crate::table::ResidualBand;
use crate::time::TICK_FRAMES;

/// Number of waves in memory: two frames, one in the making, a strike's own, and new noise for the
/// next strike.
const REGIONS: usize = 5;
/// Noise in bands, each of which decays at its own rate after every strike.
///
/// 24 KB. Accuracy against the law and cycles: `docs/residual.md`.
#[derive(Debug)]
pub struct Shaper<'m> {
    pub(super) bands: Bands<'m>,
    pub(super) noise: Sfc32,
    pub(super) onset: Onset,
    /// Power below which the sound ends.
    pub(super) silence: f32,
    pub(super) waves: &'m mut [[Complex; MAX_POINTS]],
    /// The waves that sound: up to two frames, a strike's own, and the end of another strike's.
    pub(super) streams: [Option<Stream>; 4],
    pub(super) job: Option<Job>,
    pub(super) renewal: Option<Making>,
    /// Ticks until the next frame begins; 0 if there will be none.
    pub(super) ticks_to_next: u32,
    /// True if the next frame is the first to carry a strike.
    pub(super) in_onset: bool,
    /// True if a strike came in this tick, which leaves no time for more.
    just_struck: bool,
    /// True if work on the next frame has waited for cheaper ticks.
    pub(super) has_waited: bool,
    /// Ticks since the last frame began.
    pub(super) ticks_since: u32,
    active: bool,
    /// True while a hand lies on the object.
    pub(super) choked: bool,
    /// Ticks for which a hand has lain there since the time for which the bands' energies stand,
    /// and the number of such ticks that the frame in the making expects.
    choked_ticks: f32,
    expected_ticks: f32,
}

impl<'m> Shaper<'m> {
    /// A stage without bands, which stays silent.
    pub const fn none() -> Self {
        Self {
            bands: Bands::none(),
            noise: Sfc32::new(0, 0),
            onset: Onset::NONE,
            silence: 0.0,
            waves: &mut [],
            streams: [None; 4],
            job: None,
            renewal: None,
            ticks_to_next: 0,
            in_onset: false,
            just_struck: false,
            has_waited: false,
            ticks_since: 0,
            active: false,
            choked: false,
            choked_ticks: 0.0,
            expected_ticks: 0.0,
        }
    }

    /// Takes memory for `bands` bands, 20 KB and 32 bytes a band. The stage is silent until it is
    /// loaded.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, bands: usize) -> Result<Self, OutOfMemory> {
        let points = memory.take(Region::Bulk, REGIONS * MAX_POINTS, || [0.0; 2])?;
        Ok(Self { bands: Bands::take(memory, bands)?, waves: points.as_chunks_mut().0, ..Self::none() })
    }

    /// Derives the stage for a rate in the memory that was taken for as many bands; the pad cannot
    /// be choked. `silence` is the rms (1.0 = full scale) below which the sound ends, `noise` tells
    /// stages of one seed apart. Bands beyond [`MAX_BANDS`](super::MAX_BANDS) are left out: a kit's
    /// check refuses them.
    pub fn load(&mut self, laws: impl Iterator<Item = ResidualBand>, rate: SampleRate, noise: Sfc32, silence: f32) {
        self.load_choked(laws, rate, noise, silence, 0.0);
    }

    /// Derives the stage as [`load`](Self::load) does, for a pad that can be choked: under a hand
    /// ([`set_choked`](Self::set_choked)) all bands fall by at least `hand_db_per_s`; 0 if the pad
    /// cannot be choked.
    pub fn load_choked(
        &mut self,
        laws: impl Iterator<Item = ResidualBand>,
        rate: SampleRate,
        noise: Sfc32,
        silence: f32,
        hand_db_per_s: f64,
    ) {
        self.stop();
        (self.onset, self.renewal, self.choked) = (Onset::NONE, None, false);
        self.bands.load(laws, hand_db_per_s, rate);
        self.noise = noise;
        self.silence = silence * silence;
        if let Some(wave) = self.waves.first_mut() {
            self.onset.load(&self.bands, wave, &mut self.noise);
        }
    }

    /// Ends all noise at once.
    pub(crate) fn stop(&mut self) {
        self.bands.clear();
        (self.streams, self.job) = ([None; 4], None);
        (self.ticks_to_next, self.in_onset, self.just_struck, self.active) = (0, false, false, false);
        (self.ticks_since, self.choked_ticks, self.expected_ticks) = (0, 0.0, 0.0);
    }

    /// True if the table has bands.
    pub fn is_built(&self) -> bool {
        self.bands.count() > 0
    }

    /// True if anything sounds; otherwise [`render`](Self::render) and [`end_tick`](Self::end_tick)
    /// do nothing.
    #[inline(always)]
    pub fn is_active(&self) -> bool {
        self.active
    }

    /// Lays a hand on the object, or lifts it, on a tick. Under a hand each band falls at its own
    /// rate or the hand's, whichever is faster.
    ///
    /// Frames that sound or are nearly made fall at once, as a whole, by the mean over all bands.
    /// The next frame is right band by band.
    pub fn set_choked(&mut self, choked: bool) {
        self.choked = choked;
    }

    /// The value without a hand or the one with a hand, by what lies on the object now.
    pub(super) fn left_of(&self, [free, choked]: [f32; 2]) -> f32 {
        if self.choked { choked } else { free }
    }

    /// Begins to make a frame that begins in `ticks` ticks; there must be none in the making.
    pub(super) fn make(&mut self, passage: Passage, ticks: u32, is_struck: bool) {
        let to_come = if self.choked { ticks as f32 } else { 0.0 };
        self.expected_ticks = self.choked_ticks + to_come;
        let passage = Passage { choked_ticks: self.expected_ticks, is_choked: self.choked, ..passage };
        let region = self.free_region().unwrap_or(0);
        self.job = Some(Job::new(region, passage, self.bands.count(), is_struck));
        self.has_waited = false;
    }

    /// Counts held ticks anew from the beginning of the frame that was in the making, for which the
    /// bands' energies stand now. Gives the ticks by which the hand lay there longer than expected.
    pub(super) fn settle_choke(&mut self) -> f32 {
        self.choked_ticks -= core::mem::take(&mut self.expected_ticks);
        self.choked_ticks
    }

    /// Begins the noise of a strike: `strength` is its peak force over the reference force,
    /// `offset` its frame within the tick.
    #[inline(never)]
    pub fn strike(&mut self, strength: f32, offset: usize) {
        let energy = strength * strength;
        if !self.is_built() || energy.is_nan() || energy <= 0.0 {
            return;
        }
        self.active = true;
        if self.in_onset {
            self.join_onset(energy);
        } else {
            self.begin_onset(strength);
        }
        let onset_per_frame = self.left_of(self.onset.per_frame);
        if let Some(job) = self.job.as_mut() {
            // Share of its energy at the frame's beginning, on average over the bands.
            let left = power_of(onset_per_frame, 2 * TICK_FRAMES as u32 * self.ticks_to_next);
            let ticks = self.ticks_to_next as f32 - offset as f32 / TICK_FRAMES as f32;
            job.add(energy, ticks.max(0.0), energy * left * self.bands.strike_power());
        }
    }

    /// Begins stationary noise: bands without decay, which fade in.
    pub fn begin(&mut self) {
        if self.is_built() {
            self.active = true;
            self.plan_onset();
            if let Some(job) = self.job.as_mut() {
                job.add(1.0, 0.0, 0.0);
            }
        }
    }

    /// Adds a second strike before the frame that carries the first: the noise that sounds grows.
    fn join_onset(&mut self, energy: f32) {
        let is_own = |stream: &&mut Stream| stream.is_own() && stream.is_held();
        if let Some(own) = self.streams.iter_mut().flatten().find(is_own) {
            own.gain = square_root(own.gain * own.gain + energy);
        }
    }

    fn begin_onset(&mut self, strength: f32) {
        // A frame that was about to be replaced sounds on.
        self.streams.iter_mut().flatten().for_each(Stream::hold);
        self.plan_onset();
        self.onset.is_used = true;
        let start = self.noise.draw();
        self.add_stream(Stream::of_strike(self.onset.region, start, strength, self.onset.per_frame));
    }

    pub(super) fn add_stream(&mut self, stream: Stream) {
        if let Some(free) = self.streams.iter_mut().find(|stream| stream.is_none()) {
            *free = Some(stream);
        }
    }

    /// Plans the first frame that carries all energy, in place of any other.
    fn plan_onset(&mut self) {
        // The bands' energies stand for the last frame's beginning or, once they have been brought
        // up to date, for the next one's.
        let is_ahead = self.job.take().is_none_or(|job| job.give_up(&mut self.bands));
        let ticks = self.ticks_since + if is_ahead { 0 } else { FRAME_TICKS };
        (self.in_onset, self.just_struck, self.ticks_to_next) = (true, true, FRAME_TICKS);
        if is_ahead {
            self.settle_choke();
        }
        self.make(Passage { ticks, ..Passage::NEXT }, FRAME_TICKS, true);
    }

    pub(super) fn free_region(&self) -> Option<usize> {
        let is_used = |region: &usize| {
            self.onset.region == *region
                || self.renewal.is_some_and(|renewal| renewal.region == *region)
                || self.job.is_some_and(|job| job.region == *region)
                || self.streams.iter().flatten().any(|stream| stream.region == *region)
        };
        (0..self.waves.len()).find(|region| !is_used(region))
    }

    /// Adds the sound of a run of at most a tick to `out`, Q4.27.
    #[inline(always)]
    pub fn render(&mut self, out: &mut [i32]) {
        if self.active {
            self.add_sound(out);
        }
    }

    #[inline(never)]
    fn add_sound(&mut self, out: &mut [i32]) {
        let mut sum = [0.0; TICK_FRAMES];
        let Some(sum) = sum.get_mut(..out.len()) else { return };
        for stream in self.streams.iter_mut().flatten() {
            if let Some(wave) = self.waves.get(stream.region) {
                stream.add_to(wave, self.choked, sum);
            }
        }
        // `as` saturates.
        let add = |out: &mut i32, sum: f32| *out = fixed::qadd(*out, (sum * fixed::ONE_Q27 as f32) as i32);
        let (fours, rest) = out.as_chunks_mut::<4>();
        let (sums, last) = sum.as_chunks::<4>();
        for ([a, b, c, d], &[e, f, g, h]) in fours.iter_mut().zip(sums) {
            add(a, e);
            add(b, f);
            add(c, g);
            add(d, h);
        }
        rest.iter_mut().zip(last).for_each(|(out, &sum)| add(out, sum));
    }

    /// Does a tick's work for the frames to come. Call it after the tick's last run.
    ///
    /// `dear_ticks` is the number of ticks, from this one on, that other parts of the engine make
    /// dear: as much of the work as possible then waits for the ticks behind them, which do at most
    /// twice an even share.
    #[inline(always)]
    pub fn end_tick(&mut self, dear_ticks: u32) {
        if self.active {
            self.end_sounding_tick(dear_ticks);
        }
    }

    #[inline(never)]
    fn end_sounding_tick(&mut self, dear_ticks: u32) {
        self.ticks_since += 1;
        if self.choked {
            self.choked_ticks += 1.0;
        }
        if self.ticks_to_next > 0 && !core::mem::take(&mut self.just_struck) {
            self.work(dear_ticks);
        }
        for stream in &mut self.streams {
            if stream.as_ref().is_some_and(Stream::is_over) {
                *stream = None;
            }
        }
        if self.ticks_to_next > 0 {
            self.ticks_to_next -= 1;
            if self.ticks_to_next == 0 {
                self.begin_next();
            }
        }
        if self.ticks_to_next == 0 && self.streams.iter().all(Option::is_none) {
            self.stop();
        }
    }
}
