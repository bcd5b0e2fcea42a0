//! Pieces of the work on the next block, one after the other.

use super::bank::{FrameBank, InFrames, SLOTS};
use super::costs::{
    CLEAR, COMBINE, DERIVED_MODE, FADED_MODE, FILL, FRAMES_AT_ONCE, GATHER_LINE, GATHER_MODE, HALVE, JOIN,
    LINES_AT_ONCE, PAN, PUT, SILENCE, SYNTHESIS_LINE, SYNTHESIS_MODE, UNFOLD, UNWINDOW, WAKE,
};
use super::head::Head;
use super::kernel;
use super::mixer::FrameMixer;
use super::mode::Line;
use super::spectrum::{self, PAIRS_AT_ONCE};
use super::step::{Pass, Step};
use super::{BLOCK_FRAMES, LINES, POINTS};
use crate::fourier::{Complex, Progress};

impl FrameMixer<'_> {
    /// Works for about a number of cycles, or until the end of a step.
    pub(super) fn advance<'b>(&mut self, banks: &mut [impl InFrames<'b>], cycles: u32) {
        let [buffers] = &mut *self.buffers else {
            self.step = Step::Rest;
            return;
        };
        let [first, second] = &mut buffers.stereo;
        let stereo = if self.front { first } else { second };
        let (lines, force) = (&mut buffers.lines, &mut buffers.force);
        if let Step::Sum(mut progress) = self.step {
            self.done += progress.advance(stereo, cycles);
            self.step = match progress.is_over() {
                true => self.begin_hands(),
                false => Step::Sum(progress),
            };
            return;
        }
        let retired = match self.step {
            Step::Synthesis(..) => banks.iter().filter_map(InFrames::frames).map(FrameBank::retired_amplitude).sum(),
            _ => 0.0,
        };
        let Some(pad) = banks.get_mut(self.bank) else {
            self.step = match self.pass {
                Pass::Lone | Pass::UnderHand => Step::Rest,
                Pass::Together if self.is_first => {
                    stereo.fill([0.0; 2]);
                    self.done += SILENCE;
                    self.begin_hands()
                }
                Pass::Together => Step::Sum(Progress::start(POINTS)),
            };
            return;
        };
        let pass = self.pass;
        let is_of_pass = |bank: &&mut FrameBank<'_>| match pass {
            Pass::Lone => true,
            Pass::Together => bank.hand.next().is_none(),
            Pass::UnderHand => bank.hand.next().is_some(),
        };
        let Some(bank) = pad.frames_mut().filter(is_of_pass) else {
            self.bank += 1;
            return;
        };
        let (spent, next) = match self.step {
            Step::Bank => (0, if bank.hand.now().is_some() { Step::Fade(0) } else { Step::Slot }),
            Step::Fade(mode) => {
                let end = bank.modes.len().min(mode + (cycles / FADED_MODE) as usize + 1);
                bank.fade(mode..end);
                let next = if end < bank.modes.len() { Step::Fade(end) } else { Step::Slot };
                (FADED_MODE * (end - mode) as u32, next)
            }
            Step::Slot => {
                if let Some(last) = bank.to_gather(self.slot) {
                    spectrum::fill(last, force);
                    (FILL, Step::Force(Progress::start(BLOCK_FRAMES)))
                } else if self.slot < SLOTS {
                    self.slot += 1;
                    (0, Step::Slot)
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
                    let next = if has_tail { Step::Unwindow(0) } else { Step::Gather(0, 0) };
                    (UNFOLD * (end - pair) as u32 + WAKE, next)
                }
            }
            Step::Unwindow(line) => {
                let end = BLOCK_FRAMES.min(line + (cycles / UNWINDOW) as usize + 1);
                spectrum::unwindow(lines, line..end, force);
                let next = if end < BLOCK_FRAMES { Step::Unwindow(end) } else { Step::Combine(0) };
                (UNWINDOW * (end - line) as u32, next)
            }
            Step::Combine(pair) => {
                let end = spectrum::PAIRS.min(pair + (cycles / COMBINE) as usize + 1);
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
                    // From the next tick on its products are saved, maybe sooner than was planned.
                    self.first_tail.1 = self.first_tail.1.min(self.tick as u32 + 1);
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
                    (spent, Step::Slot)
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
                    (spent, if pass == Pass::Together { Step::Pan(0) } else { Step::Alone(0) })
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
            Step::Alone(pair) => {
                let end = spectrum::PAIRS.min(pair + PAIRS_AT_ONCE);
                spectrum::alone(lines, pair..end, own_block(pass, stereo, force));
                let is_over = end == spectrum::PAIRS;
                let next = if is_over { Step::Block(Progress::start(BLOCK_FRAMES)) } else { Step::Alone(end) };
                (HALVE * (end - pair) as u32, next)
            }
            Step::Block(mut progress) => {
                let spent = progress.advance(own_block(pass, stereo, force), cycles);
                let next = match (pass, bank.hand.next()) {
                    _ if !progress.is_over() => Step::Block(progress),
                    (Pass::Lone, None) => Step::Rest,
                    _ => Step::Join(0),
                };
                (spent, next)
            }
            Step::Join(frame) => {
                let end = BLOCK_FRAMES.min(frame + FRAMES_AT_ONCE);
                match (pass, bank.hand.next()) {
                    (Pass::Lone, Some(hand)) => spectrum::fade(own_block(pass, stereo, force), frame..end, hand),
                    (_, Some(hand)) => spectrum::join(force, frame..end, hand, bank.gains, stereo),
                    _ => {}
                }
                if end < BLOCK_FRAMES {
                    (JOIN * (end - frame) as u32, Step::Join(end))
                } else {
                    (self.bank, self.slot) = (self.bank + 1, 0);
                    (JOIN * (end - frame) as u32, Step::Bank)
                }
            }
            Step::Sum(_) | Step::Rest => (0, Step::Rest),
        };
        self.done += spent;
        self.step = next;
    }

    /// Begins the work on banks under a hand; gives the next step.
    fn begin_hands(&mut self) -> Step {
        (self.bank, self.slot, self.pass) = (0, 0, Pass::UnderHand);
        if self.has_hands { Step::Bank } else { Step::Rest }
    }
}

/// Place of a bank's own block: that of the block if it is the only one.
fn own_block<'a>(
    pass: Pass,
    stereo: &'a mut [Complex; POINTS],
    scratch: &'a mut [Complex; BLOCK_FRAMES],
) -> &'a mut [Complex; BLOCK_FRAMES] {
    match (pass, stereo.first_chunk_mut()) {
        (Pass::Lone, Some(block)) => block,
        _ => scratch,
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
