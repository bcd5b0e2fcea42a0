//! The bank in Q31: its pairs of sections, the level of their input, and their rest.

use super::gain::Gain;
use super::kernel::{self, ALLOWANCE, Run};
use super::pair::{Pair, Wiring};
use super::settle::{self, Level, X_BITS};
use super::unit::{rings_on, units};
use crate::time::TICK_FRAMES;

/// L parallel chains of M biquads, run in pairs of sections.
///
/// Input and output are Q4.27 blocks. Ticks of 32 frames are counted from the first frame, so that
/// the sizes of blocks change no bit. Without input, sections whose output would stay below a step
/// of the bus are cleared and not run. A bank at rest costs a comparison a block.
///
/// The memory of a bank holds one pair for each section, which always suffices. Sections of equal
/// arithmetic share a pair, so that about half of the pairs usually run (`Bank::size`).
///
/// Worst SNR against `f64`, and cycles: `docs/biquads.md`.
#[derive(Debug)]
pub struct Bank<'m> {
    pub(super) pairs: &'m mut [Pair],
    pub(super) count: usize,
    pub(super) sections: usize,
    pub(super) depth: usize,
    /// Gain from the input straight to the output, summed over all chains.
    pub(super) direct: Gain,
    pub(super) direct_size: f32,
    /// Multiplier of the shifted input into the mix, Q32, that realises `direct`.
    pub(super) direct_q32: i32,
    /// Frame within the tick; ticks begin on even frames.
    pub(super) frame: usize,
    /// Level of the input: the sizes of a tick's inputs add up to less than 2^bits. `None` without
    /// input.
    pub(super) input_bits: Option<u32>,
    /// Sum of the sizes of this tick's inputs, as words.
    pub(super) used: u32,
    /// Largest `used` of the last ticks.
    pub(super) recent: u32,
    /// Number of ticks that `recent` looks back on.
    pub(super) recent_ticks: u8,
    /// Number of bits by which the mix is smaller than the bus.
    pub(super) room: i32,
    pub(super) asks: bool,
    pub(super) ringing: bool,
    pub(super) choked: bool,
}

/// Work of a bank in a tick, on which its cycles depend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TickKind {
    /// A force begins: all sections are scaled anew, up to three times.
    Struck,
    /// The input goes on about as loud as before.
    Driven,
    /// Nothing comes in: the bank rings, or is at rest.
    Free,
}

/// Number of bits by which the level rises above an input that is too large for it.
///
/// A contact force begins over 17 bits, and each rise costs as much as a tick's loops.
const RISE_BITS: u32 = 5;
/// Number of bits by which the level rises above the first input after silence.
const ONSET_BITS: u32 = 7;
/// Number of ticks after which a level that was never reached is lowered.
const PATIENCE_TICKS: u8 = 16;
/// Number of ticks without input between two searches for pairs that have decayed.
const REST_TICKS: u8 = 8;

impl<'m> Bank<'m> {
    /// Makes a bank without chains or memory.
    pub const fn empty() -> Self {
        Self {
            pairs: &mut [],
            count: 0,
            sections: 0,
            depth: 1,
            direct: Gain::ZERO,
            direct_size: 0.0,
            direct_q32: 0,
            frame: 0,
            input_bits: None,
            used: 0,
            recent: 0,
            recent_ticks: 0,
            room: 0,
            asks: false,
            ringing: false,
            choked: false,
        }
    }

    /// Number of sections, of sections in a chain, and of pairs in which they run.
    pub fn size(&self) -> (usize, usize, usize) {
        (self.sections, self.depth, self.count)
    }

    /// Clears all states, so that nothing rings.
    pub fn rest(&mut self) {
        self.pairs.iter_mut().take(self.count).for_each(Pair::rest);
        (self.ringing, self.input_bits, self.used, self.asks) = (false, None, 0, false);
    }

