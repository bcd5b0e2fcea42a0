//! The delay line and the loops that read it.

use super::error::LoopError;
use super::kernel;
use super::resonance::{COARSE, FINE, LINE_BITS, Resonance};
use super::tuning::{Loop, Tuned};
use super::{NOTHING, SILENCE, STILL_S};
use crate::SampleRate;
use crate::fixed::times_q31;
use crate::memory::{Lender, OutOfMemory, Region};
use crate::noise::White;
use crate::table::range::LOOPS as MOST_LOOPS;
use crate::time::TICK_FRAMES;

/// Up to this sum of what may come out of the loops a fine sum has room.
const LARGEST_FINE: f64 = 1.0 / 16.0;
/// Largest s at that scale: 12 dB above full scale. (If it is louder after all, sums saturate for a
/// while.)
const LOUDEST: f64 = 4.0;

/// The shortest time over which the largest word of the line is sought: ticks in which nothing is
/// to be settled cost less.
const SHORTEST_WINDOW: usize = 8 * TICK_FRAMES;

/// Loops on one delay line of s.
// In this order: what a tick asks for is near the start, where the chip reaches it by a short
// address.
#[derive(Debug)]
#[repr(C)]
pub(crate) struct Loops<'m> {
    /// Number of loops.
    count: usize,
    bands: &'m mut [Resonance],
    /// The delay line, a ring, larger than the bus by 2^line_scale.
    line: &'m mut [i32],
    /// The shortest delay, at most a tick.
    shortest: usize,
    /// Index at which s is written next.
    place: usize,
    line_scale: i32,
    sum_scale: i32,
    /// True if sums might not have room, so that they are to saturate.
    loud: bool,
    /// True if a state has left the bounds of its scaling.
    unsettled: bool,
    /// Sizes written since it was last settled, or'ed, and frames since then beyond a tick.
    sizes: u32,
    passed: usize,
    /// Sizes in a window that is longer than the longest delay, so far, and in that before; frames
    /// of the former.
    sizes_of: [u32; 2],
    frames_of_first: usize,
    window: usize,
    line_bits: i32,
    longest: usize,
    /// Bits of the sizes of such a time, for how many frames these have been the same or one more,
    /// and after how many no tail would be.
    tail_bits: i32,
    still_frames: usize,
    most_still_frames: usize,
}

/// Longest delay line in frames: 43 ms at 192 kHz.
pub(crate) const LONGEST_LINE: usize = 8192;
/// Shortest delay line in frames: a ring that turns less often costs less.
const SHORTEST_LINE: usize = 512;

impl<'m> Loops<'m> {
    /// No loops.
    pub(crate) const fn empty() -> Self {
        Self {
            count: 0,
            bands: &mut [],
            line: &mut [],
            shortest: TICK_FRAMES,
            place: 0,
            line_scale: 0,
            sum_scale: FINE,
            loud: false,
            unsettled: false,
            sizes: 0,
            passed: 0,
            sizes_of: [0; 2],
            frames_of_first: 0,
            window: SHORTEST_WINDOW,
            line_bits: LINE_BITS,
            longest: 0,
            tail_bits: 0,
            still_frames: 0,
            most_still_frames: 0,
        }
    }

    /// Frames of the delay line of loops at a rate: the longest delay and a tick, in whole ticks; 0
    /// without loops.
    ///
    /// # Errors
    /// A [`LoopError`] for a loop that cannot be, or whose delay is longer than any line.
    pub(crate) fn line_frames(loops: impl Iterator<Item = Loop>, rate: SampleRate) -> Result<usize, LoopError> {
        let mut longest = None;
        for (index, one) in loops.enumerate() {
            longest = longest.max(Some(Tuned::new(&one, index, LONGEST_LINE, rate)?.delay));
        }
        let frames = longest.map_or(0, |longest| (longest + TICK_FRAMES).next_multiple_of(TICK_FRAMES));
        Ok(if frames > 0 { frames.max(SHORTEST_LINE) } else { 0 })
    }

    /// Takes memory for `count` loops on a line of so many frames.
    pub(crate) fn take(lender: &mut impl Lender<'m>, count: usize, frames: usize) -> Result<Self, OutOfMemory> {
        let bands = lender.take(Region::Bulk, count, || Resonance::EMPTY)?;
        Ok(Self { bands, line: lender.take(Region::Bulk, frames, || 0)?, ..Self::empty() })
    }

