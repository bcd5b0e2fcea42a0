//! The first order's hot loops in plain Rust: the definition of the bits.

use super::{COARSE_BITS, OnePole, SumsKind};
use crate::fixed::{qadd, saturate, saturating_shift_left};
use crate::noise::White;

/// Largest word in the bus' format that is written to the loops' line.
const LARGEST_LINE_WORD: i32 = (1 << 30) - 1;

/// Adds noise, filtered, to `out`.
pub fn from_noise<const EQUAL: bool>(filter: &mut OnePole, out: &mut [i32]) {
    for out in out {
        let e = filter.noise.draw(filter.level);
        filter.step::<EQUAL>(e);
        *out = qadd(*out, filter.sound());
    }
}

/// Adds `buffer`, filtered, to `out`, for as many frames as both have.
///
/// Leaves 4 times the state's high word in the buffer, with two bits more from below if the filter
/// [is far](OnePole::is_far).
pub fn from_buffer<const EQUAL: bool>(filter: &mut OnePole, buffer: &mut [i32], out: &mut [i32]) {
    for (word, out) in buffer.iter_mut().zip(out) {
        filter.step::<EQUAL>(*word);
        *word = filter.truncated();
        *out = qadd(*out, filter.sound());
    }
}

/// Fills `words` with noise of a level.
pub fn noise(noise: &mut White, level: i32, words: &mut [i32]) {
    words.iter_mut().for_each(|word| *word = noise.draw(level));
}

/// Clips sums at 2.0 and adds them, filtered, to `out`, for as many frames as both have.
///
/// Leaves the state in the place of the sums: 4 times its high word, or, if the filter
/// [is far](OnePole::is_far), its word on the bus. Gives the sizes of the words that it leaves,
/// or'ed. A sum's format is Q29, [`COARSE_BITS`] less of a coarse kind.
#[inline(never)]
pub fn from_sums(filter: &mut OnePole, kind: SumsKind, sums: &mut [i32], out: &mut [i32]) -> u32 {
    let clip = if kind.is_coarse() { clipped::<true> } else { clipped::<false> };
    let mut sizes = 0;
    for (word, out) in sums.iter_mut().zip(out) {
        let e = clip(*word);
        if kind.is_equal() {
            filter.step::<true>(e)
        } else {
            filter.step::<false>(e)
        }
        *word = filter.line_word();
        sizes |= (*word ^ (*word >> 31)) as u32;
        *out = qadd(*out, if filter.is_far() { filter.word_of_bus() } else { filter.sound() });
    }
    sizes
}

/// Converts a sum to an input in Q29, clipped at 2.0.
#[inline(always)]
pub fn clipped<const COARSE: bool>(sum: i32) -> i32 {
    let bits = if COARSE { COARSE_BITS } else { 0 };
    sum.clamp(-1 << (30 - bits), (1 << (30 - bits)) - 1) << bits
}

impl OnePole {
    /// Word that damping multiplies: 4 times the state's high word, which is below 2^29. If the
    /// filter [is far](Self::is_far), it has two bits more from below.
    #[inline(always)]
    fn truncated(&self) -> i32 {
        if self.is_far() { (self.state >> 30) as i32 } else { ((self.state >> 32) as i32) << 2 }
    }

    #[inline(always)]
    fn step<const EQUAL: bool>(&mut self, e: i32) {
        let damping = self.truncated();
        let below = self.state - (i64::from(damping) << 30);
        let [damp, b0, b1, ..] = &mut self.lines;
        self.state += i64::from(damp.value) * i64::from(damping);
        if self.whole {
            self.state += (i64::from(damp.value) * below) >> 30;
        }
        if EQUAL {
            self.state += i64::from(b0.value) * i64::from(e + self.last);
        } else {
            self.state += i64::from(b0.value) * i64::from(e);
            self.state += i64::from(b1.value) * i64::from(self.last);
            b1.advance();
        }
        self.last = e;
        damp.advance();
        b0.advance();
    }

    /// State as loops read it: 4 times the high word. If the filter [is far](Self::is_far), it is
    /// the word on the bus, at most 8.0, so that loops of small gain have all bits.
    #[inline(always)]
    fn line_word(&self) -> i32 {
        if !self.is_far() {
            return self.truncated();
        }
        self.word_of_bus().clamp(-LARGEST_LINE_WORD, LARGEST_LINE_WORD)
    }

    /// State on the bus, from all its bits.
    #[inline(always)]
    fn word_of_bus(&self) -> i32 {
        saturate(self.state >> (32 + self.shift).clamp(0, 63))
    }

    /// State on the bus, from the bits that the kernels use for sound.
    #[inline(always)]
    fn sound(&self) -> i32 {
        if self.whole {
            self.word_of_bus()
        } else if self.is_far() {
            scaled(self.truncated(), self.shift + 2)
        } else {
            scaled((self.state >> 32) as i32, self.shift)
        }
    }
}

/// Converts a state's word to the bus: shifted right, rounding down, or left, saturating.
#[inline(always)]
pub fn scaled(word: i32, shift: i32) -> i32 {
    if shift >= 0 { word >> shift.min(31) } else { saturating_shift_left(word, shift.unsigned_abs()) }
}
