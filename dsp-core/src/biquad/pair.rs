//! Two sections side by side or in a row: what a kernel runs at a time.

use super::choke::{Choked, Turn};
use super::design::{Biquad, BiquadError};
use super::extent::Extent;
use super::fractions::Part;
use super::gain::Gain;
use super::pole::{Form, Pole};

/// Largest exponent of a state: with a larger one a state is far below any step of the bus.
pub(super) const MAX_EXPONENT: i32 = 200;

/// A section as the kernels run it.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Cell {
    /// State that does not sound.
    pub(super) u: i32,
    /// State that sounds.
    pub(super) v: i32,
    /// Multiplier e or e²/2^k, Q32.
    pub(super) turn: i32,
    /// Multiplier δ as Q32; for [`Form::Damped`] 1 - δ as Q31.
    pub(super) damp: i32,
    /// Multiplier of the input into u, Q32.
    pub(super) gain_u: i32,
    /// Multiplier of the input into v, Q32.
    pub(super) gain_v: i32,
}

impl Cell {
    const EMPTY: Self = Self { u: 0, v: 0, turn: 0, damp: 0, gain_u: 0, gain_v: 0 };

    /// Makes a section at rest that has no input yet.
    fn new(pole: Pole) -> Self {
        Self { turn: pole.turn, damp: pole.damp, ..Self::EMPTY }
    }
}

/// Two sections; the kernels read the words up to `asks`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Pair {
    /// The sections.
    pub(super) cells: [Cell; 2],
    /// Multiplier of each v into the mix, Q32.
    pub(super) scales: [i32; 2],
    /// Multiplier of the first section's v into the second section's u, Q32.
    pub(super) couple: i32,
    /// Multiplier of the pair before's second v into the first section's u, Q32.
    pub(super) chain: i32,
    /// Lower bound of the size of states: smaller states ask to be settled.
    pub(super) low: u32,
    /// Distance from `low` to the upper bound of states: larger states ask to be settled too.
    pub(super) span: u32,
    /// Form, plus [`Wiring`] times 4, plus [`SKIPPED`] and [`MIRRORED`].
    pub(super) kind: u8,
    /// Shift k of the form.
    pub(super) shift: u8,
    /// Not 0 if the pair asks to be settled.
    pub(super) asks: u8,
    /// True if the pair belongs to the pair before and shares its exponent.
    pub(super) is_tail: bool,
    pub(super) exponent: i32,
    pub(super) gains: [[Gain; 2]; 2],
    /// Bound of the pair's sound until it is settled anew, in steps of the bus.
    pub(super) loudness: f32,
    pub(super) growth: f32,
    pub(super) of_input: f32,
    /// Bits of the largest gain.
    pub(super) gain_bits: i16,
    /// Bits of the sum of the sizes of the impulse response.
    reach_bits: i16,
    /// Values that replace the pair's own when a hand comes or goes.
    pub(super) other: Other,
}

/// Values of a pair for the other state of the hand: laid on if it is away, away if it is laid on.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Other {
    /// Multipliers `turn` and `damp` of each cell.
    poles: [[i32; 2]; 2],
    gains: [[Gain; 2]; 2],
    couple: i32,
    chain: i32,
    growth: f32,
    of_input: f32,
    gain_bits: i16,
    form: u8,
    /// Gains of u and v into the new u of each cell when these values are taken.
    pub(super) there: [[Gain; 2]; 2],
    /// Gains of u and v into the new u of each cell when these values are left.
    back: [[Gain; 2]; 2],
}

impl Other {
    const EMPTY: Self = Self {
        poles: [[0; 2]; 2],
        gains: [[Gain::ZERO; 2]; 2],
        couple: 0,
        chain: 0,
        growth: 0.0,
        of_input: 0.0,
        gain_bits: 0,
        form: 0,
        there: [[Gain::ZERO; 2]; 2],
        back: [[Gain::ZERO; 2]; 2],
    };

    /// Takes the values of a pair that was made for the other state of the hand.
    fn of(pair: &Pair, there: &[Turn], back: &[Turn]) -> Self {
        let ways = |turns: &[Turn]| {
            let mut ways = [[Gain::ZERO; 2]; 2];
            ways.iter_mut().zip(turns).for_each(|(way, turn)| *way = turn.map(Gain::new));
            ways
        };
        Self {
            poles: [&pair.cells[0], &pair.cells[1]].map(|cell| [cell.turn, cell.damp]),
            gains: pair.gains,
            couple: pair.couple,
            chain: pair.chain,
            growth: pair.growth,
            of_input: pair.of_input,
            gain_bits: pair.gain_bits,
            form: pair.kind & FORM,
            there: ways(there),
            back: ways(back),
        }
    }
}

/// Connection of the sections of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Wiring {
    /// One section only.
    Single = 0,
    /// Two sections side by side; both sound.
    Parallel = 1,
    /// Two sections in a row; the second sounds.
    Coupled = 2,
    /// One half of three or four sections in a row.
    Chain = 3,
}

