//! One band's feedback delay network: four lines of pairs, an orthogonal mix that slowly turns, and a level that decays beside it.
//!
//! ```text
//!        ┌────────────────────────────────────────────────────────────────┐
//!        └─► line 0..3 of pairs, z^-m ─► rotation ─► mix of four ─► ×1/2 ─┘
//!   x · 1/level ─► rotation 0            │ 2, 3
//!                                        └─► difference · level ─► left, right
//! ```
//!
//! **The decay.** All lines lose the same decibels a second, so that every resonance of the band has exactly the table's T60. That loss is the same for all
//! that the network holds, whenever it came in: the lines lose nothing, and a [`Level`](super::level) falls by `e^{-d t}` instead. What comes in is divided by it, what goes
//! out is multiplied by it. A tail so keeps all its 16 bits however quiet it is.
//!
//! **The mix.** A line holds pairs (a, b), which on a Cortex-M4F are two halves of a word: `(c a + s b, s a - c b)` is two instructions, and a mix of four words by
//! saturating additions is eight. Lines 0 and 3 reflect their pairs as above, 1 and 2 rotate them, `(c a - s b, s a + c b)`; 2 and 3 then swap halves. So the four spread what the halves differ
//! in: were all alike, one side would keep more than its part for a while, and its T60 would be off by 5 % in narrow bands. The angles of lines 0 and 2 turn
//! with time, which moves the resonances before one can stand out; lines 1 and 3 have one angle. The mix is orthogonal at each moment, hence never adds energy.
//!
//! **Both sides.** Line 3's fixed angle, 25.5°, turns the first echo of a pair of equals to the right: its
//! right half has 9 dB more. What follows is even, so that left was 0.5 to 1.3 dB below right over
//! all. So the input is no pair of equals: it is 20° from that, where first echoes of all lines
//! together are even in the mean over delays, decays and the swing's angles. What rings late is
//! the same whatever the input's direction.
//!
//! **Nothing wraps.** A rotation's sum is at most `√2 · 2^15 · 2^15 < 2^30.5`; all other sums saturate. A full-scale impulse puts at most `2^13.6` into each value
//! and cannot saturate any: each mix spreads what there is.

use super::dimensions::{BLOCK_FRAMES, LINES};
use super::level::{Level, LevelState};
use super::lines::{NetworkTick, Place, Radiation, Sound};
use super::plan::BandPlan;
use super::sample::Sample;
use super::turn::{TURN_FRAMES, Turn};
use crate::fixed;

/// Sine and cosine of the angle of lines 1 and 3: of all pairs near it the one whose squares sum up to 1 within 3e-8, in 15 bits.
const ANGLE: [i32; 2] = [14_111, 29_574];

/// A network's fixed numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetworkConfig {
    /// The lines' beginnings and lengths.
    lines: [Place; LINES],
    ages: [Age; LINES],
    level: Level,
    block: u8,
    /// Samples that are mixed by one angle.
    turn_samples: u8,
}

/// When what a block reads was stored.
#[derive(Clone, Copy, Debug)]
struct Age {
    /// Blocks since the first pair that a block reads was stored.
    blocks: u8,
    /// Pairs that the block reads before it comes to those that were stored a block later; a whole block where it does not.
    seam: u8,
}

impl Age {
    fn new(delay: usize, block: usize) -> Self {
        let blocks = delay.div_ceil(block);
        let seam = block - (blocks * block - delay);
        Self { blocks: blocks as u8, seam: seam as u8 }
    }
}

/// What a network remembers besides its lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetworkState {
    /// Where each line is read and written next.
    places: [Place; LINES],
    level: LevelState,
}

impl NetworkState {
    pub(super) const SILENT: Self = Self { places: [Place { at: 0, left: 0 }; LINES], level: LevelState::SILENT };
}

impl NetworkConfig {
    pub(super) const NONE: Self = Self {
        lines: [Place { at: 0, left: 0 }; LINES],
        ages: [Age { blocks: 0, seam: 0 }; LINES],
        level: Level::NONE,
        block: 1,
        turn_samples: 1,
    };

    pub(super) fn new(plan: &BandPlan) -> Self {
        let mut at = 0;
        let lines = plan.delays.map(|delay| {
            let line = Place { at: at as u16, left: delay as u16 };
            at += delay;
            line
        });
        let ages = plan.delays.map(|delay| Age::new(delay, plan.block()));
        let longest = ages.iter().fold(0, |longest: u8, age| longest.max(age.blocks));
        Self {
            lines,
            ages,
            level: Level::new(plan, longest),
            block: plan.block() as u8,
            turn_samples: plan.turn_samples as u8,
        }
    }

    /// All lines at their beginnings, and silent.
    pub(super) fn silent(&self) -> NetworkState {
        NetworkState { places: self.lines, ..NetworkState::SILENT }
    }

    /// Whether a block can be left out: all is silent, and so is what would be heard of the input.
    #[inline(always)]
    pub(super) fn sleeps(&self, state: &NetworkState, input_bits: i32) -> bool {
        state.level.is_asleep() && !self.level.is_audible(input_bits)
    }

