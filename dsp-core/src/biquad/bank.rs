//! The bank in Q31: chains, the level of their input, and when they are at rest.

use super::design::{Biquad, BiquadError};
use super::kernel::{self, Signals};
use super::parallel;
use super::section::{Level, Role, SKIPPED, Section};
use crate::fixed::{Scale, qadd, saturating_shift_left};
use crate::resonator::TICK_FRAMES;

/// L parallel chains of M biquads, at most `SECTIONS` in all.
///
/// Input and output are Q4.27 blocks. Ticks of 32 frames are counted from the first frame: what a block's caller does with sizes changes no bit.
/// A chain whose output would be below a quarter of a step of the bus, with no input left, is cleared and not run; a bank at rest
/// costs a comparison a block.
///
/// Worst SNR against `f64`: `cargo test -p host-tests --test biquads -- --nocapture`; cycles: `cargo test -p host-tests --test virtual_biquads -- --nocapture`.
#[derive(Clone, Debug)]
pub struct Bank<const SECTIONS: usize> {
    sections: [Section; SECTIONS],
    count: usize,
    depth: usize,
    /// Of all chains of one section, what goes straight through.
    direct: Scale,
    signals: Signals,
    /// Frame within the tick, and whether the count of all frames is odd: ticks are even.
    frame: usize,
    /// Inputs of this tick are smaller than 2^bits; negative: there are none.
    input_bits: i32,
    /// All inputs of this tick, or'ed after folding their sign.
    peak: u32,
    /// By how many bits the mix is smaller than the bus.
    room: u32,
    asks: bool,
    ringing: bool,
}

impl<const SECTIONS: usize> Bank<SECTIONS> {
    /// A bank of no chains.
    pub const EMPTY: Self = Self {
        sections: [Section::EMPTY; SECTIONS],
        count: 0,
        depth: 1,
        direct: Scale::ZERO,
        signals: Signals::SILENT,
        frame: 0,
        input_bits: -1000,
        peak: 0,
        room: 0,
        asks: false,
        ringing: false,
    };

    /// Derives a bank at rest from chains of `depth` sections, one behind the other.
    ///
    /// # Errors
    /// [`BiquadError`].
    pub fn new(biquads: &[Biquad], depth: usize) -> Result<Self, BiquadError> {
        let mut bank = Self::EMPTY;
        bank.load(biquads, depth)?;
        Ok(bank)
    }

    /// As [`new`](Self::new), in place. What rang is cleared; after an error the bank is empty.
    ///
    /// # Errors
    /// [`BiquadError`].
    pub fn load(&mut self, biquads: &[Biquad], depth: usize) -> Result<(), BiquadError> {
        let sections = biquads.len();
        self.count = 0;
        if !(1..=4).contains(&depth) || !sections.is_multiple_of(depth) {
            return Err(BiquadError::Depth { depth, sections });
        }
        let room = self.sections.get_mut(..sections).ok_or(BiquadError::Full { sections, room: SECTIONS })?;
        let mut direct = 0.0;
        let chains = room.chunks_exact_mut(depth).zip(biquads.chunks_exact(depth));
        for (chain, (slots, given)) in chains.enumerate() {
            let parts = if depth == 1 { None } else { parallel::parts(given) };
            if let Some((through, parts)) = parts {
                for (index, biquad) in given.iter().enumerate() {
                    biquad.check(chain * depth + index)?;
                }
                direct += through;
                for ((index, slot), part) in slots.iter_mut().enumerate().zip(parts.into_iter().flatten()) {
                    let (section, mirrored) = Section::new(&part, chain * depth + index)?;
                    *slot = section;
                    slot.place(Role::Only, u8::from(mirrored), u8::from(mirrored), false);
                }
                continue;
            }
            // Those that run mirrored go last, so that the sign changes at most once.
            let mut order = [None; 4];
            let mut place = 0;
            for mirrored_pass in [false, true] {
                for (index, biquad) in given.iter().enumerate() {
                    let (section, mirrored) = Section::new(biquad, chain * depth + index)?;
                    if mirrored == mirrored_pass {
                        if let Some(slot) = order.get_mut(place) {
                            *slot = Some((section, mirrored));
                        }
                        place += 1;
                    }
                }
            }
            let mut before = None;
            for (index, (slot, ordered)) in slots.iter_mut().zip(order).enumerate() {
                let Some((section, mirrored)) = ordered else { continue };
                *slot = section;
                let is_last = index + 1 == depth;
                let role = match (depth, is_last) {
                    (1, _) => Role::Only,
                    (_, true) => Role::Last,
                    _ => Role::Inner,
                };
                let source = if index == 0 { u8::from(mirrored) } else { 2 };
                let target = if is_last { u8::from(mirrored) } else { 2 };
                slot.place(role, source, target, before.is_some_and(|before| before != mirrored));
                before = Some(mirrored);
            }
            if depth == 1 {
                direct += given.first().map_or(0.0, |biquad| biquad.numerator[0]);
            }
        }
        let (frame, count) = (self.frame, sections);
        *self = Self { sections: self.sections, count, depth, direct: Scale::new(direct), frame, ..Self::EMPTY };
        Ok(())
    }