/// Bits of a kind that hold the form.
const FORM: u8 = 3;
/// Bit of a kind: the pair is not run.
pub const SKIPPED: u8 = 16;
/// Bit of a kind: the pair runs on input and output of alternating sign.
pub const MIRRORED: u8 = 32;

impl Pair {
    /// A pair without sections.
    pub const EMPTY: Self = Self {
        cells: [Cell::EMPTY; 2],
        scales: [0; 2],
        couple: 0,
        chain: 0,
        low: 0,
        span: 0,
        kind: SKIPPED,
        shift: 0,
        asks: 0,
        is_tail: false,
        exponent: MAX_EXPONENT,
        gains: [[Gain::ZERO; 2]; 2],
        loudness: 0.0,
        growth: 0.0,
        of_input: 0.0,
        gain_bits: 0,
        reach_bits: 0,
        other: Other::EMPTY,
    };

    /// Makes the one or two pairs of one part alone, or of two to four parts in a row.
    ///
    /// `kept` is the factor by which a hand lowers their states in each frame. `index` is the
    /// number of the chain's first biquad, for the message.
    ///
    /// # Errors
    /// [`BiquadError::UnboundedGain`].
    pub(super) fn of(parts: &[Part<Pole>], kept: f64, index: usize) -> Result<(Self, Option<Self>), BiquadError> {
        let extent = Extent::of(parts);
        if !(0.0..=Biquad::MAX_GAIN).contains(&extent.reach) {
            return Err(BiquadError::UnboundedGain { biquad: index, gain: extent.reach });
        }
        let mut pairs = Self::free(parts, &extent);
        let choked = Choked::of(parts, kept);
        if kept < 1.0
            && let Some(under_hand) = choked.parts.get(..parts.len())
        {
            let held = Self::free(under_hand, &Extent::of(under_hand));
            let ways = choked.there.chunks(2).zip(choked.back.chunks(2));
            for ((pair, held), (there, back)) in pairs.iter_mut().zip(&held).zip(ways) {
                pair.other = Other::of(held, there, back);
            }
        } else {
            let ways = choked.there.chunks(2).zip(choked.back.chunks(2));
            for (pair, (there, back)) in pairs.iter_mut().zip(ways) {
                pair.other = Other::of(pair, there, back);
            }
        }
        let [head, tail] = pairs;
        Ok((head, tail.is_tail.then_some(tail)))
    }

    /// Makes the pairs of parts without a hand; the second is a tail, or empty.
    fn free(parts: &[Part<Pole>], extent: &Extent) -> [Self; 2] {
        let mut pairs = [Self::EMPTY; 2];
        for (number, (pair, parts)) in pairs.iter_mut().zip(parts.chunks(2)).enumerate() {
            let [first, second] = [parts.first(), parts.get(1)];
            pair.is_tail = number > 0;
            (pair.growth, pair.of_input) = (above(extent.growth), above(extent.of_input));
            pair.reach_bits = libm::frexp(extent.reach).1 as i16;
            for ((cell, gains), part) in pair.cells.iter_mut().zip(&mut pair.gains).zip(parts) {
                *cell = Cell::new(part.pole);
                *gains = part.gains.map(Gain::new);
            }
            let couple = |part: Option<&Part<Pole>>| part.map_or(0, |part| part.pole.couple(part.handed));
            (pair.chain, pair.couple) = (couple(first), couple(second));
            if let Some(Part { pole, .. }) = first {
                pair.shift = pole.form.shift() as u8;
                pair.kind = pole.form as u8 | if pole.mirrored { MIRRORED | SKIPPED } else { SKIPPED };
            }
        }
        let [mut head, mut tail] = pairs;
        let largest = [head, tail].iter().flat_map(|pair| pair.gains).flatten().map(Gain::exponent).max();
        head.gain_bits = largest.unwrap_or(0).max(-1000) as i16;
        let wiring = match parts.len() {
            ..=1 => Wiring::Single,
            2 => Wiring::Coupled,
            _ => Wiring::Chain,
        };
        head.kind |= 4 * wiring as u8;
        tail.kind |= 4 * wiring as u8;
        tail.is_tail = wiring == Wiring::Chain;
        [head, tail]
    }

    /// True if the single section of `other` can be joined to this one.
    pub(super) fn takes(&self, other: &Self) -> bool {
        self.wiring() == Wiring::Single
            && other.wiring() == Wiring::Single
            && (self.kind, self.other.form) == (other.kind, other.other.form)
    }

    /// Adds the single section of `other` beside the pair's own.
    pub(super) fn join(&mut self, other: &Self) {
        let ([first, _], [its_gains, _]) = (other.cells, other.gains);
        let ([cells, _], [gains, _]) = (self.cells, self.gains);
        (self.cells, self.gains) = ([cells, first], [gains, its_gains]);
        self.kind += 4 * (Wiring::Parallel as u8 - Wiring::Single as u8);
        (self.growth, self.of_input) = (self.growth.max(other.growth), self.of_input.max(other.of_input));
        self.gain_bits = self.gain_bits.max(other.gain_bits);
        self.reach_bits = self.reach_bits.max(other.reach_bits);
        let (own, its) = (&mut self.other, &other.other);
        own.poles[1] = its.poles[0];
        own.gains[1] = its.gains[0];
        own.there[1] = its.there[0];
        own.back[1] = its.back[0];
        (own.growth, own.of_input) = (own.growth.max(its.growth), own.of_input.max(its.of_input));
        own.gain_bits = own.gain_bits.max(its.gain_bits);
    }

