//! A hand on a bank in frames.
//!
//! Rates add: under a hand that takes c nepers a frame, what falls by d nepers a frame by itself
//! falls by `d + c`. So the hand is one factor on the whole sound, `e^{-c n}`, and what is struck
//! under it answers with `h[n] e^{-c n}`. A hand comes and goes with a block.

use super::{BLOCK_FRAMES, TICKS};
use crate::SampleRate;
use crate::exponential;
use crate::resonator::coefficient::decay_of_t60;
use crate::time::TICK_FRAMES;

/// Largest fall in a block, in nepers (24 dB). The head computes with forces that are smaller by as
/// much, and so loses 4 bits.
const MOST_NEPERS: f64 = 2.77;

/// Nominal cycles of a frame of a head under a hand, beside those without one
/// (`cargo test -p host-tests --test on_chip hands`).
pub(super) const HEAD_FRAME: u32 = 110;

/// Share of the sound that a hand leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Decay {
    /// After each number of ticks up to a block.
    ticks: [f32; TICKS + 1],
    /// After each number of frames up to a tick.
    frames: [f32; TICK_FRAMES + 1],
}

/// Hand on a bank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hand {
    decay: Decay,
    /// True if it is to lie on the bank from the block behind the next one on.
    is_wanted: bool,
    /// True if it lies on the block that is being made, and on the one that plays.
    lies_next: bool,
    lies: bool,
}

impl Decay {
    /// Share that a block leaves.
    pub(super) fn of_block(&self) -> f32 {
        self.ticks[TICKS]
    }

    /// Share that is left at the beginning of the tick of a frame of a block, and the shares of the
    /// tick's frames from there on.
    pub(super) fn in_tick(&self, frame: usize) -> (f32, &[f32]) {
        let of_ticks = self.ticks.get(frame / TICK_FRAMES).copied().unwrap_or(0.0);
        (of_ticks, self.frames.get(..TICK_FRAMES).unwrap_or(&[]))
    }

    /// Shares that are left from each frame of a block to its end, from a frame on to the end of
    /// its tick.
    pub(super) fn until_end(&self, frame: usize) -> impl Iterator<Item = f32> + Clone {
        let of_ticks = self.ticks.get((TICKS - 1).saturating_sub(frame / TICK_FRAMES)).copied().unwrap_or(0.0);
        self.frames.iter().rev().skip(frame % TICK_FRAMES).map(move |of_frames| of_ticks * of_frames)
    }
}

impl Hand {
    /// Hand that takes nothing.
    pub(super) const NONE: Self = Self {
        decay: Decay { ticks: [1.0; TICKS + 1], frames: [1.0; TICK_FRAMES + 1] },
        is_wanted: false,
        lies_next: false,
        lies: false,
    };

    /// True if frames have a hand of a T60: it takes at most 24 dB in a block. From 14.5 ms on at
    /// 44.1 kHz, or with 0 for a pad that cannot be choked.
    pub(super) fn can_have(t60_s: f64, rate: SampleRate) -> bool {
        t60_s == 0.0 || decay_of_t60(t60_s, rate) / rate.hz() * BLOCK_FRAMES as f64 <= MOST_NEPERS
    }

    /// Hand of a T60, not on the bank; with 0 it takes nothing.
    pub(super) fn new(t60_s: f64, rate: SampleRate) -> Self {
        let mut hand = Self::NONE;
        if t60_s > 0.0 {
            let nepers = decay_of_t60(t60_s, rate) / rate.hz();
            let after = |frames: usize| exponential::exp(-nepers * frames as f64) as f32;
            hand.decay.ticks = core::array::from_fn(|tick| after(tick * TICK_FRAMES));
            hand.decay.frames = core::array::from_fn(after);
        }
        hand
    }

    /// Lays the hand on, or lifts it: from the block behind the next one on. A hand that takes
    /// nothing never comes, so that a pad which cannot be choked keeps its bits and its cycles.
    pub(super) fn lay(&mut self, is_wanted: bool) {
        self.is_wanted = is_wanted && self.decay.of_block() < 1.0;
    }

    /// True if the hand is on its way to the bank or from it.
    pub(super) fn is_moving(&self) -> bool {
        self.is_wanted != self.lies || self.lies_next != self.lies
    }

    /// Begins a block.
    pub(super) fn begin_block(&mut self) {
        self.lies = core::mem::replace(&mut self.lies_next, self.is_wanted);
    }

    /// Decay in the block that plays; `None` without the hand.
    pub(super) fn now(&self) -> Option<&Decay> {
        self.lies.then_some(&self.decay)
    }

    /// Decay in the block that is being made; `None` without the hand.
    pub(super) fn next(&self) -> Option<&Decay> {
        self.lies_next.then_some(&self.decay)
    }
}
