//! The head: what a force of this block and the last one makes of the first 2N samples of a
//! response.

use super::hand::Decay;
use super::kernel::{self, Convolution, SAMPLES, TAPS, ZEROS};
use super::samples::rounded;
use super::{BLOCK_FRAMES, LINES, POINTS};
use crate::fixed;
use crate::fourier::Complex;
use crate::memory::{Memory, OutOfMemory, Region};
use crate::time::TICK_FRAMES;

/// Places of the taps between the zeros.
const TAPS_OF_LAGS: core::ops::Range<usize> = ZEROS[0]..ZEROS[0] + POINTS;

/// Largest exponent of taps: half a bus step fits into the sums beside any product.
const MAX_EXPONENT: i32 = 50;

/// Beginning of the response at one position, and the force of two blocks there.
#[derive(Debug)]
pub struct Head<'m> {
    /// Taps `h[lag] 2^exponent`, the longest lag first, between zeros.
    taps: &'m mut [i32],
    exponent: i32,
    /// Position along the object, 0 to 1.
    pub(super) position: f32,
    /// Force of the last block, and of this one.
    history: &'m mut [i32],
    /// For each part of the history the range outside which all is 0.
    forced: [(u16, u16); PARTS],
    /// Lines 0 to N of the taps' spectrum, times 1/2N; empty without a tail.
    response: &'m mut [Complex],
    tail: Tail,
}

/// Sound that the last block's force makes in this block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tail {
    /// The products of taps and force make it throughout the block.
    Direct,
    /// A transform makes it in this block; until then the products do.
    Due,
    /// It lies in the history, in the place of the last block's force.
    Ready,
}

/// Number of parts of a history, half blocks: most of the time between two strikes that are 5 ms
/// apart costs no product. With a part a tick, 256 modes struck each millisecond cost 7 % more.
const PARTS: usize = 4;
const PART: usize = POINTS / PARTS;
/// Range of a part without force.
const NOTHING: (u16, u16) = (0, 0);

impl<'m> Head<'m> {
    /// A head without taps, whose output is silent.
    pub(super) const fn empty() -> Self {
        Self {
            taps: &mut [],
            exponent: 0,
            position: 0.0,
            history: &mut [],
            forced: [NOTHING; PARTS],
            response: &mut [],
            tail: Tail::Direct,
        }
    }

    /// Takes the memory of a head: 4 KB, and 2 KB more for tails.
    pub(super) fn take(memory: &mut Memory<'m>, has_tails: bool) -> Result<Self, OutOfMemory> {
        let taps = memory.take(Region::Fast, TAPS, || 0)?;
        let history = memory.take(Region::Fast, POINTS, || 0)?;
        let lines = if has_tails { LINES } else { 0 };
        Ok(Self { taps, history, response: memory.take(Region::Fast, lines, || [0.0; 2])?, ..Self::empty() })
    }

    /// Taps by lag as numbers, and the place of their spectrum; `None` without tails.
    pub(super) fn taps_and_response(&mut self) -> Option<(impl Iterator<Item = f32>, &mut [Complex])> {
        let step = libm::scalbnf(1.0, -self.exponent);
        let taps = self.taps.get(TAPS_OF_LAGS)?.iter().rev().map(move |&tap| tap as f32 * step);
        Some((taps, &mut *self.response)).filter(|(_, lines)| !lines.is_empty())
    }

    /// Number of samples of the last block that the products take; 0 without tails.
    pub(super) fn last_span(&self) -> u32 {
        let [first, second, ..] = self.forced;
        let span = |(first, end): (u16, u16)| u32::from(end - first);
        if self.response.is_empty() { 0 } else { span(first) + span(second) }
    }

    /// Says that a transform makes the tail of this block.
    pub(super) fn want_tail(&mut self) {
        self.tail = Tail::Due;
    }

    /// Spectrum of the taps if a tail is to be made, else `None`.
    pub(super) fn tail_response(&self) -> Option<&[Complex]> {
        (self.tail == Tail::Due).then_some(&*self.response)
    }

    /// Place for the tail of this block, which stands for the last block's force from now on.
    pub(super) fn begin_tail(&mut self) -> Option<&mut [i32; BLOCK_FRAMES]> {
        self.forced.iter_mut().take(PARTS / 2).for_each(|range| *range = NOTHING);
        self.tail = Tail::Ready;
        self.history.first_chunk_mut()
    }

