//! Share of each tick in the work on frames to come.
//!
//! A frame is made in the 23 ticks before it, in even shares, less what its streams cost while one
//! fades into the other. Where pads in frames make ticks dear, the work waits for the ticks behind
//! them.

use super::bands::FRAME_TICKS;
use super::job::Job;
use super::shaper::Shaper;
use super::stream::Stream;

/// Cycles a tick for making the noise of the next strike, which takes some 200 ms with a hundred
/// bands.
const RENEWAL_CYCLES: u32 = 400;
/// Cycles a tick of a stream that fades out, and of another one's fading in beyond its sounding.
/// Chosen such that the dearest ticks are cheapest.
const STREAM_CYCLES: u32 = 1_300;

/// Largest share of a tick after dear ones, in percent of an even share. With it such a tick and a
/// dear one take about as long, for a pad of 250 modes in frames and a hundred bands.
const MOST_PERCENT: u32 = 250;

impl Shaper<'_> {
    /// Approximate cycles of this tick's work, strikes aside; `dear_ticks` as of
    /// [`end_tick`](Self::end_tick).
    pub fn cycles_ahead(&self, dear_ticks: u32) -> u32 {
        let renewal = if dear_ticks == 0 && self.wants_renewal() { RENEWAL_CYCLES } else { 0 };
        if self.job.is_some() && self.ticks_to_next > 0 { self.share(dear_ticks) + renewal } else { 0 }
    }

    /// Nominal cycles of the dearest tick with a number of bands: strikes on strikes, whose frames
    /// carry both, with four streams at once.
    pub fn dearest_tick(bands: usize) -> u32 {
        Job::cycles(bands, true) / FRAME_TICKS + RENEWAL_CYCLES + 2 * STREAM_CYCLES
    }

    /// Nominal cycles of the dearest of the ticks that others make dear: most of the work waits.
    /// Two blocks in a row are dear where a contact crosses from one to the next, 16 of 23 ticks.
    pub fn dear_tick(bands: usize) -> u32 {
        let later = 7 * MOST_PERCENT / 100;
        Job::cycles(bands, true) / FRAME_TICKS * (23 - later) / 16 + 2 * STREAM_CYCLES
    }

    /// Cycles of this tick's share of the next frame, less the cost of the streams that end before
    /// that frame begins.
    fn share(&self, dear_ticks: u32) -> u32 {
        let Some(job) = &self.job else { return 0 };
        let (mut left, mut streams) = (job.left(), 0);
        for ticks in self.streams.iter().flatten().filter_map(Stream::ticks_to_end) {
            (left, streams) = (left + ticks * STREAM_CYCLES, streams + STREAM_CYCLES);
        }
        let ticks = self.ticks_to_next.max(1);
        // A strike's tick leaves no time.
        let (even, planned) = (left / ticks, Job::cycles(self.bands.count(), true) / (FRAME_TICKS - 1));
        let most = planned * MOST_PERCENT / 100;
        let share = match dear_ticks.min(ticks) {
            // The work that has waited is done soon, because a next strike makes ticks dear again.
            0 if self.has_waited => left.saturating_sub((ticks - 1) * planned).min(most).max(even),
            0 => even,
            dear => even.min(left.saturating_sub((ticks - dear) * most) / dear),
        };
        share.saturating_sub(streams)
    }

    /// True if the next strike has no new noise yet and there is time to make it.
    fn wants_renewal(&self) -> bool {
        self.onset.is_used && !self.in_onset
    }

    /// Does this tick's share of the work for the next frame.
    pub(super) fn work(&mut self, dear_ticks: u32) {
        let share = if self.ticks_to_next > 1 { self.share(dear_ticks) } else { u32::MAX };
        self.has_waited |= dear_ticks > 0;
        if let Some(job) = self.job.as_mut()
            && let Some(memory) = self.waves.get_mut(job.region)
        {
            job.advance(&mut self.bands, memory, &mut self.noise, share);
            if !self.in_onset && job.is_below(self.silence, 1.0) {
                self.job = None;
            }
        }
        if dear_ticks == 0 && self.wants_renewal() {
            self.renew();
        }
    }

    /// Makes some of the new noise for the next strike.
    #[inline(never)]
    fn renew(&mut self) {
        if self.renewal.is_none() {
            self.renewal = self.free_region().map(|region| self.onset.renewal(region, &self.bands));
        }
        if let Some(renewal) = self.renewal.as_mut()
            && let Some(memory) = self.waves.get_mut(renewal.region)
        {
            renewal.advance(&self.bands, memory, &mut self.noise, RENEWAL_CYCLES);
            if renewal.is_over() {
                self.onset.renew(renewal);
                self.renewal = None;
            }
        }
    }

    pub(super) fn begin_next(&mut self) {
        if core::mem::take(&mut self.in_onset) {
            self.streams.iter_mut().flatten().for_each(Stream::end);
        }
        self.ticks_since = 0;
        let more = self.settle_choke();
        let silence = self.silence;
        let job = self.job.take().map(|job| (job, job.kept(more)));
        let Some((job, kept)) = job.filter(|(job, kept)| !job.is_below(silence, *kept)) else {
            // The frame would be inaudible: the streams that still sound fade out.
            self.bands.clear();
            return;
        };
        self.add_stream(job.stream(kept));
        self.ticks_to_next = FRAME_TICKS;
        let passage = job.onward();
        self.make(passage, FRAME_TICKS, passage.is_struck());
    }
}
