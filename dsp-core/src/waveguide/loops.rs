//! The delay line and the loops that read it.

use super::error::LoopError;
use super::kernel;
use super::resonance::{COARSE, FINE, LINE_BITS, Resonance};
use super::tuning::{Loop, Tuned};
use super::{NOTHING, SILENCE, STILL_S};
use crate::SampleRate;
use crate::fixed::times_q31;
use crate::memory::{Memory, OutOfMemory, Region};
use crate::noise::White;
use crate::table::range::LOOPS as MOST_LOOPS;
use crate::time::TICK_FRAMES;

/// Bound of the loops' output below which sums are fine ([`FINE`]).
const LARGEST_FINE: f64 = 1.0 / 16.0;
/// Largest s for which that output is bounded: 12 dB above full scale. If s is louder after all,
/// sums saturate for a while.
const LOUDEST: f64 = 4.0;

/// Shortest time in frames over which the largest word of the line is sought. A longer time has
/// more ticks in which nothing is settled, and these cost less.
const SHORTEST_WINDOW: usize = 8 * TICK_FRAMES;

/// Loops that read one delay line of s.
// Fields that every tick reads stand near the start, where the core's short instructions reach
// them.
#[derive(Debug)]
#[repr(C)]
pub(crate) struct Loops<'m> {
    /// Number of loops.
    count: usize,
    /// Band-pass of each loop.
    bands: &'m mut [Resonance],
    /// Delay line, a ring. Its words are larger than the bus by 2^line_scale.
    line: &'m mut [i32],
    /// Shortest delay in frames, at most a tick.
    shortest: usize,
    /// Index at which s is written next.
    place: usize,
    /// E of the line's words.
    line_scale: i32,
    /// E of the sums.
    sum_scale: i32,
    /// True if sums might overflow, so that they are computed with saturation.
    loud: bool,
    /// True if a state has left the bounds of its scaling.
    unsettled: bool,
    /// Sizes of the words written since the last call of `settle`, or'ed.
    sizes: u32,
    /// Number of frames since then, less a tick.
    passed: usize,
    /// Sizes of the words in this window so far and in the window before, each or'ed. A window is
    /// longer than the longest delay.
    sizes_of: [u32; 2],
    /// Number of frames in this window so far.
    frames_of_first: usize,
    /// Number of frames that a window exceeds when it ends.
    window: usize,
    /// Number of bits of the line's words for which the states are scaled.
    line_bits: i32,
    /// Longest delay in frames.
    longest: usize,
    /// Number of bits of the largest word in the window with which `still_frames` began.
    tail_bits: i32,
    /// Number of frames in which the largest word has kept these bits, or had one more.
    still_frames: usize,
    /// Number of still frames that a decaying sound cannot have.
    most_still_frames: usize,
}

/// Longest delay line in frames: 43 ms at 192 kHz.
pub(crate) const LONGEST_LINE: usize = 8192;
/// Shortest delay line in frames. A longer ring turns less often, which costs less.
const SHORTEST_LINE: usize = 512;

impl<'m> Loops<'m> {
    /// Makes an empty set of loops.
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

    /// Number of frames of the delay line that loops need at a rate: the longest delay and a tick,
    /// in whole ticks, and at least [`SHORTEST_LINE`]. It is 0 without loops.
    ///
    /// # Errors
    /// A [`LoopError`] for a loop that is invalid, or whose delay is longer than any line.
    pub(crate) fn line_frames(loops: impl Iterator<Item = Loop>, rate: SampleRate) -> Result<usize, LoopError> {
        let mut longest = None;
        for (index, one) in loops.enumerate() {
            longest = longest.max(Some(Tuned::new(&one, index, LONGEST_LINE, rate)?.delay));
        }
        let frames = longest.map_or(0, |longest| (longest + TICK_FRAMES).next_multiple_of(TICK_FRAMES));
        Ok(if frames > 0 { frames.max(SHORTEST_LINE) } else { 0 })
    }

    /// Takes memory for `count` loops on a line of `frames` frames.
    pub(crate) fn take(memory: &mut Memory<'m>, count: usize, frames: usize) -> Result<Self, OutOfMemory> {
        let bands = memory.take(Region::Bulk, count, || Resonance::EMPTY)?;
        Ok(Self { bands, line: memory.take(Region::Bulk, frames, || 0)?, ..Self::empty() })
    }

    /// Derives loops at rest, for a line whose s is larger than the bus by 2^`line_scale`. `stable`
    /// checks the loops together. Without memory everything but the band-passes is derived.
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
        // The memory must have been taken for these loops: the kernels read within the line only if
        // delays are below its length.
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
        // Loops of little gain round a filter of much gain make a step of the sum loudest. They
        // also leave room for a finer step.
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

    /// Nominal cycles of a tick, with those that the loops cost the filter.
    ///
    /// They are counted for a block of a whole tick, for each loop, and for each further block. The
    /// filter itself takes `of_block` more cycles for each block.
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

