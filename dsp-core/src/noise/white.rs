//! White noise at the cost of one multiplication a sample.
//!
//! A multiplicative congruential generator modulo 2^32, `x ← A x`, x odd, with A = 0x93d765dd
//! (Steele and Vigna, "Computationally easy, spectrally good multipliers for congruential
//! pseudorandom number generators", 2021). Its period is 2^30, more than six hours at 48 kHz.
//!
//! [`Sfc32`], which gives it its start, would cost three cycles a sample. In one loop with the
//! filter it would also take four registers, and none are left. This generator takes one cycle and
//! two registers. Its low bits are poor, but they weigh nothing, because a sample is the whole word
//! times a level.
//!
//! Samples are uniform, of deviation 1/√3. Uniform noise is as white as Gaussian noise, and the
//! filter's output is nearly Gaussian by itself.

use super::sfc32::Sfc32;
use crate::fixed::smmul;

/// Multiplier A of the generator.
pub const MULTIPLIER: u32 = 0x93d7_65dd;

/// Generator of white noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct White(u32);

impl White {
    /// Number of draws that [`skipped`](Self::skipped) leaves out: 20 s at 48 kHz, longer than a
    /// strike's noise. It is odd, because leaps by a power of two give related numbers.
    pub const SKIP: u32 = 1_000_003;

    /// Makes a generator from a seed and the number of a stream, such as a pad's.
    pub const fn new(seed: u32, stream: u32) -> Self {
        Self(Sfc32::new(seed, stream).first() | 1)
    }

    /// Makes a generator that is [`SKIP`](Self::SKIP) draws ahead of this one.
    pub const fn skipped(self) -> Self {
        const FACTOR: u32 = MULTIPLIER.wrapping_pow(White::SKIP);
        Self(self.0.wrapping_mul(FACTOR))
    }

    /// Returns the generator's word.
    #[cfg(cortex_m4f)]
    pub(crate) const fn word(self) -> u32 {
        self.0
    }

    /// Makes a generator from the word of another one.
    #[cfg(cortex_m4f)]
    pub(crate) const fn from_word(word: u32) -> Self {
        Self(word)
    }

    /// Draws the next sample, uniform in -level/2 to level/2.
    #[inline(always)]
    pub fn draw(&mut self, level: i32) -> i32 {
        self.0 = self.0.wrapping_mul(MULTIPLIER);
        smmul(self.0 as i32, level)
    }
}
