//! Feedback delay network of a band: four lines of pairs, an orthogonal mix that slowly turns, and
//! a level that decays beside it.
//!
//! ```text
//!        ┌────────────────────────────────────────────────────────────────┐
//!        └─► line 0..3 of pairs, z^-m ─► rotation ─► mix of four ─► ×1/2 ─┘
//!   x · 1/level ─► rotation 0            │ 2, 3
//!                                        └─► difference · level ─► left, right
//! ```
//!
//! **The decay.** All lines lose the same decibels a second, so that every resonance of the band
//! has exactly the table's T60. That loss is the same for the whole content of the network,
//! whenever it came in. So the lines lose nothing, and a [`Level`](super::level) falls by
//! `e^{-d t}` instead: inputs are divided by it, outputs multiplied. A tail so keeps all its 16
//! bits however quiet it is.
//!
//! **The mix.** A line holds pairs (a, b), which on a Cortex-M4F are two halves of a word:
//! `(c a + s b, s a - c b)` is two instructions, and a mix of four words by saturating additions is
//! eight. Lines 0 and 3 reflect their pairs so, 1 and 2 rotate them, `(c a - s b, s a + c b)`; 2
//! and 3 then swap halves. So the four spread the difference of the halves: if all were alike, one
//! side would keep more than its part for a while, and its T60 would be off by 5 % in narrow bands.
//! The angles of lines 0 and 2 turn with time, which moves the resonances before one can stand out;
//! lines 1 and 3 have one angle. The mix is orthogonal at each moment, hence never adds energy.
//!
//! **Both sides.** Line 3's fixed angle, 25.5°, turns the first echo of a pair of equals to the
//! right: its right half has 9 dB more. Later echoes are even, so that left was 0.5 to 1.3 dB below
//! right over all. So the input is no pair of equals: it is 20° from that, where first echoes of
//! all lines together are even in the mean over delays, decays and the swing's angles. The late
//! sound is the same whatever the input's direction.
//!
//! **Nothing wraps.** A rotation's sum is at most `√2 · 2^15 · 2^15 < 2^30.5`; all other sums
//! saturate. A full-scale impulse puts at most `2^13.6` into each value and cannot saturate any:
//! each mix spreads the energy.

use super::dimensions::{BLOCK_FRAMES, LINES};
use super::level::{Level, LevelState};
use super::lines::{NetworkTick, Place, Radiation, Sound};
use super::plan::BandPlan;
use super::sample::Sample;
use super::turn::{TURN_FRAMES, Turn};
use crate::fixed;

/// Sine and cosine of the angle of lines 1 and 3 in 15 bits: of all pairs near it the one whose
/// squares sum up to 1 within 3e-8.
const ANGLE: [i32; 2] = [14_111, 29_574];

/// Constants of a network.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetworkConfig {
    /// Beginnings and lengths of the lines.
    lines: [Place; LINES],
    ages: [Age; LINES],
    level: Level,
    block: u8,
    /// Number of samples that are mixed by one angle.
    turn_samples: u8,
}

/// Age of a line's pairs when a block reads them.
#[derive(Clone, Copy, Debug)]
struct Age {
    /// Number of blocks since the first pair that a block reads was stored.
    blocks: u8,
    /// Number of pairs that the block reads before those that were stored a block later; a whole
    /// block if there are none.
    seam: u8,
}

impl Age {
    fn new(delay: usize, block: usize) -> Self {
        let blocks = delay.div_ceil(block);
        let seam = block - (blocks * block - delay);
        Self { blocks: blocks as u8, seam: seam as u8 }
    }
}

/// State of a network besides its lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetworkState {
    /// Places at which the lines are read and written next.
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

    /// Silent state, with all lines at their beginnings.
    pub(super) fn silent(&self) -> NetworkState {
        NetworkState { places: self.lines, ..NetworkState::SILENT }
    }

    /// True if a block can be left out: all is silent, and the input would be inaudible.
    #[inline(always)]
    pub(super) fn sleeps(&self, state: &NetworkState, input_bits: i32) -> bool {
        state.level.is_asleep() && !self.level.is_audible(input_bits)
    }

    /// Renders a block: `input` in Q4.27, at most ±2.0, with sizes of `input_bits`. The output is
    /// added to `out`, or put there. True if there was one.
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

    /// Lets an inaudible block pass, which clears all that it would read.
    #[cold]
    fn drain<T: Sample>(&self, state: &mut NetworkState, memory: &mut [[T; 2]]) {
        let block = u16::from(self.block);
        for (line, place) in self.lines.iter().zip(&mut state.places) {
            settle(memory, line, *place, block, i32::MIN);
            *place = place.after(block, line);
        }
        self.level.drain(&mut state.level);
    }

    /// Brings the values that this block will read to the present level.
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
        // Below -16 bits, no bit of 16 is left; of 32, no audible one.
        match rise {
            ..-16 => words.fill([T::ZERO; 2]),
            _ => T::scale(words, rise),
        }
    }
}

/// Angles of a block, as the lines' samples are multiplied by them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turns<T: Sample> {
    /// Angles of each sixteenth frame.
    moving: [T::Turn; BLOCK_FRAMES / TURN_FRAMES],
    /// Angles of each 32nd frame, for some slower bands. Held for longer, their steps would spread
    /// a band's sound over its neighbours, 31 dB down at an eighth of the rate and sixteen samples
    /// a step.
    half: [T::Turn; BLOCK_FRAMES / TURN_FRAMES / 2],
    fixed: T::Turn,
}

impl<T: Sample> Turns<T> {
    pub(super) const NONE: Self = Self {
        moving: [T::NO_TURN; BLOCK_FRAMES / TURN_FRAMES],
        half: [T::NO_TURN; BLOCK_FRAMES / TURN_FRAMES / 2],
        fixed: T::NO_TURN,
    };

    /// Angles of a block.
    pub(super) fn new(turn: &Turn) -> Self {
        let moving = turn.steps().map(T::turn);
        let [a, _, b, _, c, _, d, _] = moving;
        Self { moving, half: [a, b, c, d], fixed: T::turn(ANGLE.map(|value| value << 16)) }
    }

    /// Angles of a band whose block has `block` samples: moving ones, the number of samples for
    /// each, and the fixed one.
    fn of(&self, block: usize, samples: usize) -> (&[T::Turn], usize, T::Turn) {
        let moving: &[T::Turn] = if samples * self.moving.len() == block { &self.moving } else { &self.half };
        (moving, samples, self.fixed)
    }
}

/// Adds outputs to `out`, or puts them there, times a gain that exceeds
/// [`Stored::times`](super::storage::Stored::times) by `shift` bits.
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
