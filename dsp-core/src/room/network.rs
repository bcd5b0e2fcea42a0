//! One band's feedback delay network: eight lines, an orthogonal mix that slowly turns, one gain a line.
//!
//! ```text
//!        ┌─────────────────────────────────────────────────────────┐
//!   x ─►(+)─► line 1..8, z^-m ─► g = 10^(-3 m/(fs T60)) ─► mix ─┬─┘
//!                                                               └─► outputs 1 and 4 ─► left, right
//! ```
//!
//! All lines lose the same decibels a second, so that every resonance of the band has exactly the table's T60: there is no absorption filter to be inexact.
//! The mix is three stages of butterflies; in the first, two of the four are rotations by an angle that turns with time, which moves
//! the resonances before they can stand out. It is orthogonal at each moment, hence never adds energy.
//!
//! **Nothing wraps.** Let all that a tick reads be at most X in size, after gains below 1. Stage one halves: outputs are at most `X cos/2 + X sin/2 < 0.71 X`
//! (rotations) or `2·X/√8 < 0.71 X` (the others, whose gains hold the factor 1/√8). Each later stage adds two: at most 1.42 X, then 2.84 X. With an input of at most
//! the same power of two that bounds X, what is stored is below 3.84 times that power, that is below `2^(bits + 2)`: the size for which the tick's
//! exponent is chosen. Stored sizes are clipped to ±2.0 where that bound is above it, so that X <= 2^28 and no sum reaches 2^31. The network being orthogonal
//! and its gains below 1, its energy never exceeds what came in: an impulse of full scale puts at most 8/4 into it, half a unit into each line, and can neither
//! wrap nor clip at 2.0.

use super::plan::{BandPlan, MAX_TICKS};
use super::storage::{CLIP_BITS, Sample};
use super::turn::Turn;
use crate::fixed;
use crate::resonator::TICK_FRAMES;

/// Lines of a network.
pub(super) const LINES: usize = 8;
/// What of the input each line takes, where a plan's output gain is meant.
pub(super) const INPUT_GAIN: f64 = 1.0;
/// Samples that are mixed by the same angle.
const TURN_SAMPLES: usize = 8;
/// Ticks whose exponents are remembered: more than the longest line has, and what a byte counts round.
const HISTORY: usize = 256;
const _: () = assert!(MAX_TICKS + 2 < HISTORY);
/// 1/√8, for lines whose butterfly is not a rotation.
const PLAIN: f64 = 0.353_553_390_593_273_8;

/// The working values of a tick, line by line.
pub(super) type Work = [[i32; TICK_FRAMES]; LINES];

/// What a tick of a network needs for itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scratch {
    work: Work,
    /// Input, and then both outputs.
    sound: [[i32; 2]; TICK_FRAMES],
}

impl Scratch {
    pub(super) const EMPTY: Self = Self { work: [[0; TICK_FRAMES]; LINES], sound: [[0; 2]; TICK_FRAMES] };
}

/// A network's fixed numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetworkConfig {
    lines: [Line; LINES],
    block: u8,
    /// Output gain as a Q32 mantissa times 2^shift.
    output: i32,
    output_shift: i32,
    /// Samples of at most this many bits are inaudible.
    inaudible_bits: i32,
    /// Ticks after which nothing is left of a sample but what was mixed again.
    longest_ticks: u8,
}

/// A delay line's fixed numbers.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Where it begins in the network's memory, and how long it is.
    start: u16,
    delay: u16,
    /// A [`Sample::gain`].
    gain: i32,
    /// Ticks since the first sample that a tick reads was stored.
    ticks: u8,
    /// Samples that the tick reads before it comes to those that were stored a tick later; a whole block where it does not.
    seam: u8,
}

impl Line {
    const NONE: Self = Self { start: 0, delay: 0, gain: 0, ticks: 0, seam: 0 };

    fn new(start: usize, delay: usize, gain: i32, block: usize) -> Self {
        let ticks = delay.div_ceil(block);
        let seam = block - (ticks * block - delay);
        Self { start: start as u16, delay: delay as u16, gain, ticks: ticks as u8, seam: seam as u8 }
    }
}

/// What a network remembers besides its lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetworkState {
    /// Where each line is read and written next.
    positions: [u16; LINES],
    /// Of each of the last ticks: exponent (low 4 bits) and bits of the stored sizes (high 4 bits; 0: nothing but zeros).
    history: [u8; HISTORY],
    /// Where the next tick goes in `history`.
    now: u8,
    /// Ticks since something audible was stored.
    quiet_ticks: u8,
    /// Whether all is zero.
    silent: bool,
}

impl NetworkState {
    pub(super) const SILENT: Self =
        Self { positions: [0; LINES], history: [0; HISTORY], now: 0, quiet_ticks: 0, silent: true };
}

impl NetworkConfig {
    pub(super) const NONE: Self =
        Self { lines: [Line::NONE; LINES], block: 1, output: 0, output_shift: 0, inaudible_bits: 0, longest_ticks: 0 };

