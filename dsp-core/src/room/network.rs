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
//! and its gains below 1, its energy never exceeds what came in: an impulse of full scale puts 8/256 into it, and can neither wrap nor clip.

use super::plan::{BandPlan, MAX_TICKS};
use super::storage::{CLIP_BITS, Sample};
use super::turn::Turn;
use crate::fixed;
use crate::resonator::TICK_FRAMES;

/// Lines of a network.
pub(super) const LINES: usize = 8;
/// What of the input each line takes: 2^-4.
pub(super) const INPUT_GAIN: f64 = 1.0 / 16.0;
const INPUT_SHIFT: i32 = 4;
/// Samples that are mixed by the same angle.
const TURN_SAMPLES: usize = 8;
/// Ticks whose exponents are remembered.
const HISTORY: usize = MAX_TICKS + 2;
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
    delays: [u16; LINES],
    /// [`Sample::gain`]s.
    gains: [i32; LINES],
    block: u8,
    /// Output gain as a Q32 mantissa times 2^shift.
    output: i32,
    output_shift: i32,
    /// Samples of at most this many bits are inaudible.
    inaudible_bits: i32,
    /// Ticks after which nothing is left of a sample but what was mixed again.
    longest_ticks: u8,
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
    pub(super) const NONE: Self = Self {
        delays: [0; LINES],
        gains: [0; LINES],
        block: 1,
        output: 0,
        output_shift: 0,
        inaudible_bits: 0,
        longest_ticks: 0,
    };

    pub(super) fn new<T: Sample>(plan: &BandPlan) -> Self {
        let mut gains = [0; LINES];
        for (index, (word, &gain)) in gains.iter_mut().zip(&plan.gains).enumerate() {
            *word = T::gain(if index < LINES / 2 { gain } else { gain * PLAIN });
        }
        let (fraction, exponent) = libm::frexp(plan.output);
        // Mantissas below 1/2.
        let output = libm::rint(fraction * 2_147_483_647.0) as i32;
        // A size of 2^b sounds at most 2.84 · 2^b · output; that shall stay below -110 dBFS, 2^8.72 of the bus.
        let inaudible_bits = libm::floor(8.72 - libm::log2(2.84 * plan.output.max(1e-30))) as i32;
        let longest = plan.delays.iter().fold(0, |longest, &delay| longest.max(delay));
        Self {
            delays: plan.delays.map(|delay| delay as u16),
            gains,
            block: plan.block() as u8,
            output,
            output_shift: exponent + 1,
            inaudible_bits: inaudible_bits.clamp(0, 20),
            longest_ticks: (longest.div_ceil(plan.block()) + 1).min(HISTORY) as u8,
        }
    }

    /// Whether a tick can be left out: all is zero, and so is what can be heard of the input.
    pub(super) fn sleeps(&self, state: &NetworkState, input: &[i32]) -> bool {
        state.silent && bits(input) - INPUT_SHIFT <= self.inaudible_bits
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
        let loudest = self.look_back(state);
        let bits = loudest.bits.max(bits(input) - INPUT_SHIFT).max(0) + 2;
        let exponent = T::exponent(bits, loudest.exponent);
        self.take_all(state, memory, exponent, work);
        let shift = T::FRACTION - exponent;
        let Some(sound) = sound.get_mut(..usize::from(self.block)) else { return };
        let shifts = Shifts { input: shift - INPUT_SHIFT, output: self.output_shift - shift };
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

/// Where a line's block begins to read the later of two ticks' samples, and how many ticks ago the earlier was.
fn seam(delay: usize, block: usize) -> (usize, usize) {
    let ticks = delay.div_ceil(block.max(1));
    (block - (ticks * block - delay).min(block), ticks)
}

impl NetworkConfig {
    fn past(state: &NetworkState, ticks: usize) -> u8 {
        let now = usize::from(state.now);
        let place = if now >= ticks { now - ticks } else { now + HISTORY - ticks.min(HISTORY) };
        state.history.get(place).copied().unwrap_or(0)
    }

    #[inline(never)]
    fn look_back(&self, state: &NetworkState) -> Loudest {
        let mut loudest = Loudest { bits: 0, exponent: 0 };
        for &delay in &self.delays {
            let (seam, ticks) = seam(usize::from(delay), usize::from(self.block));
            let later = if seam < usize::from(self.block) { Self::past(state, ticks - 1) } else { 0 };
            for past in [Self::past(state, ticks), later] {
                let (exponent, bits) = (i32::from(past & 15), i32::from(past >> 4));
                if bits > 0 {
                    loudest.bits = loudest.bits.max(bits + exponent);
                    loudest.exponent = loudest.exponent.max(exponent);
                }
            }
        }
        loudest
    }

    /// Reads a block of every line, times its gain, as working values.
    #[inline(never)]
    fn take_all<T: Sample>(&self, state: &NetworkState, memory: &[T], exponent: i32, work: &mut Work) {
        let block = usize::from(self.block);
        let mut memory = memory;
        for (((&delay, &gain), &position), work) in
            self.delays.iter().zip(&self.gains).zip(&state.positions).zip(work.iter_mut())
        {
            let Some((line, later)) = memory.split_at_checked(usize::from(delay)) else { return };
            memory = later;
            let (Some(work), (seam, ticks)) = (work.get_mut(..block), seam(line.len(), block)) else { return };
            let gain_of = |past: u8| match past >> 4 {
                0 => 0,
                _ => T::raise(gain, i32::from(past & 15) - exponent),
            };
            let position = usize::from(position);
            let earlier = gain_of(Self::past(state, ticks));
            let later = if seam < block { gain_of(Self::past(state, ticks - 1)) } else { earlier };
            if earlier == later {
                take(line, position, earlier, work);
                continue;
            }
            let (before, after) = work.split_at_mut(seam.min(block));
            take(line, position, earlier, before);
            take(line, position + seam, later, after);
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
        if shift > 0 {
            let left = shift.unsigned_abs();
            let side = |y: i32| fixed::saturating_shift_left(fixed::smmulr(y, self.output), left);
            for (out, sound) in out.iter_mut().zip(sound) {
                *out = [out[0].saturating_add(side(sound[0])), out[1].saturating_add(side(sound[1]))];
            }
        } else {
            let right = shift.unsigned_abs().min(31);
            let side = |y: i32| fixed::smmulr(y, self.output) >> right;
            for (out, sound) in out.iter_mut().zip(sound) {
                *out = [out[0].saturating_add(side(sound[0])), out[1].saturating_add(side(sound[1]))];
            }
        }
    }

    #[inline(never)]
    /// Writes a block of every line where it was read; gives the bits of the largest size. Clips where the sizes may need it.
    fn put_all<T: Sample>(&self, state: &mut NetworkState, memory: &mut [T], work: &Work, clipped: Option<i32>) -> u32 {
        let mut memory = memory;
        let mut size = 0;
        for ((&delay, position), work) in self.delays.iter().zip(&mut state.positions).zip(work) {
            let Some((line, later)) = memory.split_at_mut_checked(usize::from(delay)) else { break };
            memory = later;
            let Some(work) = work.get(..usize::from(self.block)) else { break };
            let (to_end, from_start) = work.split_at((line.len() - usize::from(*position)).min(work.len()));
            for (start, work) in [(usize::from(*position), to_end), (0, from_start)] {
                let Some(line) = line.get_mut(start..start + work.len()).filter(|line| !line.is_empty()) else {
                    continue;
                };
                size = size.max(match clipped {
                    None => T::put(work, line),
                    Some(exponent) => T::put_clipped(work, line, exponent),
                });
            }
            let next = usize::from(*position) + work.len();
            *position = if next >= line.len() { next - line.len() } else { next } as u16;
        }
        size
    }

    #[inline(never)]
    fn remember(&self, state: &mut NetworkState, exponent: i32, size: u32) {
        let now = usize::from(state.now);
        // 32-bit samples have no exponent: what their sizes exceed 15 bits by stands in its place.
        let (exponent, size) = if size > 15 { (size as i32 - 15, 15) } else { (exponent, size as i32) };
        if let Some(entry) = state.history.get_mut(now) {
            *entry = (exponent | size << 4) as u8;
        }
        state.now = if now + 1 >= HISTORY { 0 } else { now + 1 } as u8;
        let audible = size > 0 && size + exponent > self.inaudible_bits;
        state.quiet_ticks = if audible { 0 } else { state.quiet_ticks.saturating_add(1) };
        state.silent = state.quiet_ticks > self.longest_ticks;
        if state.silent {
            // A history of zeros stands for lines of zeros.
            state.history = [0; HISTORY];
        }
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