    /// Derives loops at rest for a line of s larger than the bus by 2^`line_scale`; `stable` checks
    /// the sum of the loops. Without memory all is derived but the loops themselves.
    pub(crate) fn load(
        &mut self,
        loops: impl Iterator<Item = Loop> + Clone,
        line_scale: i32,
        rate: SampleRate,
        stable: impl FnOnce(&[Tuned]) -> Result<(), LoopError>,
    ) -> Result<(), LoopError> {
        self.rest();
        (self.shortest, self.longest) = (TICK_FRAMES, 0);
        let given = loops.clone().count();
        let mut all = [Tuned::default(); MOST_LOOPS];
        if given > MOST_LOOPS {
            return Err(LoopError::Count { given, room: MOST_LOOPS });
        }
        for (index, (tuned, one)) in all.iter_mut().zip(loops).enumerate() {
            *tuned = Tuned::new(&one, index, LONGEST_LINE, rate)?;
        }
        let all = all.get(..given).unwrap_or(&[]);
        // What memory was taken for: the kernels read within the line for delays below its length
        // alone.
        if !self.bands.is_empty() {
            let room = self.line.len();
            if given != self.bands.len() {
                return Err(LoopError::Count { given, room: self.bands.len() });
            }
            if let Some((index, tuned)) = all.iter().enumerate().find(|(_, tuned)| tuned.delay + TICK_FRAMES > room) {
                return Err(LoopError::Delay { index, frames: tuned.delay as f64, room });
            }
        }
        stable(all)?;
        // Loops of little gain round a filter of much: there a step of the sum is loudest, and
        // there is room for it to be small.
        let largest: f64 = all.iter().map(|tuned| Resonance::largest(tuned, line_scale)).sum();
        let largest = largest * (LOUDEST / libm::scalbn(1.0, LINE_BITS - 27 - line_scale)).min(1.0);
        self.sum_scale = if largest < LARGEST_FINE { FINE } else { COARSE };
        self.line_scale = line_scale;
        for (band, tuned) in self.bands.iter_mut().zip(all) {
            *band = Resonance::new(tuned, line_scale, self.sum_scale);
        }
        for tuned in all {
            self.shortest = self.shortest.min(tuned.delay);
            self.longest = self.longest.max(tuned.delay);
        }
        self.count = given;
        self.window = self.longest.max(SHORTEST_WINDOW);
        self.loud = self.is_loud();
        self.most_still_frames = (STILL_S * rate.hz()) as usize;
        Ok(())
    }

    /// Number of loops.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Nominal cycles of a tick, with what the filter takes more for them: for a block of a whole
    /// tick, each loop, and what further blocks cost; `of_block` are those of the filter itself.
    pub(crate) fn cycles_a_tick(&self, of_block: u32) -> u32 {
        let (loops, blocks) = (self.count as u32, TICK_FRAMES.div_ceil(self.shortest.max(1)) as u32);
        let further = (blocks - 1) * (310 + 84 * loops);
        if loops == 0 { 0 } else { 250 + 376 * loops + further + blocks * of_block }
    }

    /// True if a step of the sums is large ([`COARSE`]).
    pub(crate) fn is_coarse(&self) -> bool {
        self.sum_scale == COARSE
    }

    fn is_loud(&self) -> bool {
        self.bands.iter().map(Resonance::weight).sum::<u64>() > Resonance::LARGEST_WEIGHT
    }

    /// Clears what rings.
    pub(crate) fn rest(&mut self) {
        self.bands.iter_mut().for_each(Resonance::rest);
        self.line.fill(0);
        (self.sizes, self.sizes_of, self.frames_of_first, self.still_frames) = (0, [0; 2], 0, 0);
        self.passed = 0;
        self.line_bits = LINE_BITS;
        self.loud = self.is_loud();
    }

    /// Leaves so much (Q31) of what rings.
    pub(crate) fn attenuate(&mut self, left: i32) {
        for band in self.bands.iter_mut() {
            band.attenuate(left);
        }
        self.unsettled = true;
        self.line.iter_mut().for_each(|s| *s = times_q31(*s, left));
    }

    /// Number of `frames` with a slot that no loop is still to read and in which the ring
    /// does not turn.
    pub(crate) fn slot_length(&self, frames: usize) -> usize {
        frames.min(self.line.len() - self.longest).min(self.line.len() - self.place)
    }

    /// Number of `frames` that can be run at once: no loop reads a frame that is not written.
    pub(crate) fn run_length(&self, frames: usize) -> usize {
        frames.min(self.shortest)
    }

    /// Adds what the loops give over so many frames to what lies in [`slot`](Self::slot), Q29 or
    /// less ([`COARSE`]).
    pub(crate) fn add(&mut self, frames: usize) {
        self.unsettled = if self.loud {
            kernel::portable::run_loud(self.bands, self.line, self.place, frames)
        } else {
            kernel::run(self.bands, self.line, self.place, frames)
        };
    }

