//! A room's memory and state.

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
    /// Doublings from a rate to twice it, each by the number of halvings; the first is not used.
    pub(super) upsamplers: [Upsampler; RATES],
    pub(super) upsampler_states: [UpsamplerState; RATES],
    /// Number of doublings from the lowest band's rate.
    pub(super) levels: usize,
    pub(super) turn: Turn,
    /// Maker of one signal of both sides.
    pub(super) feed: Feed,
    /// Half of the input of this block, and of the block that is worked on: by turns.
    pub(super) inputs: [&'m mut [i32]; 2],
    /// Output of this block, and of the block that is worked on: by turns.
    pub(super) outputs: [&'m mut [[i32; 2]]; 2],
    /// True if the second ones are those of this block.
    pub(super) side: bool,
    /// Outputs of the lower rates: the upper half at half the rate, below it a quarter, and so on;
    /// at 1/32 from the fifth element on.
    pub(super) rates: &'m mut [[i32; 2]],
    /// Or of this block's samples of both sides.
    pub(super) dry: u32,
    /// True if this block's input, or that of the block which is worked on, may be other than
    /// zeros.
    pub(super) heard: bool,
    pub(super) worked: bool,
    /// Progress of the work, and the ends of each tick's part of it.
    pub(super) work: Work,
    pub(super) part_ends: [u8; TICKS],
    /// Number of frames of this block that have passed.
    pub(super) passed: usize,
    /// True if nothing sounds and no input has come since.
    pub(super) silent: bool,
    /// Number of blocks by which the turn is late.
    pub(super) silent_blocks: u32,
    pub(super) scratch: Option<&'m mut Scratch<T>>,
    /// Pairs of samples of all delay lines.
    pub(super) lines: &'m mut [[T; 2]],
}

/// Scratch memory of a tick; here, so that it is neither on the stack nor cleared each time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scratch<T: Sample> {
    pub(super) high: [i32; BLOCK_FRAMES],
    pub(super) sound: Sound<T>,
    /// Angles of the block that is worked on.
    pub(super) turns: Turns<T>,
}

impl<T: Sample> Scratch<T> {
    pub(super) const EMPTY: Self = Self {
        high: [0; BLOCK_FRAMES],
        sound: Sound { input: [[T::ZERO; 2]; BLOCK_FRAMES], output: [[T::ZERO; 2]; BLOCK_FRAMES] },
        turns: Turns::NONE,
    };
}

/// A band: the split at its lower edge, and its network.
#[derive(Clone, Copy, Debug)]
pub(super) struct Band {
    pub(super) config: NetworkConfig,
    pub(super) state: NetworkState,
    pub(super) split: Split,
    pub(super) split_state: SplitState,
    pub(super) division: u8,
    /// True if the next lower band runs at a lower rate.
    pub(super) thins: bool,
    /// Number of pairs of delay, all lines together, and the place at which they begin.
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

    /// True if nothing sounds: until input comes, nothing goes out.
    pub fn is_silent(&self) -> bool {
        self.silent
    }

    /// Number of bands; 0 without a room.
    pub fn band_count(&self) -> usize {
        self.bands.len()
    }

    /// Ends all sound at once.
    pub fn rest(&mut self) {
        self.lines.fill([T::ZERO; 2]);
        self.clear();
    }

    /// Goes back to silence. A network that sleeps has cleared its lines.
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

/// Progress of the work on a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    /// Next item: for each band from the highest down its split and its answer, and then the
    /// doublings.
    pub(super) next: usize,
    /// Bits of the largest size in the last split's output.
    pub(super) bits: i32,
    /// Division of the rate to which the input has been thinned.
    pub(super) division: usize,
    /// True for the rates at which there is an answer.
    pub(super) written: [bool; RATES],
    /// True if all bands were asleep.
    pub(super) asleep: bool,
    pub(super) begun: bool,
}

impl Work {
    pub(super) const NONE: Self =
        Self { next: 0, bits: 0, division: 1, written: [false; RATES], asleep: true, begun: false };
}

/// The buffer of this block, and the one of the block that is worked on.
pub(super) fn turned<'b, B>([a, b]: &'b mut [&mut [B]; 2], side: bool) -> [&'b mut [B]; 2] {
    if side { [b, a] } else { [a, b] }
}
