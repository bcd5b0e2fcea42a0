//! Two sections side by side or in a row: what a kernel runs at a time.

use super::choke::{Choked, Turn};
use super::design::{Biquad, BiquadError};
use super::extent::Extent;
use super::fractions::Part;
use super::gain::Gain;
use super::pole::{Form, Pole};

/// The largest exponent of a state: beyond it all is far below any bus.
pub(super) const MAX_EXPONENT: i32 = 200;

/// A section as the kernels have it.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Cell {
    /// The component that does not sound.
    pub(super) u: i32,
    /// The component that sounds.
    pub(super) v: i32,
    /// e or e²/2^k, Q32.
    pub(super) turn: i32,
    /// δ as Q32; 1 - δ as Q31 for [`Form::Damped`].
    pub(super) damp: i32,
    /// Q32 of the input into u.
    pub(super) gain_u: i32,
    /// Q32 of the input into v.
    pub(super) gain_v: i32,
}

impl Cell {
    const EMPTY: Self = Self { u: 0, v: 0, turn: 0, damp: 0, gain_u: 0, gain_v: 0 };

    /// A part at rest, without input.
    fn new(pole: Pole) -> Self {
        Self { turn: pole.turn, damp: pole.damp, ..Self::EMPTY }
    }
}

/// Two sections. The first words are what the kernels read.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Pair {
    /// The sections.
    pub(super) cells: [Cell; 2],
    /// Q32 of each v into the mix.
    pub(super) scales: [i32; 2],
    /// Q32 of the first's v into the second's u.
    pub(super) couple: i32,
    /// Q32 of what the pair before hands on, into the first's u.
    pub(super) chain: i32,
    /// States smaller than this ask to be settled.
    pub(super) low: u32,
    /// So do those that are as large as this above `low`.
    pub(super) span: u32,
    /// Form, [`Wiring`] times 4, and the bits below.
    pub(super) kind: u8,
    /// k of the form.
    pub(super) shift: u8,
    /// Whether it asks to be settled.
    pub(super) asks: u8,
    /// Whether it belongs to the pair before, whose exponent is its own.
    pub(super) is_tail: bool,
    pub(super) exponent: i32,
    pub(super) gains: [[Gain; 2]; 2],
    /// Bound of what it sounds like until it is settled anew, in steps of the bus.
    pub(super) loudness: f32,
    pub(super) growth: f32,
    pub(super) of_input: f32,
    /// Bits of the largest gain, and of the sum of its impulse response's sizes.
    pub(super) gain_bits: i16,
    reach_bits: i16,
    /// What a hand's coming or going puts in its place.
    pub(super) other: Other,
}

/// What a pair is under the hand, or without it: what changes when the hand comes or goes.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Other {
    /// Turn and damp of each cell.
    poles: [[i32; 2]; 2],
    gains: [[Gain; 2]; 2],
    couple: i32,
    chain: i32,
    growth: f32,
    of_input: f32,
    gain_bits: i16,
    form: u8,
    /// What each u becomes on the way there, and on the way back.
    pub(super) there: [[Gain; 2]; 2],
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

    /// Of a pair made of the parts under the hand.
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

/// How the sections of a pair stand to one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Wiring {
    /// There is no second.
    Single = 0,
    /// Side by side; both sound.
    Parallel = 1,
    /// One behind the other; the second sounds.
    Coupled = 2,
    /// A half of three or four, one behind the other.
    Chain = 3,
}

/// In a kind: the form.
const FORM: u8 = 3;
/// In a kind: it is not run.
pub const SKIPPED: u8 = 16;
/// In a kind: on input and output of alternating sign.
pub const MIRRORED: u8 = 32;

impl Pair {
    /// No sections.
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

    /// The pairs, one or two, of a part that stands alone, or of two to four that stand behind one another. `index` is that of the chain's first
    /// biquad, for the message. `kept` is what a hand leaves of their states after a frame.
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

    /// The pairs of parts, without a hand; the second is a tail, or empty.
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

    /// Whether another single section may stand beside this one's.
    pub(super) fn takes(&self, other: &Self) -> bool {
        self.wiring() == Wiring::Single
            && other.wiring() == Wiring::Single
            && (self.kind, self.other.form) == (other.kind, other.other.form)
    }

    /// Takes a single section beside its own.
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

    /// What a hand's coming or going makes of its sections, but for their states.
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

    /// How its sections stand.
    pub(super) fn wiring(&self) -> Wiring {
        match (self.kind >> 2) & 3 {
            0 => Wiring::Single,
            1 => Wiring::Parallel,
            2 => Wiring::Coupled,
            _ => Wiring::Chain,
        }
    }

    /// Whether it runs on input and output of alternating sign.
    pub(super) fn is_mirrored(&self) -> bool {
        self.kind & MIRRORED != 0
    }

    /// Whether it is not run.
    pub(super) fn is_skipped(&self) -> bool {
        self.kind & SKIPPED != 0
    }

    /// Whether it belongs to the pair before.
    pub(super) fn is_tail(&self) -> bool {
        self.is_tail
    }

    /// Its form.
    pub(super) fn form(&self) -> Form {
        match self.kind & 3 {
            0 => Form::Coupled,
            1 => Form::Shifted1,
            2 => Form::Shifted2,
            _ => Form::Damped,
        }
    }

    /// Bound of its sound until it is settled anew, in steps of the bus.
    pub(super) fn loudness(&self) -> f32 {
        if self.is_skipped() { 0.0 } else { self.loudness }
    }

    /// Words of its states are values times two to this.
    pub(super) fn exponent(&self) -> i32 {
        self.exponent
    }

    /// Runs it from now on.
    pub(super) fn wake(&mut self) {
        self.kind &= !SKIPPED;
    }

    /// Clears the states and leaves it out.
    pub(super) fn rest(&mut self) {
        for cell in &mut self.cells {
            (cell.u, cell.v) = (0, 0);
        }
        self.kind |= SKIPPED;
        self.asks = 0;
    }

    /// `max(|u| 2^k, |v|)` of both, rounded up to the next power of two less one.
    pub(super) fn size(&self) -> u32 {
        let folded = |word: i32| word ^ (word >> 31);
        let [a, b] = &self.cells;
        ((folded(a.v) | folded(b.v)) | ((folded(a.u) | folded(b.u)) << self.shift)) as u32
    }

    /// Whether its states have left the bounds that `settle` chose.
    pub(super) fn has_left_bounds(&self) -> bool {
        self.size().wrapping_sub(self.low) >= self.span
    }

    /// Bits of what the states may still sound like, in steps of the bus: a slow mode's u becomes its v, at most four times as large, and
    /// what a section hands on makes at most eight times as much of the next.
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

/// A bound in single precision, with a little to spare for the rounding of multipliers.
fn above(bound: f64) -> f32 {
    (bound * (1.0 + 1e-5)) as f32
}
