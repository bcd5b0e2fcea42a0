//! A bank of modes in frames, and its head.

use super::hand::{Decay, HEAD_FRAME, Hand};
use super::head::Head;
use super::mode::{FrameMode, Line};
use super::{BLOCK_FRAMES, POINTS, RETIREMENT_BLOCKS};
use crate::fixed;
use crate::fourier::Complex;
use crate::resonator::retirement::Retired;
use crate::resonator::{Place, Retirement, gain_at};
use crate::square_root::square_root;
use crate::table::layout::GainRecord;

/// A bank of modes in frames.
///
/// Accuracy of a mode at full scale against `f64`: 105 dB and better (`cargo test -p host-tests
/// --test stages frames -- --nocapture`).
#[derive(Debug)]
pub struct FrameBank<'m> {
    pub(super) modes: &'m mut [FrameMode],
    pub(super) lines: &'m mut [Line],
    /// Two heads, each at the position of a slot; the second has memory only if the table has
    /// several positions.
    pub(super) heads: [Head<'m>; SLOTS],
    pub(super) positions: Positions<'m>,
    pub(super) hand: Hand,
    /// Gains from the bank's bus to both sides.
    pub(super) gains: [f32; 2],
    /// Number of modes of the table below Nyquist, those that live in the head alone included.
    pub(super) mode_count: u16,
    pub(super) ringing: u16,
    /// First frame of the coming run in its block.
    pub(super) frame: u16,
    /// Amplitude that retired modes leave out; it decays from block to block.
    pub(super) retired: Retired,
}

/// Number of positions at which a bank plays force at a time.
pub(super) const SLOTS: usize = 2;

/// Gains and heads of a table with several positions; empty for one with a single position.
#[derive(Debug)]
pub(super) struct Positions<'m> {
    /// Number of positions.
    pub(super) count: usize,
    /// Heads of all positions by lag, and their exponent.
    pub(super) heads: &'m mut [i32],
    pub(super) exponent: i32,
    /// Index of each mode in the table.
    pub(super) indices: &'m mut [u16],
    /// Gains of the table, and their factor.
    pub(super) gains: &'m [GainRecord],
    pub(super) scale: f32,
    /// Position whose gains the modes hold.
    pub(super) held: f32,
}

/// A pad, with a bank in frames or without.
pub trait InFrames<'b> {
    /// Bank in frames of the pad.
    fn frames(&self) -> Option<&FrameBank<'b>>;
    /// Bank in frames of the pad, to work on.
    fn frames_mut(&mut self) -> Option<&mut FrameBank<'b>>;
}

impl<'b> InFrames<'b> for FrameBank<'b> {
    fn frames(&self) -> Option<&Self> {
        Some(self)
    }

    fn frames_mut(&mut self) -> Option<&mut Self> {
        Some(self)
    }
}

