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
//! saturating additions is eight. The angles of lines 0 and 2 turn with time, which moves the resonances before one can stand out; lines 1 and 3 have one
//! angle, and change halves. The mix is orthogonal at each moment, hence never adds energy.
//!
//! **Nothing wraps.** A rotation's sum is at most `√2 · 2^15 · 2^15 < 2^30.5`; all other sums saturate. A full-scale impulse puts at most `2^14.2` into each value
//! and cannot saturate any: each mix spreads what there is.

use super::level::{Level, LevelState};
use super::plan::BandPlan;
use super::storage::Sample;
use super::turn::{TURN_SAMPLES, Turn};
use crate::resonator::TICK_FRAMES;

/// Lines of a network; each holds pairs.
pub(super) const LINES: usize = 4;
/// What of the input each of a line's values takes.
pub(super) const INPUT_GAIN: f64 = 0.5;
/// Sine and cosine of the angle of lines 1 and 3: of all pairs near it the one whose squares sum up to 1 within 3e-8, in 15 bits.
const ANGLE: [i32; 2] = [14_111, 29_574];

/// Input and output of a network's tick.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(4))]
pub struct Sound<T> {
    /// In the network's units, the same for both values of a pair.
    pub(super) input: [[T; 2]; TICK_FRAMES],
    /// Half the outputs, in the network's units.
    pub(super) output: [[T; 2]; TICK_FRAMES],
}

/// A network's fixed numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetworkConfig {
    lines: [Line; LINES],
    level: Level,
    block: u8,
}

/// A delay line's fixed numbers.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Pairs.
    delay: u16,
    /// Ticks since the first pair that a tick reads was stored.
    ticks: u8,
    /// Pairs that the tick reads before it comes to those that were stored a tick later; a whole block where it does not.
    seam: u8,
}

impl Line {
    const NONE: Self = Self { delay: 0, ticks: 0, seam: 0 };

    fn new(delay: usize, block: usize) -> Self {
        let ticks = delay.div_ceil(block);
        let seam = block - (ticks * block - delay);
        Self { delay: delay as u16, ticks: ticks as u8, seam: seam as u8 }
    }
}

/// What a network remembers besides its lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct NetworkState {
    /// Where each line is read and written next.
    positions: [u16; LINES],
    level: LevelState,
}

impl NetworkState {
    pub(super) const SILENT: Self = Self { positions: [0; LINES], level: LevelState::SILENT };
}

/// The four lines from where they are read and written.
pub(super) type Lines<'a, T> = [&'a mut [[T; 2]]; LINES];

impl NetworkConfig {
    pub(super) const NONE: Self = Self { lines: [Line::NONE; LINES], level: Level::NONE, block: 1 };

    pub(super) fn new(plan: &BandPlan) -> Self {
        let lines = plan.delays.map(|delay| Line::new(delay, plan.block()));
        let longest = lines.iter().fold(0, |longest: u8, line| longest.max(line.ticks));
        Self { lines, level: Level::new(plan, longest), block: plan.block() as u8 }
    }

    /// Whether a tick can be left out: all is silent, and so is what would be heard of the input.
    pub(super) fn sleeps(&self, state: &NetworkState, input_bits: i32) -> bool {
        self.level.sleeps(&state.level, input_bits)
    }

    /// A tick: `input` in Q4.27, at most ±2.0, its block long and of `input_bits`; the output is added to `out`, or put there.
    pub(super) fn render<T: Sample>(
        &self,
        state: &mut NetworkState,
        memory: &mut [[T; 2]],
        (input, input_bits): (&[i32], i32),
        turns: &Turns<T>,
        sound: &mut Sound<T>,
        out: &mut [[i32; 2]],
        add: bool,
    ) {
        self.level.begin::<T>(&mut state.level, input_bits);
        self.level.prepare::<T>(&state.level, input, &mut sound.input);
        let busy = self.pass(state, memory, turns, sound);
        let Some(output) = sound.output.get(..usize::from(self.block)) else { return };
        let loud = self.level.radiate(&state.level, output, out, add);
        self.level.end(&mut state.level, busy, loud);
    }

