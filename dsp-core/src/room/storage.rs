//! Storage of delay lines: 16 bits, or 32 bits, which are 16 with 16 finer ones behind them.

use super::dimensions::LINES;
use crate::fixed;

/// A stored sample of a delay line: the network's level says the size of a step of a 16-bit sample;
/// a 32-bit one is 2^16 times finer.
pub trait Stored: Copy {
    /// Silence.
    const ZERO: Self;
    /// True if its lines' level is lowered when that leaves it more bits.
    const LOWERED: bool;
    /// Sine and cosine of an angle as samples are multiplied by them.
    type Turn: Copy + core::fmt::Debug;
    /// No angle yet.
    const NO_TURN: Self::Turn;

    /// Angle from sine and cosine, Q31.
    fn turn(turn: [i32; 2]) -> Self::Turn;

    /// Sample from 2^-16 steps.
    fn input(value: i32) -> Self;

    /// `(c a + s b, s a - c b) / 2` of a pair (a, b).
    fn reflect(pair: [Self; 2], turn: &Self::Turn) -> [Self; 2];

    /// `(c a - s b, s a + c b) / 2` of a pair (a, b).
    fn rotate(pair: [Self; 2], turn: &Self::Turn) -> [Self; 2];

    /// Half the sample, rounded half up.
    fn halve(self) -> Self;

    /// `a + b`, saturated.
    fn add(a: Self, b: Self) -> Self;

    /// `a - b`, saturated.
    fn subtract(a: Self, b: Self) -> Self;

    /// The sample times a gain whose 2^16 stands for one bus step (Q4.27) a step of a 16-bit
    /// sample.
    fn times(self, gain: i32) -> i32;

    /// True if the sample is beyond a number of bits (sign included, of 16).
    fn exceeds(self, bits: u32) -> bool;

    /// Stored values that are watched, so that the level is raised before any value saturates. The
    /// mix spreads the energy over all lines.
    fn watched(stored: &[[Self; 2]; LINES]) -> &[[Self; 2]];
}

/// Half a step of the 16 bits that are cut off.
const HALF_STEP: i32 = 1 << 15;

/// Upper 32 bits, rounded half up. A turned pair's sum is below √2 · 2^62: it does not leave 64
/// bits.
fn upper_half(sum: i64) -> i32 {
    ((sum + (1 << 31)) >> 32) as i32
}

/// 16 bits: half the memory, and the form of the assembly.
impl Stored for i16 {
    const ZERO: Self = 0;
    const LOWERED: bool = true;
    type Turn = [i16; 2];
    const NO_TURN: [i16; 2] = [0; 2];

    fn turn(turn: [i32; 2]) -> [i16; 2] {
        turn.map(|value| (value.saturating_add(1 << 15) >> 16) as i16)
    }

    #[inline(always)]
    fn input(value: i32) -> i16 {
        // `prepare` gives at most 2^30.
        ((value + (1 << 15)) >> 16) as i16
    }

    #[inline(always)]
    fn reflect([a, b]: [i16; 2], &[sine, cosine]: &[i16; 2]) -> [i16; 2] {
        let [a, b, sine, cosine] = [a, b, sine, cosine].map(i32::from);
        // SMLADX, SMLSD, and the upper halves.
        [((cosine * a + sine * b + HALF_STEP) >> 16) as i16, ((sine * a - cosine * b + HALF_STEP) >> 16) as i16]
    }

    #[inline(always)]
    fn rotate([a, b]: [i16; 2], &[sine, cosine]: &[i16; 2]) -> [i16; 2] {
        let [a, b, sine, cosine] = [a, b, sine, cosine].map(i32::from);
        // SMLSDX, SMLAD, and the upper halves.
        [((cosine * a - sine * b + HALF_STEP) >> 16) as i16, ((sine * a + cosine * b + HALF_STEP) >> 16) as i16]
    }

    fn halve(self) -> i16 {
        // SHADD16 with ones.
        ((i32::from(self) + 1) >> 1) as i16
    }

    #[inline(always)]
    fn add(a: i16, b: i16) -> i16 {
        a.saturating_add(b)
    }

    #[inline(always)]
    fn subtract(a: i16, b: i16) -> i16 {
        a.saturating_sub(b)
    }

    #[inline(always)]
    fn times(self, gain: i32) -> i32 {
        // At most 2^31 · 2^15 / 2^16 (SMULWB).
        ((i64::from(gain) * i64::from(self)) >> 16) as i32
    }

    #[inline(always)]
    fn exceeds(self, bits: u32) -> bool {
        (self ^ (self >> 15)) >> (bits - 1) != 0
    }

    /// One line: more would cost more cycles.
    #[inline(always)]
    fn watched([_, stored, ..]: &[[i16; 2]; LINES]) -> &[[i16; 2]] {
        core::slice::from_ref(stored)
    }
}

/// 32 bits: twice the memory, and the rounding of the bus and the splits.
impl Stored for i32 {
    const ZERO: Self = 0;
    const LOWERED: bool = false;
    type Turn = [i32; 2];
    const NO_TURN: [i32; 2] = [0; 2];

    fn turn(turn: [i32; 2]) -> [i32; 2] {
        turn
    }

    fn input(value: i32) -> i32 {
        value
    }

    fn reflect([a, b]: [i32; 2], &[sine, cosine]: &[i32; 2]) -> [i32; 2] {
        let [a, b, sine, cosine] = [a, b, sine, cosine].map(i64::from);
        [upper_half(cosine * a + sine * b), upper_half(sine * a - cosine * b)]
    }

    fn rotate([a, b]: [i32; 2], &[sine, cosine]: &[i32; 2]) -> [i32; 2] {
        let [a, b, sine, cosine] = [a, b, sine, cosine].map(i64::from);
        [upper_half(cosine * a - sine * b), upper_half(sine * a + cosine * b)]
    }

    fn halve(self) -> i32 {
        (self >> 1) + (self & 1)
    }

    fn add(a: i32, b: i32) -> i32 {
        a.saturating_add(b)
    }

    fn subtract(a: i32, b: i32) -> i32 {
        a.saturating_sub(b)
    }

    fn times(self, gain: i32) -> i32 {
        fixed::smmulr(self, gain)
    }

    fn exceeds(self, bits: u32) -> bool {
        (self ^ (self >> 31)) >> (bits + 15) != 0
    }

    fn watched(stored: &[[i32; 2]; LINES]) -> &[[i32; 2]] {
        stored
    }
}