    /// Sections, and how many of them a chain has.
    pub fn size(&self) -> (usize, usize) {
        (self.count, self.depth)
    }

    /// Clears what rings.
    pub fn rest(&mut self) {
        self.sections.iter_mut().take(self.count).for_each(Section::rest);
        (self.ringing, self.input_bits, self.peak) = (false, -1000, 0);
    }

    /// Whether anything sounds or may: false means that a block without input costs nothing.
    pub fn is_ringing(&self) -> bool {
        self.ringing
    }

    /// Adds the bank's sound to `out`, saturating. Without an input it rings on.
    pub fn render(&mut self, input: Option<&[i32]>, out: &mut [i32]) {
        if self.count == 0 {
            return;
        }
        if input.is_none() && !self.ringing {
            self.frame = (self.frame + out.len()) % TICK_FRAMES;
            return;
        }
        let mut input = input.unwrap_or(&[]);
        let mut out = out;
        while !out.is_empty() {
            if self.frame == 0 {
                self.tick();
            }
            let frames = out.len().min(TICK_FRAMES - self.frame);
            let (now, later) = out.split_at_mut(frames);
            let (x, more) = input.split_at(frames.min(input.len()));
            self.run(x, now);
            (input, out) = (more, later);
            self.frame = (self.frame + frames) % TICK_FRAMES;
        }
    }

    /// What is decided on a tick: whether the input's level fell, which chains are at rest, whether sections are to be scaled anew.
    fn tick(&mut self) {
        let bits = bits_of(self.peak);
        self.peak = 0;
        let falls = bits < self.input_bits - 3;
        if falls {
            self.input_bits = bits;
        }
        if bits < 0 && self.ringing {
            let sections = self.sections.get_mut(..self.count).unwrap_or(&mut []);
            // All are asked: those that are done are cleared.
            self.ringing = units(sections).map(rings_on).filter(|&rings| rings).count() > 0;
        }
        if (falls || self.asks) && self.ringing {
            self.settle();
        }
    }

    /// Frames within a tick.
    fn run(&mut self, x: &[i32], out: &mut [i32]) {
        let (mut x, mut out, mut frame) = (x, out, self.frame);
        while !out.is_empty() {
            // As far as the level holds: the frame at which it does not is where all is scaled anew, whatever the blocks are.
            let limit = 1u64 << self.input_bits.clamp(0, 32);
            let holds = |word: &&i32| u64::from(word.unsigned_abs()) < limit;
            let good = x.iter().take_while(holds).count();
            let frames = if good == x.len() { out.len() } else { good };
            if frames == 0 {
                // One bit more than this frame needs; a limit of 1 holds silence only, so that the frame is not 0.
                self.input_bits = bits_of(x.first().map_or(0, |word| word.unsigned_abs())).max(0) + 1;
                self.ringing = true;
                self.settle();
                continue;
            }
            let (now, later) = out.split_at_mut(frames);
            let (given, more) = x.split_at(frames.min(x.len()));
            self.peak = given.iter().fold(self.peak, |peak, &word| peak | word.unsigned_abs());
            if self.ringing {
                self.sound(given, now, frame % 2 == 1);
            }
            frame += frames;
            (x, out) = (more, later);
        }
    }