    /// Taps by lag, for the load: floats by their bits until they are [fixed](fix).
    pub(super) fn by_lag(&mut self) -> impl Iterator<Item = &mut i32> {
        self.taps.get_mut(TAPS_OF_LAGS).unwrap_or(&mut []).iter_mut().rev()
    }

    /// Turns taps that are floats into integers.
    pub(super) fn fix(&mut self) {
        self.exponent = self.taps.get_mut(TAPS_OF_LAGS).map_or(0, fix);
    }

    /// Takes the taps between two heads by lag, all fixed with one exponent.
    pub(super) fn set(&mut self, [low, high]: [&[i32]; 2], fraction: f32, exponent: i32) {
        self.exponent = exponent;
        for ((tap, &low), &high) in self.by_lag().zip(low).zip(high) {
            *tap = low + ((high - low) as f32 * fraction) as i32;
        }
    }

    /// Nominal cycles of a run of frames; with `force` the force acts through all of it.
    pub(super) fn cycles(&self, frames: u32, force: bool) -> u32 {
        if !force && !self.is_active() {
            return 0;
        }
        let (mut spans, mut count) = (0, 0);
        for (first, end) in self.forced {
            spans += u32::from(end - first);
            count += u32::from(end > 0);
        }
        // A force of a run goes on from the last one, or begins a part.
        let parts = count + u32::from(force);
        let span = spans + if force { frames } else { 0 };
        // 2.0 cycles a product, and the loop around it.
        frames * (span.min(POINTS as u32) * 2 + parts * 18 + 10) + 1200
    }

    /// True if the force of this block or the last one sounds.
    #[inline(always)]
    pub fn is_active(&self) -> bool {
        self.forced != [NOTHING; PARTS] || self.tail == Tail::Ready
    }

    /// True if this block has had a force.
    pub(super) fn is_forced(&self) -> bool {
        self.forced.iter().skip(PARTS / 2).any(|range| *range != NOTHING)
    }

    /// Force of the last block; `None` if there was none.
    pub(super) fn last_block(&self) -> Option<&[i32; BLOCK_FRAMES]> {
        let was_forced = self.forced.iter().take(PARTS / 2).any(|range| *range != NOTHING);
        self.history.first_chunk().filter(|_| was_forced)
    }

    /// Forgets all force.
    pub(super) fn rest(&mut self) {
        self.history.fill(0);
        (self.forced, self.tail) = ([NOTHING; PARTS], Tail::Direct);
    }

    /// Begins a block, under a hand or not.
    pub(super) fn begin_block(&mut self, hand: Option<&Decay>) {
        if !self.is_active() {
            return;
        }
        if let Some((last, this)) = self.history.split_at_mut_checked(BLOCK_FRAMES) {
            for (last, this) in last.as_chunks_mut().0.iter_mut().zip(this.as_chunks_mut().0) {
                let [a, b, c, d] = *this;
                (*last, *this) = ([a, b, c, d], [0; 4]);
            }
        }
        self.tail = Tail::Direct;
        let back = |(first, end): (u16, u16)| match end {
            0 => NOTHING,
            _ => (first - BLOCK_FRAMES as u16, end - BLOCK_FRAMES as u16), // of the second block
        };
        let (last, this) = self.forced.split_at_mut(PARTS / 2);
        for (last, this) in last.iter_mut().zip(this) {
            *last = back(core::mem::replace(this, NOTHING));
        }
        if let Some(hand) = hand {
            let left = hand.of_block();
            for &(first, end) in &*last {
                let force = self.history.get_mut(usize::from(first)..usize::from(end)).unwrap_or(&mut []);
                force.iter_mut().for_each(|force| *force = rounded(*force as f32 * left));
            }
        }
    }

    /// Adds the head's sound for a run of frames that begins at `frame` of the block to `out`.
    ///
    /// `force` is in bus steps, `None` without any. Each frame takes one product for each sample
    /// from the first to the last of the force in this block and the last one: 2.0 cycles each
    /// ([`kernel::convolve`]).
    pub(super) fn render(&mut self, frame: usize, force: Option<&[i32]>, out: &mut [i32]) {
        let start = BLOCK_FRAMES + frame;
        if let Some(force) = force {
            self.hear(start, force);
        }
        if !self.is_active() {
            return;
        }
        if self.tail == Tail::Ready {
            let tail = self.history.get(frame..BLOCK_FRAMES).unwrap_or(&[]);
            out.iter_mut().zip(tail).for_each(|(out, &tail)| *out = fixed::qadd(*out, tail));
        }
        let (ranges, count) = merged(&self.forced);
        let (Some(ranges), Some(taps), Some(force)) =
            (ranges.get(..count), self.taps.first_chunk(), self.history.first_chunk())
        else {
            return;
        };
        // The sum of all taps' magnitudes bounds the sums ([`fix`]).
        kernel::convolve(&Convolution { taps, exponent: self.exponent, force, ranges }, start, out);
    }