    /// A block: `input` in Q4.27, at most ±2.0, its block long and of `input_bits`; the output is added to `out`, or put there. Whether there was one.
    pub(super) fn render<T: Sample>(
        &self,
        state: &mut NetworkState,
        memory: &mut [[T; 2]],
        (input, input_bits): (&[i32], i32),
        turns: &Turns<T>,
        sound: &mut Sound<T>,
        (out, add): (&mut [[i32; 2]], bool),
    ) -> bool {
        if state.level.is_inaudible() && !self.level.is_audible(input_bits) {
            self.drain(state, memory);
            return false;
        }
        self.level.begin::<T>(&mut state.level, input_bits);
        if !self.level.is_steady(&state.level) {
            self.settle(state, memory);
        }
        let (input_shift, input_gain) = self.level.input(&state.level);
        let (output_gain, output_shift) = self.level.output(&state.level);
        let radiation = match add {
            _ if output_shift > 0 => Radiation::Nothing,
            true => Radiation::Add,
            false => Radiation::Put,
        };
        let exceeded = T::network(NetworkTick {
            memory,
            lines: &self.lines,
            places: &mut state.places,
            sound,
            turns: turns.of(input.len(), usize::from(self.turn_samples)),
            busy: state.level.is_busy(),
            input,
            input_shift,
            input_gain,
            out,
            output_gain,
            radiation,
        });
        if output_shift > 0 {
            radiate_loud(&sound.output, output_gain, output_shift, out, add);
        }
        self.level.end(&mut state.level, exceeded);
        true
    }

    /// A block that nothing is heard of: what it would read is cleared.
    #[cold]
    fn drain<T: Sample>(&self, state: &mut NetworkState, memory: &mut [[T; 2]]) {
        let block = u16::from(self.block);
        for (line, place) in self.lines.iter().zip(&mut state.places) {
            settle(memory, line, *place, block, i32::MIN);
            *place = place.after(block, line);
        }
        self.level.drain(&mut state.level);
    }

    /// Brings what this block will read to today's level, where it was stored at another.
    #[inline(never)]
    fn settle<T: Sample>(&self, state: &NetworkState, memory: &mut [[T; 2]]) {
        let block = u16::from(self.block);
        for ((line, age), place) in self.lines.iter().zip(&self.ages).zip(&state.places) {
            let (earlier, later) = (state.level.rise(age.blocks), state.level.rise(age.blocks.wrapping_sub(1)));
            let seam = u16::from(age.seam);
            settle(memory, line, *place, seam, earlier);
            settle(memory, line, place.after(seam, line), block - seam, later);
        }
    }
}

/// Raises a run of a line that may pass its end.
fn settle<T: Sample>(memory: &mut [[T; 2]], line: &Place, place: Place, count: u16, rise: i32) {
    if rise == 0 || count == 0 {
        return;
    }
    let to_end = count.min(place.left);
    for (at, count) in [(place.at, to_end), (line.at, count - to_end)] {
        let Some(words) = memory.get_mut(usize::from(at)..usize::from(at) + usize::from(count)) else { return };
        // Below -16 bits, nothing is left of 16; of 32, nothing that is heard.
        match rise {
            ..-16 => words.fill([T::ZERO; 2]),
            _ => T::scale(words, rise),
        }
    }
}

/// A block's angles as the lines' samples are multiplied by them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turns<T: Sample> {
    /// Of each sixteenth frame.
    moving: [T::Turn; BLOCK_FRAMES / TURN_FRAMES],
    /// Of each 32nd, for some slower bands. Were they held for longer, their steps would spread what rings in one band over its neighbours, 31 dB down at an
    /// eighth of the rate and sixteen samples a step.
    half: [T::Turn; BLOCK_FRAMES / TURN_FRAMES / 2],
    fixed: T::Turn,
}

impl<T: Sample> Turns<T> {
    pub(super) const NONE: Self = Self {
        moving: [T::NO_TURN; BLOCK_FRAMES / TURN_FRAMES],
        half: [T::NO_TURN; BLOCK_FRAMES / TURN_FRAMES / 2],
        fixed: T::NO_TURN,
    };

    /// Those of a block.
    pub(super) fn new(turn: &Turn) -> Self {
        let moving = turn.steps().map(T::turn);
        let [a, _, b, _, c, _, d, _] = moving;
        Self { moving, half: [a, b, c, d], fixed: T::turn(ANGLE.map(|value| value << 16)) }
    }

    /// Those of a band whose block is so many samples: moving, samples that each is for, fixed.
    fn of(&self, block: usize, samples: usize) -> (&[T::Turn], usize, T::Turn) {
        let moving: &[T::Turn] = if samples * self.moving.len() == block { &self.moving } else { &self.half };
        (moving, samples, self.fixed)
    }
}

/// Adds outputs times a gain above what [`Sample::times`] holds, by so many bits, or puts them there.
#[cold]
fn radiate_loud<T: Sample>(output: &[[T; 2]], [gain, loss]: [i32; 2], shift: u32, out: &mut [[i32; 2]], add: bool) {
    let mut gain = gain;
    for (out, pair) in out.iter_mut().zip(output) {
        for (out, &y) in out.iter_mut().zip(pair) {
            let before = if add { *out } else { 0 };
            *out = before.saturating_add(fixed::saturating_shift_left(y.times(gain), shift));
        }
        gain = fixed::smmlsr(gain, gain, loss);
    }
}
