//! Steps and passes of the work on the next block.

use crate::fourier::Progress;

/// Piece of the work that comes next.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    /// Look at the next bank.
    Bank,
    /// A hand takes its share of the states of a block: next mode.
    Fade(usize),
    /// Look at the next slot of the bank's force.
    Slot,
    /// Transform of the bank's force.
    Force(Progress),
    /// Lines of the force: next pair.
    Unfold(usize),
    /// Lines of the force without the window: next line.
    Unwindow(usize),
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
    /// Spectrum of the bank's own block: next pair.
    Alone(usize),
    /// Transform of that block.
    Block(Progress),
    /// A hand takes its share of that block, and it joins the others: next frame.
    Join(usize),
    /// Nothing left to do in this block.
    Rest,
}

/// Pass over the banks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// The only bank that works: its own block plays.
    Lone,
    /// Banks without a hand: their lines add up to one block.
    Together,
    /// Banks under a hand: their own blocks join that one.
    UnderHand,
}
