//! Work of all banks in frames, a block ahead, in pieces; and their sum, as it plays.

use super::bank::{FrameBank, InFrames, SLOTS};
use super::costs::{
    ALONE, BEGIN_FORCE, BEGIN_TAIL, FORCE, JOIN, LEAST_SPAN, PAN, PLAY_FRAME, PRODUCT, SILENCE, TAIL, TAIL_TICKS, TICK,
    bank_cycles, due, fade_cycles,
};
use super::head::Head;
use super::kernel;
use super::samples;
use super::spectrum::{self, Lines};
use super::step::{Pass, Step};
use super::{BLOCK_FRAMES, LINES, POINTS, RETIREMENT_BLOCKS, TICKS};
use zerocopy::FromZeros;

use crate::fourier::{self, Complex, Progress};
use crate::memory::{Memory, OutOfMemory, Region};
use crate::time::TICK_FRAMES;

/// Spectra of all banks in frames, and the work on the next block.
#[derive(Debug)]
pub struct FrameMixer<'m> {
    pub(super) buffers: &'m mut [Buffers],
    /// Number of the buffer that plays.
    pub(super) front: bool,
    /// True if modes that no longer sound retire.
    pub(super) retires: bool,
    /// Retired amplitude of the modes that are not in frames, 1.0 = full scale.
    pub(super) retired_beside: f32,
    /// Number of modes that have retired in this tick.
    pub(super) retired_modes: u32,
    /// Number of blocks that have begun, modulo [`RETIREMENT_BLOCKS`](super::RETIREMENT_BLOCKS).
    pub(super) block: usize,
    /// Form of the block that plays, and of the block that is being made.
    forms: [BlockForm; 2],
    pub(super) step: Step,
    /// Number of the bank that is being worked on.
    pub(super) bank: usize,
    /// Number of the slot whose force is being worked on.
    pub(super) slot: usize,
    /// True if no bank has added to the next block yet.
    pub(super) is_first: bool,
    pub(super) pass: Pass,
    /// True if any bank is under a hand in the next block.
    pub(super) has_hands: bool,
    /// Cycles of this block's work that are done, and all of them.
    pub(super) done: u32,
    all: u32,
    /// Cycles of this block's work up to the end of the first bank's tail, 0 without one, and the
    /// number of ticks for them.
    pub(super) first_tail: (u32, u32),
    /// Number of the tick in this block.
    pub(super) tick: usize,
    /// True for this block and the last one if banks gather a force.
    gathers: [bool; 2],
}

/// Form of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
enum BlockForm {
    Silent,
    /// Transform of `left + i right`.
    Stereo,
    /// Transform of the only bank that sounds, and its gains to both sides.
    Lone([f32; 2]),
}

/// Memory of a mixer: 12.3 KB.
#[derive(Debug, FromZeros)]
pub(super) struct Buffers {
    /// Spectra or transforms of `left + i right`, or transforms of one bank: of the block that
    /// plays, and of the next one.
    pub(super) stereo: [[Complex; POINTS]; 2],
    /// Lines of one bank: of its force, then of its modes.
    pub(super) lines: Lines,
    /// Transform of one bank's force, or of its block under a hand.
    pub(super) force: [Complex; BLOCK_FRAMES],
}

impl<'m> FrameMixer<'m> {
    /// A mixer without memory.
    const fn empty() -> Self {
        Self {
            buffers: &mut [],
            front: false,
            retires: false,
            retired_beside: 0.0,
            retired_modes: 0,
            block: 0,
            forms: [BlockForm::Silent; 2],
            step: Step::Rest,
            bank: 0,
            slot: 0,
            is_first: true,
            pass: Pass::Together,
            has_hands: false,
            done: 0,
            all: 0,
            first_tail: (0, 1),
            tick: 0,
            gathers: [false; 2],
        }
    }

