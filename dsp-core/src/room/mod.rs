//! The room: `y + y ⊗ IR_e` (diffimpact §3.4), where `IR_e` is noise that decays exponentially, band by band.
//!
//! ```text
//!  left, right ─► feed ─► split ─► split ─► ... ─► lowest band     each at the lowest rate that its band allows
//!                        │ high    │ high          │
//!                        ▼         ▼               ▼
//!                     network   network         network              four lines of pairs each
//!                        │ L R     │ L R           │ L R
//!  left, right ◄──(+)────┴─(+)◄─2x─┴──── ... ◄─2x──┘
//! ```
//!
//! **The law.** A unit impulse is answered, on each side and in each band from its `from_hz` to the next one's, by noise whose power decays as
//! `g² e^{-2 d t}`: the answer's energy is `g²/(2 d)` of what the band was given, at every sample rate. (Diffimpact's gain is per sample: theirs is ours over √fs,
//! over the rms of their noise.) T60 = ln(1000)/d. Sides are uncorrelated. What a band is given is
//! `(L² + R²)/2` of its energy, which no constant-power pan changes: see `feed.rs`.
//!
//! **The delay.** The wet sound begins two blocks of 128 frames and a network's second longest line after
//! the dry one: 11 ms at 48 kHz where T60 is 0.3 s, 27 ms from 3 s on. The law's begins at once.
//!
//! **The form.** One feedback delay network a band, so that a band's T60 is exact: all of its resonances decay alike. Bands are cut apart by steep splits, and
//! each runs at the rate divided by 1 to 32, with its delays in one memory. A slow rotation inside the mix keeps the resonances moving.
//!
//! **Time.** Input is gathered for a block of four ticks; its work is cut into four parts, one at each tick of the next block; the answer goes out in the block
//! after that. So the length of the caller's blocks changes nothing.
//!
//! **Measured** at 48 kHz (`cargo test -p host-tests --test stages room:: -- --nocapture`, `... --test on_chip room ...`); more in `docs/room.md`:
//!
//! | what | figure |
//! | --- | --- |
//! | against the twin in f64, T60 0.2 to 20 s; impulses, noise, tones that outlast the room | 32-bit lines 95 dB and more; 16-bit lines 49.8 dB and more |
//! | T60 within 5 %, of bands with 300 and more independent samples (band width times T60), neighbours within a factor of 2 | 23 of 23 (4 bands), 17 of 17 (8) |
//! | any neighbours from 0.2 to 6 s, gains ±6 dB | 15 of 17 (4 bands), 12 of 13 (8) |
//! | energy of the same | within 1.1 dB, any neighbours 1.6 dB |
//! | peaks a second, 80 to 100 ms after an impulse | 7 400 and more |
//! | spectral crest of a late second, T60 6 s; noise has 10.4 dB | 12.1 dB with 48 KB of lines, 14.8 dB with 16 KB |
//! | nominal cycles a frame, mean, noise | 281 with 4 bands (dearest tick 414), 356 with 8 (528) |
//! | RAM with 48 KB of lines | 57 664 bytes |

mod crossover;
mod elliptic;
mod error;
mod feed;
mod kernel;
mod lean;
mod level;
mod network;
mod plan;
mod storage;
mod turn;
mod upsample;
mod work;

pub use error::RoomError;
pub use plan::MAX_BANDS;
pub use storage::Sample;

use crate::SampleRate;
use crate::memory::{Lender, OutOfMemory, Region};
use crate::table::layout::RoomBandRecord;
use crate::time::TICK_FRAMES;
use crossover::{Split, SplitState};
use feed::Feed;
use network::{NetworkConfig, NetworkState, Sound, Turns};
use turn::Turn;
use upsample::{Upsampler, UpsamplerState};
use work::Work;

/// Frames that are worked on together, a part of the work at each of its ticks: a quarter of the beginnings and ends.
const BLOCK_FRAMES: usize = TICKS * TICK_FRAMES;
const TICKS: usize = 4;
/// Rates: 1, 1/2 ... 1/32.
const RATES: usize = plan::SLOWEST.ilog2() as usize + 1;

/// Size of a [`Room`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoomSize {
    /// Number of bands.
    pub bands: usize,
    /// Pairs of samples in all delay lines.
    pub pairs: usize,
}

