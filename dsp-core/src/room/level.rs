//! Level of a network: the size of a step of its lines, which falls as the band decays.
//!
//! `scale = mantissa · 2^(exponent - 32)` bus steps (Q4.27) a step of a 16-bit pair, mantissa from
//! 2^31 to 2^32. It falls by `e^{-d t}`, sample by sample. Too loud an input raises it by powers of
//! two, and so does a stored value of half the range and more. Once all stored values have been
//! below a quarter of the range for as long as the longest line, it is lowered by one power. Values
//! that were stored before such a step are read times that power of two.
//!
//! **Bounds.** A raised level leaves `|x · 2^shift| < 2^31`, and the inverse below 2^31 to a
//! block's end, however much it grows: the input of a line is below 2^14 steps. Input is at most
//! ±2.0 = 2^28.

use super::dimensions::MAX_BLOCKS;
use super::lines::SECOND_GAIN;
use super::plan::BandPlan;
use super::storage::Stored;
use crate::{exponential, fixed};

/// Number of blocks whose levels are remembered, a power of two.
const HISTORY: usize = 64;
const _: () = assert!(MAX_BLOCKS + 2 < HISTORY && HISTORY.is_power_of_two());
const HALF_SECOND_GAIN: u32 = (SECOND_GAIN * 2_147_483_648.0) as u32;
/// Bits of inaudible outputs: below 2^7 steps of the bus, -120 dBFS.
const INAUDIBLE_BITS: i32 = 7;
/// Bits of the loudest input, ±2.0.
const MOST_INPUT_BITS: i32 = 28;

/// Constants of a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    /// `e^{-d}` (Q32) and `e^d - 1` (Q28) over a block.
    decay: u32,
    growth: u32,
    /// `1 - e^{-d}` and `e^d - 1` over a sample, Q32 and below 1/2.
    sample_loss: i32,
    sample_growth: i32,
    /// Gain of the output: mantissa below 2^31, times 2^(exponent - 31).
    output: u32,
    output_exponent: i32,
    /// Number of bits by which a steady input's answers, gathered over the decay, are above one
    /// sample's.
    gathered_bits: i32,
    /// Number of bits above 2^30 that the inverse, times [`SECOND_GAIN`], needs to grow in a block.
    room: i32,
    /// Number of blocks of the longest line.
    longest: u8,
}

/// State of a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelState {
    mantissa: u32,
    /// `2^63 / mantissa`.
    inverse: u32,
    exponent: i32,
    /// Steps up less steps down, modulo 256: those of the last blocks, and now.
    history: [u8; HISTORY],
    steps: u8,
    now: u8,
    /// Number of blocks since the last step, at most 255.
    steady: u8,
    /// Number of blocks since it woke, at most 255: the lines hold zeros from before.
    age: u8,
    /// Number of blocks for which the output has been inaudible; [`ASLEEP`] when the lines hold
    /// zeros.
    quiet: u8,
    /// Number of blocks until it may be lowered, and true if a value since the last such look was
    /// beyond [`QUIET_BITS`](super::lines::QUIET_BITS).
    watch: u8,
    busy: bool,
    /// Bits of the loudest input since the last such look.
    input_bits: i32,
    /// True if a value in the last block was beyond [`LOUD_BITS`](super::lines::LOUD_BITS).
    loud: bool,
}

impl LevelState {
    pub(super) const SILENT: Self = Self {
        mantissa: u32::MAX,
        inverse: 1 << 31,
        exponent: 0,
        history: [0; HISTORY],
        steps: 0,
        now: 0,
        steady: 0,
        age: 0,
        quiet: ASLEEP,
        watch: 0,
        busy: false,
        input_bits: 0,
        loud: false,
    };

    /// Number of bits, at most 1, by which values that were stored `ticks` blocks ago must be
    /// raised.
    pub(super) fn rise(&self, ticks: u8) -> i32 {
        if ticks > self.age {
            return 0;
        }
        let then = self.history.get(usize::from(self.now.wrapping_sub(ticks)) % HISTORY).copied().unwrap_or(0);
        i32::from(then.wrapping_sub(self.steps) as i8)
    }

    /// True if the lines hold zeros.
    pub(super) fn is_asleep(&self) -> bool {
        self.quiet == ASLEEP
    }

    /// True if the content of the lines is inaudible.
    pub(super) fn is_inaudible(&self) -> bool {
        self.quiet > 0
    }

    /// True if the level cannot be lowered at the end of this watch.
    pub(super) fn is_busy(&self) -> bool {
        self.busy
    }

    fn step(&mut self, by: i32) {
        self.exponent += by;
        self.steps = self.steps.wrapping_add(by as u8);
        self.steady = 0;
    }
}

/// Mark of lines that have been cleared.
const ASLEEP: u8 = u8::MAX;

impl Level {
    pub(super) const NONE: Self = Self {
        decay: 0,
        growth: 0,
        sample_loss: 0,
        sample_growth: 0,
        output: 0,
        output_exponent: 0,
        gathered_bits: 0,
        room: 0,
        longest: 0,
    };

    pub(super) fn new(plan: &BandPlan, longest: u8) -> Self {
        let q32 = |value: f64| libm::rint(value * 4_294_967_296.0);
        let nepers = plan.decay_per_sample;
        let tick = nepers * plan.block() as f64;
        let (fraction, exponent) = libm::frexp(plan.output);
        Self {
            decay: q32(exponential::exp(-tick)) as u32,
            growth: libm::rint(-exponential::loss(-tick) * 268_435_456.0) as u32,
            sample_loss: q32(exponential::loss(nepers)) as i32,
            sample_growth: q32(-exponential::loss(-nepers)) as i32,
            output: libm::rint(fraction * 2_147_483_647.0) as u32,
            // Outputs are halved.
            output_exponent: exponent + 1,
            // Powers add: 1/(2 d) of them.
            gathered_bits: libm::ceil(-0.5 * exponential::log2(2.0 * nepers)).max(0.0) as i32,
            room: (libm::ceil(exponential::log2(SECOND_GAIN * exponential::exp(tick))) as i32 - 1).max(0),
            longest,
        }
    }