    pub(super) fn new<T: Sample>(plan: &BandPlan) -> Self {
        let (mut lines, mut start) = ([Line::NONE; LINES], 0);
        for (index, (line, (&delay, &gain))) in lines.iter_mut().zip(plan.delays.iter().zip(&plan.gains)).enumerate() {
            let gain = T::gain(if index < LINES / 2 { gain } else { gain * PLAIN });
            *line = Line::new(start, delay, gain, plan.block());
            start += delay;
        }
        let output = libm::scalbn(plan.output, T::INPUT_SHIFT);
        let (fraction, exponent) = libm::frexp(output);
        // Mantissas below 1/2.
        let mantissa = libm::rint(fraction * 2_147_483_647.0) as i32;
        // A size of 2^b sounds at most 2.84 · 2^b · output; that shall stay below -110 dBFS, 2^8.72 of the bus.
        let inaudible_bits = libm::floor(8.72 - libm::log2(2.84 * output.max(1e-30))) as i32;
        let longest = plan.delays.iter().fold(0, |longest, &delay| longest.max(delay));
        Self {
            lines,
            block: plan.block() as u8,
            output: mantissa,
            output_shift: exponent + 1,
            // Rounding keeps four bits alive in a long tail.
            inaudible_bits: inaudible_bits.clamp(4, 20),
            longest_ticks: (longest.div_ceil(plan.block()) + 1).min(HISTORY - 1) as u8,
        }
    }

    /// Whether a tick can be left out: all is zero, and so is what can be heard of the input.
    pub(super) fn sleeps<T: Sample>(&self, state: &NetworkState, input: &[i32]) -> bool {
        state.silent && bits(input) - T::INPUT_SHIFT <= self.inaudible_bits
    }

    /// A tick: `input` in Q4.27, its block long; the output is added to `out`.
    pub(super) fn render<T: Sample>(
        &self,
        state: &mut NetworkState,
        memory: &mut [T],
        input: &[i32],
        turn: &Turn,
        Scratch { work, sound }: &mut Scratch,
        out: &mut [[i32; 2]],
    ) {
        let (pasts, loudest) = self.look_back(state);
        let bits = loudest.bits.max(bits(input) - T::INPUT_SHIFT).max(0) + 2;
        let exponent = T::exponent(bits, loudest.exponent);
        self.take_all(state, memory, &pasts, exponent, work);
        let shift = T::FRACTION - exponent;
        let Some(sound) = sound.get_mut(..usize::from(self.block)) else { return };
        let shifts = Shifts { input: shift - T::INPUT_SHIFT, output: self.output_shift - shift };
        self.mix::<T>(turn, input, work, sound, shifts);
        self.radiate(sound, out, shifts.output);
        let size = self.put_all(state, memory, work, (bits > CLIP_BITS).then_some(exponent));
        self.remember(state, exponent, size);
    }
}

/// From the bus to working values and back, to the left.
#[derive(Clone, Copy)]
struct Shifts {
    input: i32,
    output: i32,
}

/// Of all that a tick reads.
#[derive(Clone, Copy)]
struct Loudest {
    /// Bits of the sizes in Q4.27.
    bits: i32,
    exponent: i32,
}

impl NetworkState {
    fn past(&self, ticks: u8) -> u8 {
        self.history.get(usize::from(self.now.wrapping_sub(ticks))).copied().unwrap_or(0)
    }
}

impl NetworkConfig {
    /// What each line reads first and last, and the loudest of all.
    fn look_back(&self, state: &NetworkState) -> ([[u8; 2]; LINES], Loudest) {
        let mut pasts = [[0; 2]; LINES];
        let mut loudest = Loudest { bits: 0, exponent: 0 };
        for (pasts, line) in pasts.iter_mut().zip(&self.lines) {
            let earlier = state.past(line.ticks);
            let later = if line.seam < self.block { state.past(line.ticks.wrapping_sub(1)) } else { earlier };
            *pasts = [earlier, later];
            for past in [earlier, later] {
                let (exponent, bits) = (i32::from(past & 15), i32::from(past >> 4));
                // Nothing but zeros has no exponent.
                let exponent = if bits > 0 { exponent } else { 0 };
                loudest = Loudest { bits: loudest.bits.max(bits + exponent), exponent: loudest.exponent.max(exponent) };
            }
        }
        (pasts, loudest)
    }

    /// Reads a block of every line, times its gain, as working values.
    #[inline(never)]
    fn take_all<T: Sample>(
        &self,
        state: &NetworkState,
        memory: &[T],
        pasts: &[[u8; 2]; LINES],
        exponent: i32,
        work: &mut Work,
    ) {
        for (((line, pasts), &position), work) in self.lines.iter().zip(pasts).zip(&state.positions).zip(work) {
            let (start, delay, position) = (usize::from(line.start), usize::from(line.delay), usize::from(position));
            let Some(work) = work.get_mut(..usize::from(self.block)) else { return };
            let Some(memory) = memory.get(start..start + delay) else { return };
            let gain_of = |past: u8| match past >> 4 {
                0 => 0,
                _ => T::raise(line.gain, i32::from(past & 15) - exponent),
            };
            let &[earlier, later] = pasts;
            if earlier == later {
                take(memory, position, gain_of(earlier), work);
                continue;
            }
            let (before, after) = work.split_at_mut(usize::from(line.seam).min(work.len()));
            take(memory, position, gain_of(earlier), before);
            take(memory, position + usize::from(line.seam), gain_of(later), after);
        }
    }