    /// Exchanges all values that depend on the hand, except the states.
    pub(super) fn exchange(&mut self) {
        let other = &mut self.other;
        for (cell, pole) in self.cells.iter_mut().zip(&mut other.poles) {
            let [turn, damp] = pole;
            core::mem::swap(&mut cell.turn, turn);
            core::mem::swap(&mut cell.damp, damp);
        }
        core::mem::swap(&mut self.gains, &mut other.gains);
        core::mem::swap(&mut self.couple, &mut other.couple);
        core::mem::swap(&mut self.chain, &mut other.chain);
        core::mem::swap(&mut self.growth, &mut other.growth);
        core::mem::swap(&mut self.of_input, &mut other.of_input);
        core::mem::swap(&mut self.gain_bits, &mut other.gain_bits);
        let form = self.kind & FORM;
        self.kind = self.kind & !FORM | other.form;
        other.form = form;
        core::mem::swap(&mut other.there, &mut other.back);
        self.shift = self.form().shift() as u8;
    }

    /// Connection of the sections.
    pub(super) fn wiring(&self) -> Wiring {
        match (self.kind >> 2) & 3 {
            0 => Wiring::Single,
            1 => Wiring::Parallel,
            2 => Wiring::Coupled,
            _ => Wiring::Chain,
        }
    }

    /// True if the pair runs on input and output of alternating sign.
    pub(super) fn is_mirrored(&self) -> bool {
        self.kind & MIRRORED != 0
    }

    /// True if the pair is not run.
    pub(super) fn is_skipped(&self) -> bool {
        self.kind & SKIPPED != 0
    }

    /// True if the pair belongs to the pair before.
    pub(super) fn is_tail(&self) -> bool {
        self.is_tail
    }

    /// Form of both sections.
    pub(super) fn form(&self) -> Form {
        match self.kind & 3 {
            0 => Form::Coupled,
            1 => Form::Shifted1,
            2 => Form::Shifted2,
            _ => Form::Damped,
        }
    }

    /// Bound of the pair's sound until it is settled anew, in steps of the bus.
    pub(super) fn loudness(&self) -> f32 {
        if self.is_skipped() { 0.0 } else { self.loudness }
    }

    /// Exponent of the states: words are values times two to this power.
    pub(super) fn exponent(&self) -> i32 {
        self.exponent
    }

    /// Lets the pair run from now on.
    pub(super) fn wake(&mut self) {
        self.kind &= !SKIPPED;
    }

    /// Clears the states and lets the pair run no more.
    pub(super) fn rest(&mut self) {
        for cell in &mut self.cells {
            (cell.u, cell.v) = (0, 0);
        }
        self.kind |= SKIPPED;
        self.asks = 0;
    }

    /// Bound of `max(|u| 2^k, |v|)` of both sections: below twice the maximum.
    pub(super) fn size(&self) -> u32 {
        let folded = |word: i32| word ^ (word >> 31);
        let [a, b] = &self.cells;
        ((folded(a.v) | folded(b.v)) | ((folded(a.u) | folded(b.u)) << self.shift)) as u32
    }

    /// True if the states have left the bounds that `settle` chose.
    pub(super) fn has_left_bounds(&self) -> bool {
        self.size().wrapping_sub(self.low) >= self.span
    }

    /// Bits of the loudest sound that the states may still make, in steps of the bus.
    ///
    /// A slow mode's u becomes its v, at most four times as large. A section's output makes the
    /// next section at most eight times as large.
    pub(super) fn sound_bits(&self) -> i32 {
        let to_come = match self.wiring() {
            Wiring::Single | Wiring::Parallel => 2,
            Wiring::Coupled => 5,
            Wiring::Chain => 11,
        };
        match self.size() {
            0 => -1000,
            size => 32 - size.leading_zeros() as i32 + to_come - self.exponent,
        }
    }

    pub(super) fn set_mix(&mut self, room: i32, is_last: bool) {
        // 2^32 · 2^-(E + room).
        let shift = 32 - self.exponent - room;
        let scale = if (0..31).contains(&shift) { 1 << shift } else { 0 };
        let is_alone = self.cells.get(1).is_none_or(|cell| cell.turn == 0);
        self.scales = match self.wiring() {
            Wiring::Single | Wiring::Parallel => [scale, scale],
            Wiring::Coupled => [0, scale],
            Wiring::Chain if !is_last => [0, 0],
            Wiring::Chain if is_alone => [scale, 0],
            Wiring::Chain => [0, scale],
        };
    }
}

/// Rounds a bound up to single precision, with 1e-5 to spare for the rounding of multipliers.
fn above(bound: f64) -> f32 {
    (bound * (1.0 + 1e-5)) as f32
}