    /// Lays a hand on the bank or takes it away; the sound goes on without a step.
    ///
    /// Under the hand a chain whose slowest pole has the radius r is multiplied by
    /// `min(1, hand / r)` after each frame. It then decays at the faster of both rates, strikes
    /// under the hand included.
    pub fn set_choked(&mut self, choked: bool) {
        if choked == self.choked {
            return;
        }
        self.choked = choked;
        units(self.pairs.get_mut(..self.count)).for_each(settle::exchange);
        if self.ringing {
            self.settle(true);
        }
    }

    /// True if the bank may sound without input; if false, a block without input costs nothing.
    pub fn is_ringing(&self) -> bool {
        self.ringing
    }

    /// Nominal cycles of a whole tick on a Cortex-M4F, for the budget before the tick is rendered.
    ///
    /// They are rounded up by at most a half.
    pub fn cycles(&self, tick: TickKind) -> u32 {
        let each = |pair: &Pair| match (tick, pair.wiring()) {
            (TickKind::Struck, Wiring::Chain) => 3000,
            (TickKind::Struck, _) => 2400,
            (_, Wiring::Chain) => 1200,
            (TickKind::Driven, _) => 640,
            (TickKind::Free, _) => 500,
        };
        let pairs = self.pairs.iter().take(self.count).map(each).sum::<u32>();
        if self.count == 0 || tick == TickKind::Free && !self.ringing { 0 } else { pairs + 1500 }
    }

    /// Adds the bank's sound to `out`, saturating. The bank rings on without input, and behind its
    /// end.
    pub fn render(&mut self, input: Option<&[i32]>, out: &mut [i32]) {
        let input = input.unwrap_or(&[]);
        if self.count == 0 || !self.ringing && input.iter().all(|&word| word == 0) {
            self.frame = (self.frame + out.len()) % TICK_FRAMES;
        } else {
            self.sound(input, out);
        }
    }

    #[inline(never)]
    fn sound(&mut self, input: &[i32], out: &mut [i32]) {
        let (mut input, mut out) = (input, out);
        while !out.is_empty() {
            if self.frame == 0 {
                self.tick();
            }
            let frames = out.len().min(TICK_FRAMES - self.frame);
            let frames = if input.is_empty() { frames } else { frames.min(input.len()) };
            let Some((now, later)) = core::mem::take(&mut out).split_at_mut_checked(frames) else { return };
            let Some((x, more)) = input.split_at_checked(frames.min(input.len())) else { return };
            self.run((!x.is_empty()).then_some(x), now);
            (input, out) = (more, later);
        }
    }

    /// Lowers the level of the input, puts pairs to rest and scales pairs anew, at the start of a
    /// tick.
    fn tick(&mut self) {
        if !self.ringing {
            return;
        }
        self.recent = self.recent.max(self.used);
        self.recent_ticks += 1;
        let before = self.input_bits;
        self.input_bits = before.and_then(|level| {
            // Number of bits by which the inputs stayed below their level.
            let below = |used: u32| ALLOWANCE.ilog2().saturating_sub(bits_of(used)).min(level);
            match (self.used, below(self.used)) {
                (0, _) => None,
                (_, bits) if bits > RISE_BITS + 1 => Some(level - (bits - 1)),
                _ if self.recent_ticks >= PATIENCE_TICKS => Some(level - below(self.recent).saturating_sub(1)),
                _ => Some(level),
            }
        });
        self.used = 0;
        if self.recent_ticks >= PATIENCE_TICKS || before != self.input_bits {
            (self.recent, self.recent_ticks) = (0, 0);
        }
        if self.input_bits.is_none() && (before.is_some() || self.recent_ticks.is_multiple_of(REST_TICKS)) {
            // No short circuit: each unit that has decayed must be cleared.
            self.ringing = units(self.pairs.get_mut(..self.count)).map(rings_on).filter(|&rings| rings).count() > 0;
        }
        if before != self.input_bits {
            self.settle(true);
        } else if self.asks {
            self.settle(false);
        }
    }

