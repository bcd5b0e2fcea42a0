//! A room: its memory and its state.

use super::dimensions::{BLOCK_FRAMES, RATES, TICKS};
use super::feed::Feed;
use super::lines::Sound;
use super::network::{NetworkConfig, NetworkState, Turns};
use super::sample::Sample;
use super::split::{Split, SplitState};
use super::turn::Turn;
use super::upsample::{Upsampler, UpsamplerState};

/// A room whose delay lines hold samples of `i16`, as on a board, or of `i32`.
#[derive(Debug)]
pub struct Room<'m, T: Sample> {
    /// The table's bands, from the lowest up.
    pub(super) bands: &'m mut [Band],
    /// From a rate to twice it, each by the number of halvings; the first is not used.
    pub(super) upsamplers: [Upsampler; RATES],
    pub(super) upsampler_states: [UpsamplerState; RATES],
    /// Doublings from the lowest band's rate.
    pub(super) levels: usize,
    pub(super) turn: Turn,
    /// Makes one signal of both sides.
    pub(super) feed: Feed,
    /// Half of what comes in during this block, and of what is worked on: by turns.
    pub(super) inputs: [&'m mut [i32]; 2],
    /// What goes out in this block, and what is worked on: by turns.
    pub(super) outputs: [&'m mut [[i32; 2]]; 2],
    /// Which of both comes in and goes out.
    pub(super) side: bool,
    /// Outputs of the lower rates: the upper half at half the rate, below it a quarter, and so on; at 1/32 from the fifth element on.
    pub(super) rates: &'m mut [[i32; 2]],
    /// Or of what this block's sides have been.
    pub(super) dry: u32,
    /// True if this block's input, or that of the block which is worked on, may be other than zeros.
    pub(super) heard: bool,
    pub(super) worked: bool,
    /// How far the work is, and where each tick's part of it ends.
    pub(super) work: Work,
    pub(super) part_ends: [u8; TICKS],
    /// Frames of this block that have passed.
    pub(super) passed: usize,
    /// Whether nothing sounds and nothing has come in since.
    pub(super) silent: bool,
    /// Blocks by which the turn is late.
    pub(super) silent_blocks: u32,
    pub(super) scratch: Option<&'m mut Scratch<T>>,
    /// Pairs of samples of all delay lines.
    pub(super) lines: &'m mut [[T; 2]],
}

/// What a tick needs for itself; here, so that it is neither on the stack nor cleared each time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scratch<T: Sample> {
    pub(super) high: [i32; BLOCK_FRAMES],
    pub(super) sound: Sound<T>,
    /// The angles of the block that is worked on.
    pub(super) turns: Turns<T>,
}

impl<T: Sample> Scratch<T> {
    pub(super) const EMPTY: Self = Self {
        high: [0; BLOCK_FRAMES],
        sound: Sound { input: [[T::ZERO; 2]; BLOCK_FRAMES], output: [[T::ZERO; 2]; BLOCK_FRAMES] },
        turns: Turns::NONE,
    };
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Band {
    pub(super) config: NetworkConfig,
    pub(super) state: NetworkState,
    pub(super) split: Split,
    pub(super) split_state: SplitState,
    pub(super) division: u8,
    /// Whether the next lower band runs at a lower rate.
    pub(super) thins: bool,
    /// Pairs of delay, all lines together, and where they begin.
    pub(super) pairs: u16,
    pub(super) start: u16,
}

impl Band {
    pub(super) const NONE: Self = Self {
        config: NetworkConfig::NONE,
        state: NetworkState::SILENT,
        split: Split::NONE,
        split_state: SplitState::SILENT,
        division: 1,
        thins: false,
        pairs: 0,
        start: 0,
    };
}

impl<T: Sample> Room<'_, T> {
    /// No room: adds nothing, at no cost.
    pub const fn none() -> Self {
        Self {
            bands: &mut [],
            upsamplers: [Upsampler::NONE; RATES],
            upsampler_states: [UpsamplerState::SILENT; RATES],
            levels: 0,
            turn: Turn::NONE,
            feed: Feed::SILENT,
            inputs: [&mut [], &mut []],
            outputs: [&mut [], &mut []],
            side: false,
            rates: &mut [],
            dry: 0,
            heard: false,
            worked: false,
            work: Work::NONE,
            part_ends: [0; TICKS],
            passed: 0,
            silent: true,
            silent_blocks: 0,
            scratch: None,
            lines: &mut [],
        }
    }

    /// Whether nothing sounds: until something comes in, nothing goes out.
    pub fn is_silent(&self) -> bool {
        self.silent
    }

    /// Number of bands; 0 where there is no room.
    pub fn band_count(&self) -> usize {
        self.bands.len()
    }

    /// Back to silence, where a network that sleeps has cleared its lines.
    pub(super) fn clear(&mut self) {
        for band in &mut *self.bands {
            (band.state, band.split_state) = (band.config.silent(), SplitState::SILENT);
        }
        self.upsampler_states = [UpsamplerState::SILENT; RATES];
        self.inputs.iter_mut().for_each(|input| input.fill(0));
        self.outputs.iter_mut().for_each(|output| output.fill([0; 2]));
        (self.feed, self.dry, self.heard, self.worked) = (Feed::SILENT, 0, false, false);
        self.work = Work::NONE;
        self.silent = true;
    }
}

/// How far the work on a block is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    /// What comes next: for each band from the highest down its split and its answer, and then the doublings.
    pub(super) next: usize,
    /// Bits of the largest size in what was parted last.
    pub(super) bits: i32,
    /// What the input has been thinned to.
    pub(super) division: usize,
    /// The rates at which there is an answer.
    pub(super) written: [bool; RATES],
    /// Whether all bands were asleep.
    pub(super) asleep: bool,
    pub(super) begun: bool,
}

impl Work {
    pub(super) const NONE: Self =
        Self { next: 0, bits: 0, division: 1, written: [false; RATES], asleep: true, begun: false };
}

/// What comes in or goes out, and what is worked on.
pub(super) fn turned<'b, B>([a, b]: &'b mut [&mut [B]; 2], side: bool) -> [&'b mut [B]; 2] {
    if side { [b, a] } else { [a, b] }
}