    /// Lets a tick pass through the lines, cut where a line ends or where what it holds was stored at another level. Whether something that is
    /// stored keeps the level from being lowered.
    fn pass<T: Sample>(
        &self,
        state: &mut NetworkState,
        memory: &mut [[T; 2]],
        turns: &Turns<T>,
        sound: &mut Sound<T>,
    ) -> bool {
        let block = usize::from(self.block);
        let steady = self.level.is_steady(&state.level);
        let (mut from, mut busy) = (0, false);
        while from < block {
            let mut to = block;
            for (line, &position) in self.lines.iter().zip(&state.positions) {
                to = to.min(from + usize::from(line.delay - position));
            }
            let cut = if steady { None } else { Some(self.rises(&state.level, from, &mut to)) };
            let Some(lines) = lines_from(memory, &self.lines, &state.positions, to - from) else { return busy };
            busy |= match cut {
                None => T::pass(lines, sound, turns, from),
                Some(rises) => T::pass_between(lines, sound, turns, from, rises),
            };
            for (line, position) in self.lines.iter().zip(&mut state.positions) {
                let next = *position + (to - from) as u16;
                *position = if next >= line.delay { 0 } else { next };
            }
            from = to;
        }
        busy
    }

    /// By how many bits each line's pairs from a frame on must be raised to today's level, and how far that holds (and the angle).
    fn rises(&self, state: &LevelState, from: usize, to: &mut usize) -> [i32; LINES] {
        *to = (*to).min((from / TURN_SAMPLES + 1) * TURN_SAMPLES);
        self.lines.map(|line| {
            let seam = usize::from(line.seam);
            if from >= seam {
                return state.rise(line.ticks.wrapping_sub(1));
            }
            let (earlier, later) = (state.rise(line.ticks), state.rise(line.ticks.wrapping_sub(1)));
            if earlier != later {
                *to = (*to).min(seam);
            }
            earlier
        })
    }
}

/// Each line's next `frames` pairs.
#[inline(always)]
fn lines_from<'a, T>(
    memory: &'a mut [[T; 2]],
    [a, b, c, d]: &[Line; LINES],
    &[at_a, at_b, at_c, at_d]: &[u16; LINES],
    frames: usize,
) -> Option<Lines<'a, T>> {
    let line = |line: &Line, rest: &'a mut [[T; 2]]| rest.split_at_mut_checked(usize::from(line.delay));
    let part = |line: &'a mut [[T; 2]], at: u16| line.get_mut(usize::from(at)..usize::from(at) + frames);
    let (a, rest) = line(a, memory)?;
    let (b, rest) = line(b, rest)?;
    let (c, rest) = line(c, rest)?;
    let (d, _) = line(d, rest)?;
    Some([part(a, at_a)?, part(b, at_b)?, part(c, at_c)?, part(d, at_d)?])
}

/// A tick's angles as the lines' samples are multiplied by them.
#[derive(Clone, Copy, Debug)]
pub struct Turns<T: Sample> {
    /// Of each eighth frame; bands at lower rates take every second or the first.
    pub(super) moving: [T::Turn; TICK_FRAMES / TURN_SAMPLES],
    pub(super) fixed: T::Turn,
}

impl<T: Sample> Turns<T> {
    /// Those of a tick for bands of so many frames.
    pub(super) fn new(turn: &Turn, block: usize) -> Self {
        Self { moving: turn.steps(block).map(T::turn), fixed: T::turn(ANGLE.map(|value| value << 16)) }
    }

    /// Those of a frame: moving, fixed.
    pub(super) fn at(&self, frame: usize) -> [T::Turn; 2] {
        [self.moving.get(frame / TURN_SAMPLES).copied().unwrap_or(self.fixed), self.fixed]
    }
}

/// Bits of the largest size in a block.
pub(super) fn bits(block: &[i32]) -> i32 {
    let sizes = block.iter().fold(0u32, |sizes, &x| sizes | (x ^ (x >> 31)) as u32);
    32 - sizes.leading_zeros() as i32
}