/// A room whose delay lines hold samples of `i16`, as on a board, or of `i32`.
#[derive(Debug)]
pub struct Room<'m, T: Sample> {
    /// The table's bands, from the lowest up.
    bands: &'m mut [Band],
    /// From a rate to twice it, each by the number of halvings; the first is not used.
    upsamplers: [Upsampler; RATES],
    upsampler_states: [UpsamplerState; RATES],
    /// Doublings from the lowest band's rate.
    levels: usize,
    turn: Turn,
    /// Makes one signal of both sides.
    feed: Feed,
    /// Half of what comes in during this block, and of what is worked on: by turns.
    inputs: [&'m mut [i32]; 2],
    /// What goes out in this block, and what is worked on: by turns.
    outputs: [&'m mut [[i32; 2]]; 2],
    /// Which of both comes in and goes out.
    side: bool,
    /// Outputs of the lower rates: the upper half at half the rate, below it a quarter, and so on; at 1/32 from the fifth element on.
    rates: &'m mut [[i32; 2]],
    /// Or of what this block's sides have been.
    dry: u32,
    /// True if this block's input, or that of the block which is worked on, may be other than zeros.
    heard: bool,
    worked: bool,
    /// How far the work is, and where each tick's part of it ends.
    work: Work,
    part_ends: [u8; TICKS],
    /// Frames of this block that have passed.
    passed: usize,
    /// Whether nothing sounds and nothing has come in since.
    silent: bool,
    /// Blocks by which the turn is late.
    silent_blocks: u32,
    scratch: Option<&'m mut Scratch<T>>,
    /// Pairs of samples of all delay lines.
    lines: &'m mut [[T; 2]],
}

/// What a tick needs for itself; here, so that it is neither on the stack nor cleared each time.
#[derive(Clone, Copy, Debug)]
struct Scratch<T: Sample> {
    high: [i32; BLOCK_FRAMES],
    sound: Sound<T>,
    /// The angles of the block that is worked on.
    turns: Turns<T>,
}

impl<T: Sample> Scratch<T> {
    const EMPTY: Self = Self {
        high: [0; BLOCK_FRAMES],
        sound: Sound { input: [[T::ZERO; 2]; BLOCK_FRAMES], output: [[T::ZERO; 2]; BLOCK_FRAMES] },
        turns: Turns::NONE,
    };
}

#[derive(Clone, Copy, Debug)]
struct Band {
    config: NetworkConfig,
    state: NetworkState,
    split: Split,
    split_state: SplitState,
    division: u8,
    /// Whether the next lower band runs at a lower rate.
    thins: bool,
    /// Pairs of delay, all lines together, and where they begin.
    pairs: u16,
    start: u16,
}

impl Band {
    const NONE: Self = Self {
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

impl<'m, T: Sample> Room<'m, T> {
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

    /// Size of the room of a table at a rate whose delays have at most `samples` samples.
    ///
    /// # Errors
    /// A [`RoomError`] for bands that make no room.
    pub fn size(bands: &[RoomBandRecord], rate: SampleRate, samples: usize) -> Result<RoomSize, RoomError> {
        let plans = plan::plan(bands, rate, samples)?;
        Ok(RoomSize { bands: bands.len(), pairs: plans.iter().flat_map(|plan| plan.delays).sum() })
    }

    /// Takes the memory of a room, which is silent until it is loaded.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(lender: &mut impl Lender<'m>, size: RoomSize) -> Result<Self, OutOfMemory> {
        let mut block = || lender.take(Region::Fast, BLOCK_FRAMES, || 0);
        let inputs = [block()?, block()?];
        let mut stereo = || lender.take(Region::Fast, BLOCK_FRAMES, || [0; 2]);
        Ok(Self {
            inputs,
            outputs: [stereo()?, stereo()?],
            rates: stereo()?,
            bands: lender.take(Region::Fast, size.bands, || Band::NONE)?,
            scratch: lender.take(Region::Fast, 1, || Scratch::EMPTY)?.first_mut(),
            lines: lender.take(Region::Fast, size.pairs, || [T::ZERO; 2])?,
            ..Self::none()
        })
    }

    /// Takes the memory of a room and of what it is made of; `None` from an account.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn place(lender: &mut impl Lender<'m>, size: RoomSize) -> Result<Option<&'m mut Self>, OutOfMemory> {
        let room = Self::take(lender, size)?;
        let Some(place) = lender.take(Region::Fast, 1, Self::none)?.first_mut() else { return Ok(None) };
        *place = room;
        Ok(Some(place))
    }

    /// Derives the room of bands, from the lowest up, in the memory that was taken for its [`size`](Self::size) with as many
    /// `samples`, and begins in silence.
    ///
    /// # Errors
    /// A [`RoomError`]; the room is then not to be played.
    pub fn load(&mut self, bands: &[RoomBandRecord], rate: SampleRate, samples: usize) -> Result<(), RoomError> {
        (self.passed, self.silent_blocks) = (0, 0);
        let plans = plan::plan(bands, rate, samples)?;
        let (mut below, mut start) = (1, 0);
        for (band, plan) in self.bands.iter_mut().zip(&plans) {
            *band = Band {
                config: NetworkConfig::new(plan),
                split: plan.split,
                division: plan.division as u8,
                thins: below > plan.division,
                pairs: plan.delays.iter().sum::<usize>() as u16,
                start,
                ..Band::NONE
            };
            below = plan.division;
            start += band.pairs;
        }
        for (halvings, upsampler) in self.upsamplers.iter_mut().enumerate() {
            *upsampler = Upsampler::new(plan::highest_end(&plans, 1 << halvings));
        }
        self.turn = Turn::new(rate);
        self.levels = self.bands.first().map_or(0, |band| band.division.trailing_zeros() as usize);
        self.part_ends = plan::part_ends(&plans, bands.len());
        self.lines.fill([T::ZERO; 2]);
        self.clear();
        Ok(())
    }

    /// Whether nothing sounds: until something comes in, nothing goes out.
    pub fn is_silent(&self) -> bool {
        self.silent
    }

    /// Number of bands; 0 where there is no room.
    pub fn band_count(&self) -> usize {
        self.bands.len()
    }

    /// Takes a run of the dry stereo sum (Q4.27) in and adds the room's answer to it.
    pub fn render(&mut self, out: &mut [[i32; 2]]) {
        if self.bands.is_empty() {
            return;
        }
        let mut out = out;
        while !out.is_empty() {
            let left = TICK_FRAMES - self.passed % TICK_FRAMES;
            let (now, later) = out.split_at_mut(left.min(out.len()));
            self.pass(now);
            out = later;
            if self.passed == BLOCK_FRAMES {
                self.begin();
            }
            if self.passed.is_multiple_of(TICK_FRAMES) {
                self.work_on();
            }
        }
    }

    /// Lets frames of silence pass while the room [is silent](Self::is_silent): what rendering them would do.
    pub fn pass_silence(&mut self, frames: usize) {
        // While the room is silent its input is zeros throughout.
        let passed = self.passed + frames;
        self.passed = passed % BLOCK_FRAMES;
        // 2^32 blocks are more than a month.
        self.silent_blocks = self.silent_blocks.wrapping_add((passed / BLOCK_FRAMES) as u32);
    }

    #[inline(never)]
    fn pass(&mut self, out: &mut [[i32; 2]]) {
        let frames = self.passed..self.passed + out.len();
        self.passed = frames.end;
        // While the room is silent, its input is zeros already, and its chains rest.
        if self.silent && out.iter().all(|sides| *sides == [0; 2]) {
            return;
        }
        let ([input, _], [wet, _]) = (turned(&mut self.inputs, self.side), turned(&mut self.outputs, self.side));
        let (Some(input), Some(wet)) = (input.get_mut(frames.clone()), wet.get(frames)) else { return };
        self.dry |= self.feed.exchange(out, wet, input);
        self.heard |= self.dry != 0;
        self.silent &= !self.heard;
    }

    /// Back to silence, where a network that sleeps has cleared its lines.
    fn clear(&mut self) {
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

/// What comes in or goes out, and what is worked on.
fn turned<'b, B>([a, b]: &'b mut [&mut [B]; 2], side: bool) -> [&'b mut [B]; 2] {
    if side { [b, a] } else { [a, b] }
}