    fn sound(&mut self, given: &[i32], out: &mut [i32], odd: bool) {
        let frames = out.len();
        let up = self.input_exponent() as u32;
        let signals = &mut self.signals;
        let padded = given.iter().copied().chain(core::iter::repeat(0));
        for ((input, alternating), (index, x)) in
            signals.input.iter_mut().zip(&mut signals.alternating).zip(padded.enumerate()).take(frames)
        {
            *input = x << up;
            *alternating = if (index % 2 == 1) == odd { *input } else { input.wrapping_neg() };
        }
        signals.mix.fill(0);
        signals.alternating_mix.fill(0);
        let sections = self.sections.get_mut(..self.count).unwrap_or(&mut []);
        self.asks = kernel::run(sections, signals, frames, odd);
        let room = self.room;
        for (index, (out, (&plain, &other))) in
            out.iter_mut().zip(signals.mix.iter().zip(&signals.alternating_mix)).enumerate()
        {
            let other = if (index % 2 == 1) == odd { other } else { -other };
            *out = qadd(*out, saturating_shift_left(plain + other, room));
        }
        if !self.direct.is_zero() {
            for (out, &x) in out.iter_mut().zip(given) {
                *out = qadd(*out, self.direct.apply(x));
            }
        }
    }

    /// The input is shifted left so that it has 30 bits.
    fn input_exponent(&self) -> i32 {
        if self.input_bits < 0 { 0 } else { (30 - self.input_bits).max(0) }
    }

    /// Scales all sections for the level of their input, and the mix for all chains.
    fn settle(&mut self) {
        self.asks = false;
        let exponent = self.input_exponent();
        let input = match self.input_bits {
            ..0 => Level::SILENT,
            bits => Level { exponent, bits: bits + exponent },
        };
        let count = self.count;
        let sections = self.sections.get_mut(..count).unwrap_or(&mut []);
        let (mut loudest, mut lowest) = (-1000, 1000);
        for chain in units(sections) {
            if input != Level::SILENT {
                chain.iter_mut().for_each(Section::wake);
            }
            if chain.iter().any(|section| section.kind != SKIPPED) {
                let out = chain.iter_mut().fold(input, |level, section| section.settle(level));
                (loudest, lowest) = (loudest.max(out.bits - out.exponent), lowest.min(out.exponent));
            }
        }
        // The sum of all chains has 29 bits, and the scale of each is below 1/2.
        let chains = 32 - (count as u32).leading_zeros() as i32;
        self.room = (loudest + chains - 29).max(2 - lowest).clamp(0, 60) as u32;
        for last in units(sections).filter_map(<[Section]>::last_mut) {
            last.set_mix(self.room as i32);
        }
    }
}

/// What stands side by side: sections alone, and chains of sections that could not be parted.
fn units(sections: &mut [Section]) -> impl Iterator<Item = &mut [Section]> {
    sections.split_inclusive_mut(|section| section.role() != Role::Inner)
}

/// Bits below which all of or'ed sizes are; -1000 for none.
fn bits_of(peak: u32) -> i32 {
    if peak == 0 { -1000 } else { 32 - peak.leading_zeros() as i32 }
}

/// Whether a chain without input will still be heard; else it is cleared, and left out until there is input again.
fn rings_on(chain: &mut [Section]) -> bool {
    // A state reaches the output by way of the sections behind it; four of them together stay below a quarter of a step.
    let mut reach = 0;
    let mut audible = false;
    for section in chain.iter().rev().filter(|section| section.kind != SKIPPED) {
        audible |= section.value_bits() + reach > -4;
        reach += section.reach_bits().max(0);
    }
    if !audible {
        chain.iter_mut().for_each(Section::rest);
    }
    audible
}