impl FrameBank<'_> {
    /// A bank without modes.
    pub const fn empty() -> Self {
        Self {
            modes: &mut [],
            lines: &mut [],
            heads: [const { Head::empty() }; SLOTS],
            positions: Positions {
                count: 1,
                heads: &mut [],
                exponent: 0,
                indices: &mut [],
                gains: &[],
                scale: 0.0,
                held: 0.0,
            },
            hand: Hand::NONE,
            gains: [0.0; 2],
            mode_count: 0,
            ringing: 0,
            frame: 0,
            retired: Retired::NOTHING,
        }
    }

    /// Number of modes of the table below Nyquist.
    pub fn mode_count(&self) -> usize {
        usize::from(self.mode_count)
    }

    /// Number of modes that a run takes: all while the head sounds, else those that ring.
    pub fn running_modes(&self) -> u32 {
        u32::from(if self.is_head_active() { self.mode_count } else { self.ringing })
    }

    /// True if a force at a second position need not merge with one at the first.
    pub fn has_positions(&self) -> bool {
        self.positions.count > 1
    }

    /// Sum of the amplitudes that have been retired and may still be missing, 1.0 = full scale.
    pub fn retired_amplitude(&self) -> f32 {
        self.retired.amplitude()
    }

    /// Begins a run of at most a tick's frames; `frame` is its first frame in the block.
    pub fn begin_run(&mut self, frame: usize) {
        self.frame = (frame % BLOCK_FRAMES) as u16;
    }

    /// True if [`FrameBank::render`] makes a sound without a force.
    #[inline(always)]
    pub fn is_head_active(&self) -> bool {
        self.heads.iter().any(Head::is_active)
    }

    /// True if a force has acted in this block.
    pub(super) fn is_forced(&self) -> bool {
        self.heads.iter().any(Head::is_forced)
    }

    /// Nominal cycles of the heads over a run of frames, under a force or not.
    pub fn head_cycles(&self, frames: u32, force: bool) -> u32 {
        let [first, second] = &self.heads;
        let cycles = first.cycles(frames, force) + second.cycles(frames, false);
        let under_hand = if self.hand.now().is_some() && cycles > 0 { frames * HEAD_FRAME } else { 0 };
        cycles + under_hand
    }

    /// True if the bank sounds or will.
    pub fn is_active(&self) -> bool {
        self.ringing > 0 || self.is_head_active()
    }

    /// Adds the heads' sound for the run that [began](Self::begin_run) to the pad's bus, under the
    /// forces of both slots: exact, at the very sample.
    pub fn render(&mut self, forces: [Option<&[i32]>; SLOTS], out: &mut [i32]) {
        let slots = if self.has_positions() { SLOTS } else { 1 };
        for (head, force) in self.heads.iter_mut().zip(forces).take(slots) {
            match self.hand.now() {
                None => head.render(self.frame.into(), force, out),
                Some(hand) => head.render_under(hand, self.frame.into(), force, out),
            }
        }
    }

    /// Lays a hand on the bank, or lifts it: from the block behind the next one on.
    pub fn lay_hand(&mut self, lies: bool) {
        self.hand.lay(lies);
    }

    /// True if a hand is on its way to the bank or from it.
    pub fn is_hand_moving(&self) -> bool {
        self.hand.is_moving()
    }

    /// Slot for a strike at a position. `is_driven` says which slots contacts drive; a slot is also
    /// taken while its head sounds, up to 2N frames longer.
    pub fn place(&self, position: f32, is_driven: impl Fn(u8) -> bool) -> Place {
        let [first, second] = &self.heads;
        let is_taken = |slot: u8, head: &Head<'_>| is_driven(slot) || head.is_active();
        if self.positions.count < 2 || first.position == position {
            return Place::FIRST;
        }
        if second.position == position {
            return Place { slot: 1, ..Place::FIRST };
        }
        if !is_taken(0, first) {
            return Place { moves: true, ..Place::FIRST };
        }
        if !is_taken(1, second) {
            return Place { slot: 1, moves: true, is_merged: false };
        }
        let distance = |head: &Head<'_>| (head.position - position).abs();
        Place { slot: u8::from(distance(second) < distance(first)), moves: false, is_merged: true }
    }

    /// Moves a slot that is not taken to a position, 0 to 1: its head lies between those of the
    /// table's positions, as the gains do. It interpolates 2N taps.
    pub fn set_position(&mut self, slot: u8, position: f32) {
        let Positions { count, heads, exponent, .. } = &self.positions;
        let Some(head) = self.heads.get_mut(usize::from(slot)).filter(|_| *count > 1) else { return };
        head.position = position;
        let place = position * (count - 1) as f32;
        let below = (place as usize).min(count - 1);
        let at = |position: usize| heads.get(position.min(count - 1) * POINTS..).unwrap_or(&[]);
        head.set([at(below), at(below + 1)], place - below as f32, *exponent);
    }

    /// Force of the last block in a slot that frames have to gather; `None` if there is none.
    pub(super) fn to_gather(&self, slot: usize) -> Option<&[i32; BLOCK_FRAMES]> {
        self.heads.get(slot).filter(|_| !self.modes.is_empty())?.last_block()
    }

    /// Response of a slot's head if a transform is to make its tail; else `None`.
    pub(super) fn tail_response(&self, slot: usize) -> Option<&[Complex]> {
        self.heads.get(slot).and_then(Head::tail_response)
    }

    /// True if the bank has work to do for the next block.
    pub(super) fn works(&self) -> bool {
        self.ringing > 0 || (0..SLOTS).any(|slot| self.to_gather(slot).is_some())
    }

    /// True if the modes do not hold the gains of a slot's position.
    pub(super) fn is_to_derive(&self, slot: usize) -> bool {
        self.positions.count > 1 && self.heads.get(slot).is_some_and(|head| head.position != self.positions.held)
    }

    /// Gives modes the gains of a slot's position.
    pub(super) fn derive(&mut self, slot: usize, modes: core::ops::Range<usize>) {
        let Positions { count, indices, gains, scale, .. } = &self.positions;
        let Some(position) = self.heads.get(slot).map(|head| head.position) else { return };
        let indices = indices.get(modes.clone()).unwrap_or(&[]);
        for (mode, &index) in self.modes.get_mut(modes).unwrap_or(&mut []).iter_mut().zip(indices) {
            let (sine, cosine) = gain_at(gains, *count, index.into(), position);
            let (re, im) = (cosine * scale, -sine * scale);
            let [x, y] = mode.step;
            let twice = [x * x - y * y, 2.0 * x * y];
            mode.gain = [re * twice[0] - im * twice[1], re * twice[1] + im * twice[0]];
        }
    }

    /// Notes that the modes hold the gains of a slot's position.
    pub(super) fn hold(&mut self, slot: usize) {
        self.positions.held = self.heads.get(slot).map_or(0.0, |head| head.position);
    }

    /// Lets all modes ring, for a force that reaches them.
    pub(super) fn wake(&mut self) {
        self.lines.iter_mut().for_each(|line| line.ringing = line.count);
        self.ringing = self.modes.len() as u16; // banks count in 16 bits
    }

    /// Takes the hand's share of a block from the states of some modes.
    pub(super) fn fade(&mut self, modes: core::ops::Range<usize>) {
        let Some(left) = self.hand.now().map(Decay::of_block) else { return };
        for mode in self.modes.get_mut(modes).unwrap_or(&mut []) {
            let [re, im] = mode.state;
            mode.state = [re * left, im * left];
        }
    }

    /// Retires modes of some lines that no longer sound: those whose amplitude at the block's
    /// beginning is below the threshold, while the sum of retired amplitudes allows it. Gives their
    /// number.
    ///
    /// Looks at the lines whose turn `block` is. `elsewhere` is the retired amplitude of all that
    /// is not in this bank, 1.0 = full scale.
    pub(super) fn retire(
        &mut self,
        lines: core::ops::Range<usize>,
        first_mode: usize,
        block: usize,
        elsewhere: f32,
    ) -> u32 {
        let rang = self.ringing;
        let unit = self.gains[0].max(self.gains[1]) / fixed::ONE_Q27 as f32;
        let audible = Retirement::THRESHOLD / unit.max(f32::MIN_POSITIVE);
        let (mut first, mut at) = (first_mode, lines.start);
        let turn = (block + RETIREMENT_BLOCKS - at % RETIREMENT_BLOCKS) % RETIREMENT_BLOCKS;
        for number in (at + turn..lines.end).step_by(RETIREMENT_BLOCKS) {
            let before = self.lines.get(at..number).unwrap_or(&[]);
            first += before.iter().map(|line| usize::from(line.count)).sum::<usize>();
            at = number;
            self.retire_from(number, first, [unit, audible * audible], elsewhere);
        }
        u32::from(rang - self.ringing)
    }

    /// Retires modes of a line from its last one on; `first` is its first mode. A mode is audible
    /// from a squared amplitude in bus steps on.
    fn retire_from(&mut self, line: usize, first: usize, [unit, audible]: [f32; 2], elsewhere: f32) {
        let Some(line) = self.lines.get_mut(line) else { return };
        while let Some(last) = line.ringing.checked_sub(1) {
            let Some(mode) = self.modes.get_mut(first + usize::from(last)) else { return };
            let squared = |[x, y]: [f32; 2]| x * x + y * y;
            // At the block's beginning the amplitude is below |s|/|z^N|.
            let (size, decay) = (squared(mode.state), squared(mode.step));
            if size > audible * decay {
                return;
            }
            let decay = square_root(decay);
            let amplitude = square_root(size) / decay * unit;
            if elsewhere + self.retired.amplitude() + amplitude > Retirement::SUM {
                return;
            }
            if size > 0.0 {
                self.retired.add(amplitude, decay);
            }
            mode.state = [0.0; 2];
            line.ringing = last;
            self.ringing -= 1;
        }
    }

    /// Ends the sound of all modes and heads at once. A hand stays.
    pub fn rest(&mut self) {
        self.modes.iter_mut().for_each(|mode| mode.state = [0.0; 2]);
        self.lines.iter_mut().for_each(|line| line.ringing = 0);
        self.heads.iter_mut().for_each(Head::rest);
        (self.ringing, self.retired) = (0, Retired::NOTHING);
    }

    /// Begins a block for the hand, the heads and the sum of retired amplitudes.
    pub(super) fn begin_block(&mut self) {
        self.hand.begin_block();
        let hand = self.hand.now();
        self.heads.iter_mut().for_each(|head| head.begin_block(hand));
        self.retired.decay();
    }
}
