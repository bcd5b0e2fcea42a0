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
/// Ticks whose exponents are remembered.
const HISTORY: usize = MAX_TICKS + 2;
/// 1/√8, for lines whose butterfly is not a rotation.
const PLAIN: f64 = 0.353_553_390_593_273_8;

/// The working values of a tick, line by line.
pub(super) type Work = [[i32; TICK_FRAMES]; LINES];

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
        work: &mut Work,
        out: &mut [[i32; 2]],
    ) {
        let loudest = self.look_back(state);
        let bits = loudest.bits.max(bits(input) - INPUT_SHIFT).max(0) + 2;
        let exponent = T::exponent(bits, loudest.exponent);
        self.take_all(state, memory, exponent, work);
        let shift = T::FRACTION - exponent;
        self.mix::<T>(turn, input, shift - INPUT_SHIFT, work, out, self.output_shift - shift);
        let size = self.put_all(state, memory, work, (bits > CLIP_BITS).then_some(exponent));
        self.remember(state, exponent, size);
    }
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
                0 => None,
                _ => Some(T::raise(gain, i32::from(past & 15) - exponent)),
            };
            let (before, after) = work.split_at_mut(seam.min(block));
            let position = usize::from(position);
            take(line, position, gain_of(Self::past(state, ticks)), before);
            take(line, position + seam, gain_of(Self::past(state, ticks - 1)), after);
        }
    }

    #[inline(never)]
    fn mix<T: Sample>(
        &self,
        turn: &Turn,
        input: &[i32],
        input_shift: i32,
        work: &mut Work,
        out: &mut [[i32; 2]],
        output_shift: i32,
    ) {
        let (left_shift, right_shift) = (input_shift.max(0) as u32 & 31, (-input_shift).max(0) as u32 & 31);
        let (mut sine, mut cosine) = (turn.sine, turn.cosine);
        let (sine_step, cosine_step) = turn.steps(self.block);
        let [w0, w1, w2, w3, w4, w5, w6, w7] = work;
        let lines =
            w0.iter_mut().zip(w1).zip(w2.iter_mut().zip(w3)).zip(w4.iter_mut().zip(w5).zip(w6.iter_mut().zip(w7)));
        for (((((l0, l1), (l2, l3)), ((l4, l5), (l6, l7))), &x), out) in lines.zip(input).zip(out) {
            (sine, cosine) = (sine.wrapping_add(sine_step), cosine.wrapping_add(cosine_step));
            let x = (x << left_shift) >> right_shift;
            // First stage: two rotations, two butterflies. What storing cuts off is added here and so reaches every line.
            let a0 = fixed::smmla(fixed::smmul(sine, *l1), cosine, *l0) + T::HALF_STEP;
            let a1 = fixed::smmls(fixed::smmul(cosine, *l1), sine, *l0) + T::HALF_STEP;
            let a2 = fixed::smmla(fixed::smmul(sine, *l3), cosine, *l2);
            let a3 = fixed::smmls(fixed::smmul(cosine, *l3), sine, *l2);
            let (a4, a5, a6, a7) = (*l4 + *l5, *l4 - *l5, *l6 + *l7, *l6 - *l7);
            let (b0, b2, b1, b3) = (a0 + a2, a0 - a2, a1 + a3, a1 - a3);
            let (b4, b6, b5, b7) = (a4 + a6, a4 - a6, a5 + a7, a5 - a7);
            let (c0, c4, c1, c5) = (b0 + b4, b0 - b4, b1 + b5, b1 - b5);
            let (c2, c6, c3, c7) = (b2 + b6, b2 - b6, b3 + b7, b3 - b7);
            // Outputs go round by three lines: a symmetric mix would come back to itself in step.
            (*l3, *l4, *l5, *l6) = (c0 + x, c1 - x, c2 + x, c3 + x);
            (*l7, *l0, *l1, *l2) = (c4 - x, c5 + x, c6 - x, c7 + x);
            let side = |y: i32| {
                let scaled = fixed::smmulr(y, self.output);
                match output_shift {
                    left @ 0.. => fixed::saturating_shift_left(scaled, left.unsigned_abs()),
                    right => scaled >> right.unsigned_abs().min(31),
                }
            };
            *out = [out[0].saturating_add(side(c0 - T::HALF_STEP)), out[1].saturating_add(side(c3 - T::HALF_STEP))];
        }
    }

    /// Writes a block of every line where it was read; gives the bits of the largest size. Clips where the sizes may need it.
    #[inline(never)]
    fn put_all<T: Sample>(&self, state: &mut NetworkState, memory: &mut [T], work: &Work, clipped: Option<i32>) -> u32 {
        let mut memory = memory;
        let mut sizes = 0;
        for ((&delay, position), work) in self.delays.iter().zip(&mut state.positions).zip(work) {
            let Some((line, later)) = memory.split_at_mut_checked(usize::from(delay)) else { break };
            memory = later;
            let Some(work) = work.get(..usize::from(self.block)) else { break };
            let (to_end, from_start) = work.split_at((line.len() - usize::from(*position)).min(work.len()));
            for (start, work) in [(usize::from(*position), to_end), (0, from_start)] {
                let Some(line) = line.get_mut(start..start + work.len()) else { continue };
                sizes |= match clipped {
                    None => put(line, work, |value| T::put(value)),
                    Some(exponent) => put(line, work, |value| T::put_clipped(value, exponent)),
                };
            }
            let next = usize::from(*position) + work.len();
            *position = if next >= line.len() { next - line.len() } else { next } as u16;
        }
        32 - sizes.leading_zeros()
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

fn take<T: Sample>(line: &[T], position: usize, gain: Option<i32>, work: &mut [i32]) {
    let Some(gain) = gain else {
        work.fill(0);
        return;
    };
    let position = if position >= line.len() { position - line.len() } else { position };
    let (to_end, from_start) = work.split_at_mut((line.len() - position).min(work.len()));
    for (start, work) in [(position, to_end), (0, from_start)] {
        for (value, sample) in work.iter_mut().zip(line.get(start..).unwrap_or(&[])) {
            *value = sample.take(gain);
        }
    }
}

#[inline(always)]
fn put<T: Sample>(line: &mut [T], work: &[i32], convert: impl Fn(i32) -> T) -> u32 {
    let mut sizes = 0;
    for (sample, &value) in line.iter_mut().zip(work) {
        let stored = convert(value);
        *sample = stored;
        sizes |= stored.size();
    }
    sizes
}

/// Bits of the largest size in a block.
pub(super) fn bits(block: &[i32]) -> i32 {
    let sizes = block.iter().fold(0u32, |sizes, &x| sizes | (x ^ (x >> 31)) as u32);
    32 - sizes.leading_zeros() as i32
}