    /// Adds the head's sound under a hand, of a run within a tick, as [`Head::render`] does.
    ///
    /// The history holds each force as small as it would be at the end of the block. So no sum is
    /// larger than without the hand; the outputs are raised again, up to 16 times.
    #[inline(never)] // its buffers must not weigh on pads without a hand
    pub(super) fn render_under(&mut self, hand: &Decay, frame: usize, force: Option<&[i32]>, out: &mut [i32]) {
        let (mut faded, mut sound) = ([0; TICK_FRAMES], [0; TICK_FRAMES]);
        let left = hand.until_end(frame);
        let force = force.and_then(|force| {
            let faded = faded.get_mut(..force.len())?;
            for ((faded, &force), left) in faded.iter_mut().zip(force).zip(left.clone()) {
                *faded = rounded(force as f32 * left);
            }
            Some(&*faded)
        });
        let Some(sound) = sound.get_mut(..out.len()) else { return };
        self.render(frame, force, sound);
        if !self.is_active() {
            return;
        }
        for ((out, &sound), left) in out.iter_mut().zip(&*sound).zip(left) {
            *out = fixed::qadd(*out, rounded(sound as f32 / left));
        }
    }

    /// Notes a force that begins at a place of the history.
    fn hear(&mut self, start: usize, force: &[i32]) {
        let Some(place) = self.history.get_mut(start..start + force.len()) else { return };
        let is_any = |x: &i32| *x != 0;
        let (Some(first), Some(last)) = (force.iter().position(is_any), force.iter().rposition(is_any)) else { return };
        place.iter_mut().zip(force).for_each(|(place, &x)| *place = x);
        // A run lies within a tick.
        const { assert!(PART.is_multiple_of(TICK_FRAMES)) };
        let Some(range) = self.forced.get_mut(start / PART) else { return };
        let (first, end) = ((start + first) as u16, (start + last + 1) as u16); // a history has 2N samples
        *range = if *range == NOTHING { (first, end) } else { (range.0.min(first), range.1.max(end)) };
    }
}

/// Longest gap between two ranges that costs less to multiply than a range more, in samples.
const GAP: u16 = 16;

/// Ranges of a history in whole steps of [`kernel::convolve`], one for those that follow each other
/// without a long gap, and their number.
fn merged(forced: &[(u16, u16); PARTS]) -> ([[u16; 2]; PARTS], usize) {
    const STEP: u16 = SAMPLES as u16;
    let (mut ranges, mut count) = ([[0; 2]; PARTS], 0usize);
    for &(first, end) in forced.iter().filter(|range| **range != NOTHING) {
        let range = [first - first % STEP, end.next_multiple_of(STEP)];
        match count
            .checked_sub(1)
            .and_then(|last| ranges.get_mut(last))
            .filter(|last| range[0].saturating_sub(last[1]) <= GAP)
        {
            Some(last) => last[1] = range[1],
            None => {
                if let Some(place) = ranges.get_mut(count) {
                    *place = range;
                }
                count += 1;
            }
        }
    }
    (ranges, count)
}

/// Turns heads that hold the bits of floats into integers with one exponent, and gives it.
///
/// The magnitudes of a head's taps add up to less than 2^32, so that with any force and with half a
/// bus step the sums stay below 2^63. Heads between two of them have no larger sums.
pub(super) fn fix(taps: &mut [i32]) -> i32 {
    let float = |tap: i32| f32::from_bits(tap as u32);
    let bits = |x: f32| libm::frexpf(x).1;
    let mut exponent = MAX_EXPONENT;
    for head in taps.chunks(POINTS) {
        let (sum, largest) = head.iter().fold((0.0f32, 0.0f32), |(sum, largest), &tap| {
            let size = float(tap).abs();
            (sum + size, largest.max(size))
        });
        // A little more, for what the taps are rounded up.
        exponent = exponent.min(32 - bits(1.001 * sum)).min(30 - bits(largest));
    }
    for tap in taps {
        *tap = libm::rint(libm::scalbn(f64::from(float(*tap)), exponent)) as i32;
    }
    exponent
}
