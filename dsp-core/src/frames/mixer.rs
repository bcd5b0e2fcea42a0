//! Work of all banks in frames, a block ahead, in pieces; and their sum, as it plays.

use super::bank::{FrameBank, InFrames, SLOTS};
use super::costs::{
    BEGIN_FORCE, CLEAR, COMBINE, DERIVED_MODE, FILL, FORCE, GATHER_LINE, GATHER_MODE, LEAST_SPAN, LINES_AT_ONCE, PAN,
    PLAY_FRAME, PRODUCT, PUT, SYNTHESIS_LINE, SYNTHESIS_MODE, TAIL, TAIL_TICKS, TICK, UNFOLD, bank_cycles, due,
};
use super::head::Head;
use super::kernel;
use super::mode::Line;
use super::samples;
use super::spectrum::{self, Lines, PAIRS_AT_ONCE};
use super::{BLOCK_FRAMES, LINES, PADDED_LINES, POINTS, RETIREMENT_BLOCKS, TICKS};
use crate::fourier::{self, Complex, Progress};
use crate::memory::{Lender, OutOfMemory, Region};
use crate::time::TICK_FRAMES;

/// Spectra of all banks in frames, and the work on the next block.
#[derive(Debug)]
pub struct FrameMixer<'m> {
    buffers: &'m mut [Buffers],
    /// Number of the buffer that plays.
    front: bool,
    /// True if modes that no longer sound retire.
    retires: bool,
    /// Retired amplitude of the modes that are not in frames, 1.0 = full scale.
    retired_beside: f32,
    /// Number of modes that have retired in this tick.
    retired_modes: u32,
    /// Number of blocks that have begun, modulo [`RETIREMENT_BLOCKS`](super::RETIREMENT_BLOCKS).
    block: usize,
    /// True if the block that plays, and the block that is being made, hold any sound.
    sounds: [bool; 2],
    step: Step,
    /// Number of the bank that is being worked on.
    bank: usize,
    /// Number of the slot whose force is being worked on.
    slot: usize,
    /// True if no bank has added to the next block yet.
    is_first: bool,
    /// Cycles of this block's work that are done, and all of them.
    done: u32,
    all: u32,
    /// Cycles of this block's work up to the end of the first bank's tail, 0 without one, and the
    /// number of ticks for them.
    first_tail: (u32, u32),
    /// Number of the tick in this block.
    tick: usize,
}

/// Memory of a mixer: 12.3 KB.
#[derive(Debug)]
struct Buffers {
    /// Spectra or transforms of `left + i right`: of the block that plays, and of the next one.
    stereo: [[Complex; POINTS]; 2],
    /// Lines of one bank: of its force, then of its modes.
    lines: Lines,
    /// Transform of one bank's force.
    force: [Complex; BLOCK_FRAMES],
}