    /// Mixes a tick, a few samples at a time by the same angle; leaves both outputs in `sound`.
    fn mix<T: Sample>(&self, turn: &Turn, input: &[i32], work: &mut Work, sound: &mut [[i32; 2]], shifts: Shifts) {
        let (left, right) = (shifts.input.max(0).unsigned_abs(), shifts.input.min(0).unsigned_abs());
        let (left, right) = (left.min(31), right.min(31));
        for (sound, &x) in sound.iter_mut().zip(input) {
            sound[0] = (x << left) >> right;
        }
        let parts = sound.len().div_ceil(TURN_SAMPLES);
        for (part, sound) in sound.chunks_mut(TURN_SAMPLES).enumerate() {
            T::mix(work, part * TURN_SAMPLES, sound, turn.at(part, parts));
        }
    }

    /// Adds both outputs, times the output gain.
    fn radiate(&self, sound: &[[i32; 2]], out: &mut [[i32; 2]], shift: i32) {
        if shift <= 0 {
            let right = shift.unsigned_abs().min(31);
            for ([left_out, right_out], &[left, other]) in out.iter_mut().zip(sound) {
                *left_out = left_out.saturating_add(fixed::smmulr(left, self.output) >> right);
                *right_out = right_out.saturating_add(fixed::smmulr(other, self.output) >> right);
            }
            return;
        }
        let left = shift.unsigned_abs().min(31);
        let most = i32::MAX >> left;
        for (out, &y) in out.as_flattened_mut().iter_mut().zip(sound.as_flattened()) {
            *out = out.saturating_add(fixed::smmulr(y, self.output).clamp(-most, most) << left);
        }
    }

    /// Writes a block of every line where it was read; gives the bits of the largest size. Clips where the sizes may need it.
    fn put_all<T: Sample>(&self, state: &mut NetworkState, memory: &mut [T], work: &Work, clipped: Option<i32>) -> u32 {
        let mut size = 0;
        for ((line, position), work) in self.lines.iter().zip(&mut state.positions).zip(work) {
            let (start, delay) = (usize::from(line.start), usize::from(line.delay));
            let Some(line) = memory.get_mut(start..start + delay) else { return size };
            let Some(work) = work.get(..usize::from(self.block)) else { return size };
            let Some((before, after)) = line.split_at_mut_checked(usize::from(*position)) else { return size };
            let (to_end, from_start) = work.split_at(after.len().min(work.len()));
            let put = |work: &[i32], line: &mut [T]| match clipped {
                None => T::put(work, line),
                Some(exponent) => T::put_clipped(work, line, exponent),
            };
            size = size.max(put(to_end, after));
            if !from_start.is_empty() {
                size = size.max(put(from_start, before));
            }
            let next = usize::from(*position) + work.len();
            *position = if next >= delay { next - delay } else { next } as u16;
        }
        size
    }

    fn remember(&self, state: &mut NetworkState, exponent: i32, size: u32) {
        // 32-bit samples have no exponent: what their sizes exceed 15 bits by stands in its place.
        let (exponent, size) = if size > 15 { (size as i32 - 15, 15) } else { (exponent, size as i32) };
        if let Some(entry) = state.history.get_mut(usize::from(state.now)) {
            *entry = (exponent | size << 4) as u8;
        }
        state.now = state.now.wrapping_add(1);
        let audible = size > 0 && size + exponent > self.inaudible_bits;
        state.quiet_ticks = if audible { 0 } else { state.quiet_ticks.saturating_add(1) };
        let silent = state.quiet_ticks > self.longest_ticks;
        if silent && !state.silent {
            // A history of zeros stands for lines of zeros.
            state.history = [0; HISTORY];
        }
        state.silent = silent;
    }
}

fn take<T: Sample>(line: &[T], position: usize, gain: i32, work: &mut [i32]) {
    if gain == 0 {
        work.fill(0);
        return;
    }
    let position = if position >= line.len() { position - line.len() } else { position };
    let (before, after) = line.split_at_checked(position).unwrap_or((line, &[]));
    if after.len() >= work.len() {
        T::take(after, gain, work);
        return;
    }
    let (to_end, from_start) = work.split_at_mut(after.len());
    T::take(after, gain, to_end);
    T::take(before, gain, from_start);
}

/// Bits of the largest size in a block.
pub(super) fn bits(block: &[i32]) -> i32 {
    let sizes = block.iter().fold(0u32, |sizes, &x| sizes | (x ^ (x >> 31)) as u32);
    32 - sizes.leading_zeros() as i32
}