    /// Exponent that leaves an input of `input_bits` 31 bits.
    fn least_exponent(&self, input_bits: i32) -> i32 {
        input_bits + self.room - 14
    }

    /// True if an input of `input_bits` would be audible if it went on: a sample's answer is at
    /// most half of it times the gain.
    pub(super) fn is_audible(&self, input_bits: i32) -> bool {
        input_bits > 0 && input_bits + self.output_exponent - 1 + self.gathered_bits > INAUDIBLE_BITS
    }

    /// True if all values that a block reads were stored at the present level.
    pub(super) fn is_steady(&self, state: &LevelState) -> bool {
        state.steady > self.longest
    }

    /// Fits the level to a block's input and to the last outputs.
    pub(super) fn begin<T: Stored>(&self, state: &mut LevelState, input_bits: i32) {
        // The smallest exponent whose shift leaves the input its bits.
        let least = if input_bits > 0 { self.least_exponent(input_bits) } else { i32::MIN };
        if state.is_asleep() {
            *state = LevelState {
                mantissa: (1 << 31) + 1,
                inverse: u32::MAX,
                exponent: least,
                watch: self.longest,
                // Zeros are zeros at any level.
                steady: u8::MAX,
                quiet: 0,
                ..LevelState::SILENT
            };
        }
        if state.exponent < least {
            // One bit more, if possible: steady sound then changes levels half as often.
            let raised = (least + 1).min(self.least_exponent(MOST_INPUT_BITS));
            state.step(raised - state.exponent);
        }
        state.input_bits = state.input_bits.max(input_bits);
        if state.loud && state.exponent < self.least_exponent(MOST_INPUT_BITS) - 1 {
            // Two bits, and a long watch, so that steady sound changes levels less often.
            state.step(2);
            (state.busy, state.watch) = (true, u8::MAX);
        } else if state.watch == 0 {
            let room = state.exponent > self.least_exponent(state.input_bits) + 1 || state.input_bits == 0;
            if T::LOWERED && !state.busy && self.is_steady(state) && room {
                state.step(-1);
            }
            (state.busy, state.watch, state.input_bits) = (false, self.longest, 0);
        } else {
            state.watch -= 1;
        }
        if let Some(entry) = state.history.get_mut(usize::from(state.now) % HISTORY) {
            *entry = state.steps;
        }
    }

    /// Shift and gain of the input, and the gain's growth.
    pub(super) fn input(&self, state: &LevelState) -> (u32, [i32; 2]) {
        let shift = 17 + self.room - state.exponent;
        // Half of [`SECOND_GAIN`], twice.
        let inverse = high_word(state.inverse, HALF_SECOND_GAIN);
        let gain = (inverse >> (1 + self.room).unsigned_abs()) as i32;
        (shift.clamp(0, 31).unsigned_abs(), [gain, self.sample_growth])
    }

    /// Gain of the outputs and its loss; and the number of bits by which the gain exceeds its
    /// format.
    pub(super) fn output(&self, state: &LevelState) -> ([i32; 2], u32) {
        let product = high_word(state.mantissa, self.output) as i32;
        let shift = state.exponent + self.output_exponent - 15;
        let gain = if shift >= 0 { product } else { product >> shift.unsigned_abs().min(31) };
        ([gain, self.sample_loss], shift.max(0).unsigned_abs())
    }

    /// Ends a block. `exceeded` is true if a watched value was beyond its bits.
    pub(super) fn end(&self, state: &mut LevelState, exceeded: bool) {
        state.loud = state.busy && exceeded;
        state.busy |= exceeded;
        self.decay(state);
        // The rest is at most 2^14 steps.
        state.quiet = u8::from(state.exponent + self.output_exponent + 14 <= INAUDIBLE_BITS);
    }

    /// Ends an inaudible block, which cleared all that it read.
    pub(super) fn drain(&self, state: &mut LevelState) {
        if let Some(entry) = state.history.get_mut(usize::from(state.now) % HISTORY) {
            *entry = state.steps;
        }
        self.decay(state);
        state.quiet = if state.quiet > self.longest { ASLEEP } else { state.quiet + 1 };
    }

    fn decay(&self, state: &mut LevelState) {
        state.now = state.now.wrapping_add(1);
        (state.steady, state.age) = (state.steady.saturating_add(1), state.age.saturating_add(1));
        // The mantissa goes back above 2^31, the inverse with it below 2^32. A block's growth is
        // below 16 (150/s, 128 frames at 8 kHz).
        let mantissa = high_word(state.mantissa, self.decay);
        let low = mantissa.leading_zeros();
        state.mantissa = mantissa << low;
        state.exponent -= low as i32;
        let inverse = state.inverse >> low;
        let growth = (u64::from(inverse) * u64::from(self.growth)) >> 28;
        let inverse = inverse.saturating_add(growth as u32).max(1 << 31);
        // One step of Newton's method keeps the inverse from drifting: 2^63 - mantissa · inverse is
        // small.
        let error = ((1u64 << 63).wrapping_sub(u64::from(state.mantissa) * u64::from(inverse)) >> 31) as i32;
        let correction = fixed::smmul(error << 8, (inverse >> 8) as i32);
        state.inverse = inverse.saturating_add_signed(correction).max(1 << 31);
    }
}

fn high_word(a: u32, b: u32) -> u32 {
    ((u64::from(a) * u64::from(b)) >> 32) as u32
}