/// Piece of the work that comes next.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// Look at the next bank.
    Bank,
    /// Transform of the bank's force.
    Force(Progress),
    /// Lines of the force: next pair.
    Unfold(usize),
    /// Spectrum of the head's tail: next pair.
    Combine(usize),
    /// Transform of the tail.
    Tail(Progress),
    /// States from the force's lines: next line and its first mode.
    Gather(usize, usize),
    /// Lines from the states: next line and its first mode.
    Synthesis(usize, usize),
    /// Both sides from the bank's lines: next line.
    Pan(usize),
    /// Transform of both sides.
    Sum(Progress),
    /// Nothing left to do in this block.
    Rest,
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
            sounds: [false; 2],
            step: Step::Rest,
            bank: 0,
            slot: 0,
            is_first: true,
            done: 0,
            all: 0,
            first_tail: (0, 1),
            tick: 0,
        }
    }

    /// Takes the memory of a mixer. Modes that no longer sound retire if `retires`.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(lender: &mut impl Lender<'m>, retires: bool) -> Result<Self, OutOfMemory> {
        let silent = || Buffers {
            stereo: [[[0.0; 2]; POINTS]; 2],
            lines: [[0.0; 2]; PADDED_LINES],
            force: [[0.0; 2]; BLOCK_FRAMES],
        };
        Ok(Self { buffers: lender.take(Region::Fast, 1, silent)?, retires, ..Self::empty() })
    }

    /// Takes the memory of a mixer and a place for it; `None` from an account.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn place(lender: &mut impl Lender<'m>, retires: bool) -> Result<Option<&'m mut Self>, OutOfMemory> {
        let mixer = Self::take(lender, retires)?;
        let place = lender.take(Region::Fast, 1, Self::empty)?.first_mut();
        Ok(place.map(|place| {
            *place = mixer;
            place
        }))
    }

    /// Adds a run of frames from `frame` of the block on to the stereo bus.
    pub fn render(&self, frame: usize, out: &mut [[i32; 2]]) {
        let (true, [buffers]) = (self.sounds[0], &*self.buffers) else { return };
        let [first, second] = &buffers.stereo;
        let stereo = if self.front { second } else { first };
        kernel::play(stereo, frame, out);
    }

    /// Nominal cycles of a tick's work on the next block, and of playing the present one.
    ///
    /// A piece of the work may end up to 3000 cycles behind its share.
    pub fn tick_cycles(&self) -> u32 {
        let plays = if self.sounds[0] { TICK_FRAMES as u32 * PLAY_FRAME } else { 0 };
        let works = !matches!(self.step, Step::Rest);
        let share = || due(self.tick, self.all, self.first_tail).min(self.all).saturating_sub(self.done);
        plays + if works { share() + TICK } else { 0 }
    }

    /// True if neither this block nor the next one has any sound from frames.
    pub fn is_silent(&self) -> bool {
        !self.sounds[0] && !self.sounds[1]
    }

    /// Begins a block: the one that was made plays, and the work on the next one begins.
    pub fn begin_block<'b>(&mut self, banks: &mut [impl InFrames<'b>]) {
        while !matches!(self.step, Step::Rest) {
            self.advance(banks, u32::MAX);
        }
        self.front = !self.front;
        self.block = (self.block + 1) % RETIREMENT_BLOCKS;
        self.sounds = [self.sounds[1], false];
        banks.iter_mut().filter_map(InFrames::frames_mut).for_each(FrameBank::begin_block);
        (self.done, self.all, self.tick) = (0, 0, 0);
        self.choose_tails(banks);
        let works = |bank: &FrameBank<'_>| bank.works();
        (self.bank, self.slot) = (0, 0);
        self.step = Step::Rest;
        if banks.iter().filter_map(InFrames::frames).any(works) {
            self.all += fourier::cycles(POINTS);
            if self.first_tail.0 == 0 {
                let forces = |bank: &FrameBank<'_>| (0..SLOTS).filter(|&slot| bank.to_gather(slot).is_some()).count();
                self.done = BEGIN_FORCE * banks.iter().filter_map(InFrames::frames).map(forces).sum::<usize>() as u32;
                self.all += self.done;
            }
            self.sounds[1] = true;
            (self.step, self.is_first) = (Step::Bank, true);
        }
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
            let ready = self.all + FORCE + TAIL;
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

    /// Works for about a number of cycles, or until the end of a step.
    fn advance<'b>(&mut self, banks: &mut [impl InFrames<'b>], cycles: u32) {
        let [buffers] = &mut *self.buffers else {
            self.step = Step::Rest;
            return;
        };
        let [first, second] = &mut buffers.stereo;
        let stereo = if self.front { first } else { second };
        let (lines, force) = (&mut buffers.lines, &mut buffers.force);
        if let Step::Sum(mut progress) = self.step {
            self.done += progress.advance(stereo, cycles);
            self.step = if progress.is_over() { Step::Rest } else { Step::Sum(progress) };
            return;
        }
        let retired: f32 = banks.iter().filter_map(InFrames::frames).map(FrameBank::retired_amplitude).sum();
        let Some(pad) = banks.get_mut(self.bank) else {
            self.step = Step::Sum(Progress::start(POINTS));
            return;
        };
        let Some(bank) = pad.frames_mut() else {
            self.bank += 1;
            return;
        };
        let (spent, next) = match self.step {
            Step::Bank => {
                if let Some(last) = bank.to_gather(self.slot) {
                    spectrum::fill(last, force);
                    (FILL, Step::Force(Progress::start(BLOCK_FRAMES)))
                } else if self.slot < SLOTS {
                    self.slot += 1;
                    (0, Step::Bank)
                } else if bank.ringing > 0 {
                    lines.fill([0.0; 2]);
                    (CLEAR, Step::Synthesis(0, 0))
                } else {
                    (self.bank, self.slot) = (self.bank + 1, 0);
                    (0, Step::Bank)
                }
            }
            Step::Force(mut progress) => {
                let spent = progress.advance(force, cycles);
                (spent, if progress.is_over() { Step::Unfold(0) } else { Step::Force(progress) })
            }
            Step::Unfold(pair) => {
                let end = spectrum::PAIRS.min(pair + PAIRS_AT_ONCE);
                spectrum::unfold(force, pair..end, lines);
                if end < spectrum::PAIRS {
                    (UNFOLD * PAIRS_AT_ONCE as u32, Step::Unfold(end))
                } else {
                    bank.wake();
                    let has_tail = bank.tail_response(self.slot).is_some();
                    let next = if has_tail { Step::Combine(0) } else { Step::Gather(0, 0) };
                    (UNFOLD * (end - pair) as u32, next)
                }
            }
            Step::Combine(pair) => {
                let count = PAIRS_AT_ONCE.min((cycles / COMBINE) as usize + 1);
                let end = spectrum::PAIRS.min(pair + count);
                spectrum::combine(lines, bank.tail_response(self.slot).unwrap_or(&[]), pair..end, force);
                let is_over = end == spectrum::PAIRS;
                let next = if is_over { Step::Tail(Progress::start(BLOCK_FRAMES)) } else { Step::Combine(end) };
                (COMBINE * (end - pair) as u32, next)
            }
            Step::Tail(mut progress) => {
                let spent = progress.advance(force, cycles);
                if progress.is_over() {
                    if let Some(tail) = bank.heads.get_mut(self.slot).and_then(Head::begin_tail) {
                        spectrum::put_tail(force, tail);
                    }
                    (spent + PUT, Step::Gather(0, 0))
                } else {
                    (spent, Step::Tail(progress))
                }
            }
            Step::Gather(line, mode) => {
                let derives = bank.is_to_derive(self.slot);
                let of_mode = GATHER_MODE + if derives { DERIVED_MODE } else { 0 };
                let cost = |line: &Line| GATHER_LINE + of_mode * u32::from(line.count);
                let (end, count, spent) = piece(bank, line, cycles, cost);
                if derives {
                    bank.derive(self.slot, mode..mode + count);
                }
                let modes = bank.modes.get_mut(mode..).unwrap_or(&mut []);
                kernel::gather(modes, bank.lines.get(line..end).unwrap_or(&[]), line, lines);
                if end < LINES {
                    (spent, Step::Gather(end, mode + count))
                } else {
                    bank.hold(self.slot);
                    self.slot += 1;
                    (spent, Step::Bank)
                }
            }
            Step::Synthesis(line, mode) => {
                let (end, count, spent) =
                    piece(bank, line, cycles, |line| SYNTHESIS_LINE + SYNTHESIS_MODE * u32::from(line.ringing));
                if self.retires {
                    let elsewhere = self.retired_beside + retired - bank.retired_amplitude();
                    self.retired_modes += bank.retire(line..end, mode, self.block, elsewhere);
                }
                let modes = bank.modes.get_mut(mode..).unwrap_or(&mut []);
                kernel::synthesize(modes, bank.lines.get(line..end).unwrap_or(&[]), line, lines);
                if end < LINES {
                    (spent, Step::Synthesis(end, mode + count))
                } else {
                    spectrum::fold(lines);
                    (spent, Step::Pan(0))
                }
            }
            Step::Pan(line) => {
                let end = LINES.min(line + LINES_AT_ONCE);
                match self.is_first {
                    true => spectrum::pan::<false>(lines, line..end, bank.gains, stereo),
                    false => spectrum::pan::<true>(lines, line..end, bank.gains, stereo),
                }
                if end < LINES {
                    (PAN * LINES_AT_ONCE as u32, Step::Pan(end))
                } else {
                    (self.bank, self.slot, self.is_first) = (self.bank + 1, 0, false);
                    (PAN * (end - line) as u32, Step::Bank)
                }
            }
            Step::Sum(_) | Step::Rest => (0, Step::Rest),
        };
        self.done += spent;
        self.step = next;
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

/// Lines from `line` on that take about a number of cycles: their end, the number of all their
/// modes, and the cycles that `cost` says.
fn piece(bank: &FrameBank<'_>, line: usize, cycles: u32, cost: impl Fn(&Line) -> u32) -> (usize, usize, u32) {
    let (mut end, mut count, mut spent) = (line, 0, 0);
    for line in bank.lines.get(line..).unwrap_or(&[]) {
        (end, count) = (end + 1, count + usize::from(line.count));
        spent += cost(line);
        if spent >= cycles {
            return (end, count, spent);
        }
    }
    (LINES, count, spent)
}