    /// Takes the memory of a mixer. Modes that no longer sound retire if `retires`.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, retires: bool) -> Result<Self, OutOfMemory> {
        Ok(Self { buffers: memory.take_zeros(Region::Fast, 1)?, retires, ..Self::empty() })
    }

    /// Takes the memory of a mixer and a place for it; `None` from a memory that only
    /// counts.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn place(memory: &mut Memory<'m>, retires: bool) -> Result<Option<&'m mut Self>, OutOfMemory> {
        let mixer = Self::take(memory, retires)?;
        let place = memory.take(Region::Fast, 1, Self::empty)?.first_mut();
        Ok(place.map(|place| {
            *place = mixer;
            place
        }))
    }

    /// Adds a run of frames from `frame` of the block on to the stereo bus.
    pub fn render(&self, frame: usize, out: &mut [[i32; 2]]) {
        let [buffers] = &*self.buffers else { return };
        let [first, second] = &buffers.stereo;
        let stereo = if self.front { second } else { first };
        match (self.forms[0], stereo.first_chunk()) {
            (BlockForm::Stereo, _) => kernel::play(stereo, frame, out),
            (BlockForm::Lone(gains), Some(block)) => kernel::play_lone(block, &gains, frame, out),
            _ => {}
        }
    }

    /// Nominal cycles of a tick's work on the next block, and of playing the present one.
    ///
    /// A piece of the work may end up to 3000 cycles behind its share.
    pub fn tick_cycles(&self) -> u32 {
        let plays = if self.forms[0] == BlockForm::Silent { 0 } else { TICK_FRAMES as u32 * PLAY_FRAME };
        let works = !matches!(self.step, Step::Rest);
        let share = || due(self.tick, self.all, self.first_tail).min(self.all).saturating_sub(self.done);
        plays + if works { share() + TICK } else { 0 }
    }

    /// Number of ticks, from this one on, in which banks gather a force, as far as is known. A
    /// force that has gone on for three blocks is expected to go on.
    pub fn dear_ticks<'b>(&self, banks: &[impl InFrames<'b>]) -> u32 {
        let rest = TICKS.saturating_sub(self.tick) as u32;
        match self.gathers {
            [false, _] => 0,
            [true, gathered] if banks.iter().filter_map(InFrames::frames).any(FrameBank::is_forced) => {
                if gathered {
                    u32::MAX
                } else {
                    rest + TICKS as u32
                }
            }
            _ => rest,
        }
    }

    /// True if neither this block nor the next one has any sound from frames.
    pub fn is_silent(&self) -> bool {
        self.forms == [BlockForm::Silent; 2]
    }

    /// Forgets the block that plays and the work on the next one.
    pub fn rest(&mut self) {
        (self.forms, self.step) = ([BlockForm::Silent; 2], Step::Rest);
        (self.done, self.all, self.retired_modes) = (0, 0, 0);
        self.gathers = [false; 2];
    }

    /// Begins a block: the one that was made plays, and the work on the next one begins.
    pub fn begin_block<'b>(&mut self, banks: &mut [impl InFrames<'b>]) {
        while !matches!(self.step, Step::Rest) {
            self.advance(banks, u32::MAX);
        }
        self.front = !self.front;
        self.block = (self.block + 1) % RETIREMENT_BLOCKS;
        self.forms = [self.forms[1], BlockForm::Silent];
        banks.iter_mut().filter_map(InFrames::frames_mut).for_each(FrameBank::begin_block);
        (self.done, self.all, self.tick) = (0, 0, 0);
        self.choose_tails(banks);
        (self.bank, self.slot, self.step) = (0, 0, Step::Rest);
        self.gathers = [false, self.gathers[0]];
        let (mut free, mut under_hand, mut gains) = (0, 0, [0.0; 2]);
        for bank in banks.iter().filter_map(InFrames::frames).filter(|bank| bank.works()) {
            *(if bank.hand.next().is_some() { &mut under_hand } else { &mut free }) += 1;
            gains = bank.gains;
        }
        match free + under_hand {
            0 => return,
            1 => {
                self.all += ALONE - free * BLOCK_FRAMES as u32 * JOIN;
                (self.pass, self.forms[1]) = (Pass::Lone, BlockForm::Lone(gains.map(|gain| 0.5 * gain)));
            }
            _ => {
                self.all += under_hand * ALONE + free * LINES as u32 * PAN;
                self.all += if free > 0 { fourier::cycles(POINTS) } else { SILENCE };
                (self.has_hands, self.pass, self.forms[1]) = (under_hand > 0, Pass::Together, BlockForm::Stereo);
            }
        }
        let forces = |bank: &FrameBank<'_>| (0..SLOTS).filter(|&slot| bank.to_gather(slot).is_some()).count() as u32;
        let begun: u32 = banks.iter().filter_map(InFrames::frames).map(forces).sum();
        self.gathers[0] = begun > 0;
        let has_tail = self.first_tail.0 > 0;
        self.done = begun * if has_tail { BEGIN_TAIL } else { BEGIN_FORCE };
        self.all += self.done;
        if has_tail {
            self.first_tail.0 += self.done;
        }
        (self.step, self.is_first) = (Step::Bank, true);
    }

    /// Counts the cycles of the banks' work, and chooses whose tails a transform makes: those that
    /// cost less than the products that they save.
    fn choose_tails<'b>(&mut self, banks: &mut [impl InFrames<'b>]) {
        let without: u32 = banks.iter().filter_map(InFrames::frames).map(bank_cycles).sum();
        self.first_tail = (0, 1);
        let is_long = |bank: &FrameBank<'_>| bank.heads[0].last_span() >= LEAST_SPAN;
        if !banks.iter().filter_map(InFrames::frames).any(is_long) {
            self.all = without;
            return;
        }
        let share = ((without + fourier::cycles(POINTS)) / TICKS as u32).max(1);
        for bank in banks.iter_mut().filter_map(InFrames::frames_mut) {
            let ready = self.all + fade_cycles(bank) + FORCE + TAIL;
            let ticks = ready.div_ceil(share).max(TAIL_TICKS);
            let saved_frames = (TICKS as u32).saturating_sub(ticks) * TICK_FRAMES as u32;
            let [head, _] = &mut bank.heads;
            if !bank.modes.is_empty() && head.last_span() * saved_frames * PRODUCT > TAIL {
                head.want_tail();
                if self.all == 0 {
                    self.first_tail = (ready, ticks);
                }
            }
            self.all += bank_cycles(bank);
        }
    }

    /// Works on the next block at the end of a tick of this one, counted from 0: by then the share
    /// of the ticks that have passed is done. `retired_beside` is the retired amplitude of all
    /// modes that are not in frames, 1.0 = full scale. Gives the number of modes that retired.
    pub fn end_tick<'b>(&mut self, tick: usize, retired_beside: f32, banks: &mut [impl InFrames<'b>]) -> u32 {
        self.retired_beside = retired_beside;
        let due = due(tick, self.all, self.first_tail);
        while self.done < due && !matches!(self.step, Step::Rest) {
            self.advance(banks, due - self.done);
        }
        self.tick = tick + 1;
        core::mem::take(&mut self.retired_modes)
    }

    /// Makes the spectrum of a head's taps, for its tails.
    pub(super) fn make_response(&mut self, head: &mut Head<'_>) {
        let ([buffers], Some((taps, response))) = (&mut *self.buffers, head.taps_and_response()) else { return };
        spectrum::fill_taps(taps, &mut buffers.force);
        let mut progress = Progress::start(BLOCK_FRAMES);
        while !progress.is_over() {
            progress.advance(&mut buffers.force, u32::MAX);
        }
        spectrum::unfold(&buffers.force, 0..spectrum::PAIRS, &mut buffers.lines);
        for (to, line) in response.iter_mut().zip(spectrum::inner(&buffers.lines)) {
            *to = line.map(|x| x * (1.0 / POINTS as f32));
        }
    }

    /// Makes a block of a bank from its states, for its head.
    pub(super) fn make_block(&mut self, bank: &mut FrameBank<'_>) {
        let [buffers] = &mut *self.buffers else { return };
        let stereo = &mut buffers.stereo[0];
        buffers.lines.fill([0.0; 2]);
        kernel::synthesize(bank.modes, bank.lines, 0, &mut buffers.lines);
        spectrum::fold(&mut buffers.lines);
        spectrum::pan::<false>(&buffers.lines, 0..LINES, [1.0, 0.0], stereo);
        let mut progress = Progress::start(POINTS);
        while !progress.is_over() {
            progress.advance(stereo, u32::MAX);
        }
    }

    /// Sample of the block that [`FrameMixer::make_block`] made.
    pub(super) fn made(&self, frame: usize) -> f32 {
        self.buffers.first().map_or(0.0, |buffers| samples::sample(&buffers.stereo[0], frame)[0])
    }
}