    /// Renders frames within a tick, for an input of their number or none.
    fn run(&mut self, x: Option<&[i32]>, out: &mut [i32]) {
        let exponent = self.input_exponent();
        let run = Run {
            bits: self.input_bits.unwrap_or(0).min(31),
            allowance: ALLOWANCE - self.used,
            left: exponent.max(0) as u32,
            right: (-exponent).max(0) as u32,
            direct: self.direct_q32,
            room: self.room as u32,
            odd: self.frame % 2 == 1,
        };
        if self.ringing {
            let outcome = kernel::run(self.pairs.get_mut(..self.count).unwrap_or(&mut []), run, x, out);
            if !outcome.refused {
                self.used += outcome.used;
                self.asks = outcome.asks;
                self.frame = (self.frame + out.len()) % TICK_FRAMES;
                return;
            }
        }
        // Runs as far as the level holds, and scales all pairs anew at the first frame beyond it:
        // the sizes of blocks do not matter.
        let Some(x) = x else {
            self.frame = (self.frame + out.len()) % TICK_FRAMES;
            return;
        };
        let mut left = run.allowance;
        let holds = |word: &&i32| {
            let size = folded(run.word(**word));
            let fits = folded(**word) >> run.bits == 0 && size <= left;
            left = left.saturating_sub(size);
            fits
        };
        let good = x.iter().take_while(holds).count();
        let Some((now, later)) = out.split_at_mut_checked(good.min(out.len())) else { return };
        let Some((given, more)) = x.split_at_checked(good.min(x.len())) else { return };
        if self.ringing && good > 0 {
            self.run(Some(given), now);
        } else {
            self.frame = (self.frame + good) % TICK_FRAMES;
        }
        if let Some(&loud) = more.first() {
            // 36 bits suffice for 32 frames of the largest input. A level that held so far is used
            // up.
            let rise = if self.input_bits.is_some() { RISE_BITS } else { ONSET_BITS };
            let level = (bits_of(folded(loud)) + rise).max(self.input_bits.map_or(0, |level| level + 1));
            self.input_bits = Some(level.min(37));
            (self.used, self.recent, self.recent_ticks) = (0, 0, 0);
            self.ringing = true;
            self.settle(true);
            self.run(Some(more), later);
        }
    }

    /// Exponent of the words: inputs times two to this power add up to [`X_BITS`] bits.
    fn input_exponent(&self) -> i32 {
        self.input_bits.map_or(0, |bits| X_BITS - bits as i32)
    }

    /// Scales units for the level of their input, all or those that ask, and then the mix.
    fn settle(&mut self, all: bool) {
        self.asks = false;
        let exponent = self.input_exponent();
        let has_input = self.input_bits.is_some();
        let input = Level { exponent: has_input.then_some(exponent) };
        // No single input is larger than the bound of their sum.
        let direct = self.direct_size * settle::power_of_two(self.input_bits.map_or(-126, |bits| bits.min(31) as i32));
        let (mut loudness, mut lowest) = (direct, 1000);
        for unit in units(self.pairs.get_mut(..self.count)) {
            if all && has_input {
                unit.iter_mut().for_each(Pair::wake);
            }
            if unit.iter().all(Pair::is_skipped) {
                continue;
            }
            if all || unit.iter().any(|pair| pair.asks != 0) {
                unit.iter_mut().for_each(|pair| pair.asks = 0);
                settle::settle(unit, input);
                settle::set_mix(unit, self.room);
            }
            if let Some(last) = unit.last() {
                loudness += last.loudness();
                lowest = lowest.min(last.exponent());
            }
        }
        // The sum keeps to 30 bits. The multipliers of units and of the direct gain stay below 1/2.
        let direct = if has_input { self.direct.exponent() + 1 - exponent } else { 0 };
        let room = (settle::bits_above(loudness) - 30).max(2 - lowest).max(direct).clamp(0, 31);
        if room != self.room {
            self.room = room;
            units(self.pairs.get_mut(..self.count)).for_each(|unit| settle::set_mix(unit, room));
        }
        self.direct_q32 = if has_input { self.direct.q32(-room - exponent) } else { 0 };
    }
}

fn folded(word: i32) -> u32 {
    (word ^ (word >> 31)) as u32
}

/// Number of bits of the largest of sizes that were combined by OR.
fn bits_of(peak: u32) -> u32 {
    32 - peak.leading_zeros()
}