    /// As [`add`](Self::add) to noise of a level, of which `draw` draws a whole tick, for one of
    /// the [`whole_ticks`](Self::whole_ticks).
    #[inline(always)]
    pub(crate) fn add_to_noise(&mut self, noise: &mut White, level: i32, draw: impl Fn(&mut White, i32, &mut [i32])) {
        if self.loud {
            draw(noise, level, self.slot(TICK_FRAMES));
            return self.add(TICK_FRAMES);
        }
        // It was settled.
        if kernel::run_on_noise(noise, level, self.bands, self.line, self.place, TICK_FRAMES, draw) {
            self.unsettled = true;
        }
    }

    /// Slot for the next frames of s: what goes into the filter is summed there, and
    /// s left.
    pub(crate) fn slot(&mut self, frames: usize) -> &mut [i32] {
        self.line.get_mut(self.place..self.place + frames).unwrap_or(&mut [])
    }

    /// Moves on behind a slot in which s was left, its sizes or'ed.
    pub(crate) fn advance(&mut self, frames: usize, sizes: u32) {
        self.sizes |= sizes;
        self.place += frames;
        if self.place >= self.line.len() {
            self.place = 0;
        }
    }

    /// Number of ticks that may be run, each in one slot and followed by [`pass`](Self::pass),
    /// before the next [`settle`](Self::settle), as long as [`is_settled`](Self::is_settled).
    pub(crate) fn whole_ticks(&self) -> u32 {
        if self.line.len() < self.longest + TICK_FRAMES {
            return 0;
        }
        let of_window = self.window.saturating_sub(self.frames_of_first) + TICK_FRAMES;
        (of_window.min(self.line.len() - self.place) / TICK_FRAMES) as u32
    }

    /// True if all states, and what is on the line, are within the bounds of their scaling.
    #[inline(always)]
    pub(crate) fn is_settled(&self) -> bool {
        !self.unsettled && self.sizes >> self.line_bits == 0
    }

    /// Counts ticks that have passed since the last [`settle`](Self::settle).
    pub(crate) fn pass(&mut self, whole_ticks: u32) {
        self.passed += (whole_ticks as usize).saturating_sub(1) * TICK_FRAMES;
    }

    /// On a tick: scales states anew. Gives whether a window ended, and whether what was written in
    /// it is no sound.
    ///
    /// If states and line are settled, nothing is to be done but at a window's end: so it is the
    /// same bits that follow, on whichever of the ticks between this is called.
    pub(crate) fn settle(&mut self) -> (bool, bool) {
        self.sizes_of[0] |= core::mem::take(&mut self.sizes);
        self.frames_of_first += core::mem::take(&mut self.passed) + TICK_FRAMES;
        let ended = self.frames_of_first > self.window;
        let silent = ended && self.is_over();
        let line_bits = bits(self.sizes_of[0] | self.sizes_of[1]);
        // What bounds the words bounds smaller ones; two bits more are not worth the time.
        let known = line_bits <= self.line_bits && line_bits + 3 > self.line_bits;
        if !known || self.unsettled {
            self.scale_anew(if known { self.line_bits } else { line_bits });
        }
        (ended, silent)
    }

    /// At a window's end, where the next one begins: whether what was written in it is no sound.
    #[inline(never)]
    fn is_over(&mut self) -> bool {
        let bits = bits(self.sizes_of[0]);
        let is_still = bits == self.tail_bits || bits == self.tail_bits + 1;
        (self.tail_bits, self.still_frames) =
            if is_still { (self.tail_bits, self.still_frames + self.frames_of_first) } else { (bits, 0) };
        (self.sizes_of, self.frames_of_first) = ([0, self.sizes_of[0]], 0);
        let is_below = |steps_bits: i32| bits <= (steps_bits + self.line_scale).max(0);
        is_below(NOTHING) || is_below(SILENCE) && self.still_frames > self.most_still_frames
    }

    /// States, for a line of words below 2^`line_bits`.
    #[inline(never)]
    fn scale_anew(&mut self, line_bits: i32) {
        let known = line_bits == self.line_bits;
        self.line_bits = line_bits;
        for band in self.bands.iter_mut() {
            if !known {
                band.expect(if band.delay < TICK_FRAMES { LINE_BITS } else { line_bits });
            }
            band.settle();
        }
        self.unsettled = false;
        self.loud = self.is_loud();
    }
}

/// Bits of the largest of sizes that were or'ed.
fn bits(sizes: u32) -> i32 {
    32 - sizes.leading_zeros() as i32
}