    /// Clears all sound.
    pub(crate) fn rest(&mut self) {
        self.bands.iter_mut().for_each(Resonance::rest);
        self.line.fill(0);
        (self.sizes, self.sizes_of, self.frames_of_first, self.still_frames) = (0, [0; 2], 0, 0);
        self.passed = 0;
        self.line_bits = LINE_BITS;
        self.loud = self.is_loud();
    }

    /// Multiplies all sound by `left` (Q31).
    pub(crate) fn attenuate(&mut self, left: i32) {
        for band in self.bands.iter_mut() {
            band.attenuate(left);
        }
        self.unsettled = true;
        self.line.iter_mut().for_each(|s| *s = times_q31(*s, left));
    }

    /// Number of frames, at most `frames`, that have a slot. No loop is still to read words in the
    /// slot, and the ring does not turn in it.
    pub(crate) fn slot_length(&self, frames: usize) -> usize {
        frames.min(self.line.len() - self.longest).min(self.line.len() - self.place)
    }

    /// Number of frames, at most `frames`, that can be run at once. No loop reads a frame in them
    /// that is not written yet.
    pub(crate) fn run_length(&self, frames: usize) -> usize {
        frames.min(self.shortest)
    }

    /// Adds the loops' output over `frames` frames to the sums in [`slot`](Self::slot), which are
    /// Q29 or less ([`COARSE`]).
    pub(crate) fn add(&mut self, frames: usize) {
        self.unsettled = if self.loud {
            kernel::portable::run_loud(self.bands, self.line, self.place, frames)
        } else {
            kernel::run(self.bands, self.line, self.place, frames)
        };
    }

    /// Writes noise of a level to the slot and adds the loops' output, as [`add`](Self::add) does,
    /// for one of the [`whole_ticks`](Self::whole_ticks). `draw` draws noise.
    #[inline(always)]
    pub(crate) fn add_to_noise(&mut self, noise: &mut White, level: i32, draw: impl Fn(&mut White, i32, &mut [i32])) {
        if self.loud {
            draw(noise, level, self.slot(TICK_FRAMES));
            return self.add(TICK_FRAMES);
        }
        // The loops were settled before this tick, so the flag need not be cleared.
        if kernel::run_on_noise(noise, level, self.bands, self.line, self.place, TICK_FRAMES, draw) {
            self.unsettled = true;
        }
    }

    /// Slot for the next frames of s. The filter's input is summed in it, and the filter leaves s
    /// in it.
    pub(crate) fn slot(&mut self, frames: usize) -> &mut [i32] {
        self.line.get_mut(self.place..self.place + frames).unwrap_or(&mut [])
    }

    /// Moves on behind a slot in which s was left. `sizes` are the sizes of s, or'ed.
    pub(crate) fn advance(&mut self, frames: usize, sizes: u32) {
        self.sizes |= sizes;
        self.place += frames;
        if self.place >= self.line.len() {
            self.place = 0;
        }
    }

    /// Number of ticks that may be run, each in one slot, before the next [`settle`](Self::settle),
    /// as long as [`is_settled`](Self::is_settled). Count them by [`pass`](Self::pass).
    pub(crate) fn whole_ticks(&self) -> u32 {
        if self.line.len() < self.longest + TICK_FRAMES {
            return 0;
        }
        let of_window = self.window.saturating_sub(self.frames_of_first) + TICK_FRAMES;
        (of_window.min(self.line.len() - self.place) / TICK_FRAMES) as u32
    }

    /// True if all states, and the words on the line, are within the bounds of their scaling.
    #[inline(always)]
    pub(crate) fn is_settled(&self) -> bool {
        !self.unsettled && self.sizes >> self.line_bits == 0
    }

    /// Counts ticks that have passed since the last [`settle`](Self::settle).
    pub(crate) fn pass(&mut self, whole_ticks: u32) {
        self.passed += (whole_ticks as usize).saturating_sub(1) * TICK_FRAMES;
    }

    /// Scales states anew on a tick. Gives two flags: the first is true if a window ended, the
    /// second if the words written in it are no sound.
    ///
    /// If states and line are settled, there is nothing to do except at a window's end. So the bits
    /// do not depend on the ticks between at which this is called.
    pub(crate) fn settle(&mut self) -> (bool, bool) {
        self.sizes_of[0] |= core::mem::take(&mut self.sizes);
        self.frames_of_first += core::mem::take(&mut self.passed) + TICK_FRAMES;
        let ended = self.frames_of_first > self.window;
        let silent = ended && self.is_over();
        let line_bits = bits(self.sizes_of[0] | self.sizes_of[1]);
        // A bound holds for smaller words too. Up to two bits to spare are not worth the time.
        let known = line_bits <= self.line_bits && line_bits + 3 > self.line_bits;
        if !known || self.unsettled {
            self.scale_anew(if known { self.line_bits } else { line_bits });
        }
        (ended, silent)
    }

    /// Ends a window and begins the next one. Gives true if the words written in the old window are
    /// no sound.
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

    /// Scales the states for a line of words below 2^`line_bits`.
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

/// Number of bits of the largest of sizes that were or'ed.
fn bits(sizes: u32) -> i32 {
    32 - sizes.leading_zeros() as i32
}
