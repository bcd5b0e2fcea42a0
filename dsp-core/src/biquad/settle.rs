//! Scaling of pairs between ticks: the power of two by which the states of a unit are multiplied.
//!
//! A unit is one pair, or two pairs whose sections stand in a row.
//!
//! # Why nothing can wrap
//!
//! The size of a state is `s = max(|u| 2^k, |v|)`. Between two calls of `settle` (a tick at most)
//! all steps are linear, so that each intermediate result is at most
//!
//! ```text
//! G s + M X    G: the largest growth of states of size 1 over a tick's frames
//!              M: the largest size that a single input of 1 leaves
//!              X: the bound of the sum of all inputs' sizes
//! ```
//!
//! Loading finds G and M by stepping the very sections in `f64` (`extent`). With whole powers of
//! two above each, settle chooses E such that `G s < 2^30` and `M X < 2^29`. So states stay below
//! `2^30 + 2^29`. Rounding, at most five halves of a step a frame, each growing by G, adds less
//! than 2^9.

use super::kernel::ALLOWANCE;
use super::pair::{MAX_EXPONENT, Pair, Wiring};

/// Level of the input, by which the kernels scale it.
///
/// Words are `value · 2^exponent`, and `Σ |word| <= 2^X_BITS` over a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Level {
    /// Exponent of words from values, which count steps of the bus. `None` without input.
    pub(super) exponent: Option<i32>,
}

/// Bits of the sum of the input's words over a tick.
///
/// They are enough for 130 dB of each word, and few enough to leave the multipliers 20 bits beside
/// a resonance of 90 dB.
pub(super) const X_BITS: i32 = ALLOWANCE.ilog2() as i32;
/// Bits that states may grow to within a tick.
const STATE_BITS: i32 = 30;
/// Bits that the input may add to states within a tick.
const INPUT_BITS: i32 = 29;

/// Lays a hand on a unit or takes it away, without a step of the sound. The unit must then be
/// settled.
pub(super) fn exchange(unit: &mut [Pair]) {
    // The new u of each section, with 31 bits more than a word has.
    let mut wide = [[0i64; 2]; 2];
    let mut largest = 0;
    for (pair, wide) in unit.iter_mut().zip(&mut wide) {
        let there = pair.other.there;
        pair.exchange();
        for ((wide, cell), [of_u, of_v]) in wide.iter_mut().zip(&pair.cells).zip(there) {
            *wide = of_u.times(cell.u).saturating_add(of_v.times(cell.v));
            largest = largest.max(wide.unsigned_abs().saturating_mul(1 << pair.shift));
        }
    }
    // States stay below 2^30.
    let down = (64 - largest.leading_zeros()).saturating_sub(30);
    for (pair, wide) in unit.iter_mut().zip(wide) {
        pair.exponent -= down as i32;
        for (cell, wide) in pair.cells.iter_mut().zip(wide) {
            cell.u = (wide >> down) as i32;
            cell.v = shifted(cell.v, -(down as i32));
        }
    }
}

/// Chooses a unit's exponent for an input, shifts its states and derives its multipliers.
pub(super) fn settle(unit: &mut [Pair], input: Level) {
    let Some(head) = unit.first() else { return };
    let (growth, of_input, before) = (head.growth, head.of_input, head.exponent);
    let growth_bits = bits_above(growth);
    let size = unit.iter().fold(0, |size, pair| size | pair.size());
    let bits = 32 - size.leading_zeros() as i32;
    // The multipliers of the input must stay below 1/2, and what it adds below 2^28.
    let for_input = input.exponent.map_or(MAX_EXPONENT, |exponent| {
        let room = (-1 - i32::from(head.gain_bits)).min(INPUT_BITS - X_BITS - bits_above(of_input));
        (exponent + room).min(MAX_EXPONENT)
    });
    // A bit is left for the state to grow before it asks again.
    let for_state = if size == 0 { MAX_EXPONENT } else { before + STATE_BITS - growth_bits - bits - 1 };
    let exponent = for_input.min(for_state);
    let moved = exponent - before;
    let bits = if size == 0 { -1000 } else { bits + moved };
    let shift = input.exponent.map(|from| exponent - from);
    let added = shift.map_or(0.0, |shift| of_input * power_of_two(shift + X_BITS));
    let high = (bits + 1).max(bits_above(added) + 1).max(1).min(STATE_BITS - growth_bits);
    let may_grow = size != 0 && for_input > exponent + 2 && exponent < MAX_EXPONENT && high > 4;
    let low = if may_grow { 1 << (high - 4) } else { 0 };
    let bound = (power_of_two(high) * growth + added + 512.0) * power_of_two(-exponent);
    for pair in unit {
        for (cell, gains) in pair.cells.iter_mut().zip(&pair.gains) {
            (cell.u, cell.v) = (shifted(cell.u, moved), shifted(cell.v, moved));
            let [u, v] = gains.map(|gain| shift.map_or(0, |shift| gain.q32(shift)));
            (cell.gain_u, cell.gain_v) = (u, v);
        }
        pair.exponent = exponent;
        // Of two pairs in a row the first tells when both have decayed.
        pair.low = if pair.is_tail { 0 } else { low };
        pair.span = (1u32 << high) - pair.low;
        pair.loudness = if pair.wiring() == Wiring::Parallel { 2.0 * bound } else { bound };
    }
}

/// Sets the multipliers into a mix of `value · 2^-room`.
pub(super) fn set_mix(unit: &mut [Pair], room: i32) {
    let last = unit.len().saturating_sub(1);
    unit.iter_mut().enumerate().for_each(|(index, pair)| pair.set_mix(room, index == last));
}

/// Shifts a state by a power of two; `settle` makes sure that no high bit is lost.
fn shifted(word: i32, shift: i32) -> i32 {
    match shift {
        0.. => word.wrapping_shl(shift.min(31) as u32),
        right => crate::fixed::rounding_shift_right(word, right.unsigned_abs()),
    }
}

/// 2^exponent, for bounds: at least 2^-126, at most 2^127.
pub(super) fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent.clamp(-126, 127) + 127) as u32) << 23)
}

/// Exponent of the power of two above a bound.
pub(super) fn bits_above(bound: f32) -> i32 {
    // The exponent of a float, biased by 127, is that of the power of two below.
    ((bound.to_bits() >> 23) & 255) as i32 - 126
}
