//! The head: what a force of this block and the last one makes of the first 2N samples of a
//! response.

use super::kernel::{self, OUTPUTS};
use super::{BLOCK_FRAMES, POINTS};
use crate::fixed;
use crate::memory::{Lender, OutOfMemory, Region};
use crate::time::TICK_FRAMES;

/// Number of taps with the zeros at both ends that [`kernel::convolve`] may reach: before the
/// longest lag for outputs that the block does not have, behind lag 0 for force that is yet to come
/// in a run.
const TAPS: usize = POINTS + OUTPUTS + TICK_FRAMES;

/// Maximum number of groups of outputs in a run.
const GROUPS: usize = TICK_FRAMES.div_ceil(OUTPUTS);

/// Beginning of the response at one position, and the force of two blocks there.
#[derive(Debug)]
pub struct Head<'m> {
    /// Taps `h[lag] 2^exponent`, the longest lag first, between zeros.
    taps: &'m mut [i32],
    exponent: i32,
    /// Position along the object, 0 to 1.
    pub(super) position: f32,
    /// Sums of a run's outputs.
    sums: &'m mut [[i64; OUTPUTS]],
    /// Force of the last block, and of this one.
    history: &'m mut [i32],
    /// For each part of the history the range outside which all is 0.
    forced: [(u16, u16); PARTS],
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
        Self { taps: &mut [], exponent: 0, position: 0.0, sums: &mut [], history: &mut [], forced: [NOTHING; PARTS] }
    }

    /// Takes the memory of a head: 4 KB.
    pub(super) fn take(lender: &mut impl Lender<'m>) -> Result<Self, OutOfMemory> {
        let taps = lender.take(Region::Fast, TAPS, || 0)?;
        let sums = lender.take(Region::Fast, GROUPS, || [0; OUTPUTS])?;
        Ok(Self { taps, sums, history: lender.take(Region::Fast, POINTS, || 0)?, ..Self::empty() })
    }

    /// Taps by lag, for the load: floats by their bits until they are [fixed](fix).
    pub(super) fn by_lag(&mut self) -> impl Iterator<Item = &mut i32> {
        let ends = OUTPUTS - 1;
        self.taps.get_mut(ends..ends + POINTS).unwrap_or(&mut []).iter_mut().rev()
    }

    /// Turns taps that are floats into integers.
    pub(super) fn fix(&mut self) {
        let ends = OUTPUTS - 1;
        self.exponent = self.taps.get_mut(ends..ends + POINTS).map_or(0, fix);
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
        let spans: u32 = self.forced.iter().map(|(first, end)| u32::from(end - first)).sum();
        let parts = self.forced.iter().filter(|range| **range != NOTHING).count() as u32;
        // On average half of the force of a run comes before an output of the run.
        let span = spans + if force { frames / 2 } else { 0 };
        let parts = parts + u32::from(force);
        // 2.2 cycles a product, 60 a part and three outputs.
        frames * (span.min(POINTS as u32) * 22 / 10 + parts * 20 + 80) + 500
    }

    /// True if the force of this block or the last one sounds.
    #[inline(always)]
    pub fn is_active(&self) -> bool {
        self.forced != [NOTHING; PARTS]
    }

    /// Force of the last block; `None` if there was none.
    pub(super) fn last_block(&self) -> Option<&[i32; BLOCK_FRAMES]> {
        let was_forced = self.forced.iter().take(PARTS / 2).any(|range| *range != NOTHING);
        self.history.first_chunk().filter(|_| was_forced)
    }

    /// True if the force of the last block lasted through nearly all of it.
    pub(super) fn is_lasting(&self) -> bool {
        let span = |range: &(u16, u16)| usize::from(range.1 - range.0);
        self.forced.iter().take(PARTS / 2).map(span).sum::<usize>() >= BLOCK_FRAMES / 8 * 7
    }

    /// Begins a block.
    pub(super) fn begin_block(&mut self) {
        if !self.is_active() {
            return;
        }
        if let Some((last, this)) = self.history.split_at_mut_checked(BLOCK_FRAMES) {
            last.iter_mut().zip(this).for_each(|(last, this)| *last = core::mem::take(this));
        }
        let back = |(first, end): (u16, u16)| match end {
            0 => NOTHING,
            _ => (first - BLOCK_FRAMES as u16, end - BLOCK_FRAMES as u16), // of the second block
        };
        let (last, this) = self.forced.split_at_mut(PARTS / 2);
        for (last, this) in last.iter_mut().zip(this) {
            *last = back(core::mem::replace(this, NOTHING));
        }
    }

    /// Adds the head's sound for a run of frames that begins at `frame` of the block to `out`.
    ///
    /// `force` is in bus steps, `None` without any. Each frame takes one product for each sample
    /// from the first to the last of the force in this block and the last one: 2.2 cycles each
    /// ([`kernel::convolve`]).
    pub fn render(&mut self, frame: usize, force: Option<&[i32]>, out: &mut [i32]) {
        let start = BLOCK_FRAMES + frame;
        if let Some(force) = force {
            self.hear(start, force);
        }
        if !self.is_active() {
            return;
        }
        let sums = self.sums.get_mut(..out.len().div_ceil(OUTPUTS)).unwrap_or(&mut []);
        // First frame of the last group.
        let last = start + OUTPUTS * sums.len().saturating_sub(1);
        let mut is_first = true;
        for &range in self.forced.iter().filter(|range| **range != NOTHING) {
            let (first, end) = (usize::from(range.0), usize::from(range.1));
            let force = self.history.get(first..end).unwrap_or(&[]);
            let taps = (POINTS - 1 + first).checked_sub(last).and_then(|at| self.taps.get(at..)).unwrap_or(&[]);
            // Force up to the first group's last output: lags below 0 meet zeros. Places in a
            // history are below 2^10, and the sum of all taps' magnitudes bounds the sums ([`fix`]).
            let count = (start + OUTPUTS) as i32 - first as i32;
            match core::mem::take(&mut is_first) {
                true => kernel::convolve::<false>(force, taps, count, sums),
                false => kernel::convolve::<true>(force, taps, count, sums),
            }
        }
        let sums = out.iter_mut().zip(sums.as_flattened());
        match u32::try_from(self.exponent - 1) {
            // Rounded: half of a step of the shifted sum is its last bit.
            Ok(shift) => {
                sums.for_each(|(out, &sum)| *out = fixed::qadd(*out, fixed::saturate(((sum >> shift) + 1) >> 1)))
            }
            Err(_) => sums.for_each(|(out, &sum)| *out = fixed::qadd(*out, enlarged(sum, self.exponent))),
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

/// Turns heads that hold the bits of floats into integers with one exponent, and gives it.
///
/// The magnitudes of a head's taps add up to less than 2^32, so that with any force the sums stay
/// below 2^63. Heads between two of them have no larger sums.
pub(super) fn fix(taps: &mut [i32]) -> i32 {
    let float = |tap: i32| f32::from_bits(tap as u32);
    let bits = |x: f32| libm::frexpf(x).1;
    let mut exponent = 62;
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

/// Sum of taps and force on the bus, saturating, of taps that add up to 2^31 and more.
#[inline(never)] // no shipped kit has such a head
fn enlarged(sum: i64, exponent: i32) -> i32 {
    fixed::saturate(sum.saturating_mul(1i64 << exponent.unsigned_abs().min(30)))
}
