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
//! **Measured** at 48 kHz (`cargo test -p host-tests --test room -- --nocapture`, `... --test on_chip room ...`); more in `docs/room.md`:
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
use crate::resonator::TICK_FRAMES;
use crate::table::layout::RoomBandRecord;
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

/// A room with `SAMPLES` samples of delay, of type `i16` (what a board has room for) or `i32`.
#[derive(Debug)]
pub struct Room<T: Sample, const SAMPLES: usize> {
    /// The first `count` are the table's, from the lowest up.
    bands: [Band; MAX_BANDS],
    count: usize,
    /// From a rate to twice it, each by the number of halvings; the first is not used.
    upsamplers: [Upsampler; RATES],
    upsampler_states: [UpsamplerState; RATES],
    /// Doublings from the lowest band's rate.
    levels: usize,
    turn: Turn,
    /// Makes one signal of both sides.
    feed: Feed,
    /// Half of what comes in during this block, and of what is worked on: by turns.
    inputs: [[i32; BLOCK_FRAMES]; 2],
    /// What goes out in this block, and what is worked on: by turns.
    outputs: [[[i32; 2]; BLOCK_FRAMES]; 2],
    /// Which of both comes in and goes out.
    side: bool,
    /// Outputs of the lower rates: the upper half at half the rate, below it a quarter, and so on; at 1/32 from the fifth element on.
    rates: [[i32; 2]; BLOCK_FRAMES],
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
    scratch: Scratch<T>,
    memory: Memory<T, SAMPLES>,
}

/// What a tick needs for itself; here, so that it is neither on the stack nor cleared each time.
#[derive(Clone, Copy, Debug)]
struct Scratch<T: Sample> {
    high: [i32; BLOCK_FRAMES],
    sound: Sound<T>,
    /// The angles of the block that is worked on.
    turns: Turns<T>,
}

/// All delay lines; pairs of 16 bits are words.
#[derive(Debug)]
#[repr(C, align(4))]
struct Memory<T, const SAMPLES: usize>([T; SAMPLES]);

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

impl<T: Sample, const SAMPLES: usize> Default for Room<T, SAMPLES> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Sample, const SAMPLES: usize> Room<T, SAMPLES> {
    /// No room. `const`, so that it can lie in a `static` and never on a stack.
    pub const fn new() -> Self {
        Self {
            bands: [Band::NONE; MAX_BANDS],
            count: 0,
            upsamplers: [Upsampler::NONE; RATES],
            upsampler_states: [UpsamplerState::SILENT; RATES],
            levels: 0,
            turn: Turn::NONE,
            feed: Feed::SILENT,
            inputs: [[0; BLOCK_FRAMES]; 2],
            outputs: [[[0; 2]; BLOCK_FRAMES]; 2],
            side: false,
            rates: [[0; 2]; BLOCK_FRAMES],
            dry: 0,
            heard: false,
            worked: false,
            work: Work::NONE,
            part_ends: [0; TICKS],
            passed: 0,
            silent: true,
            silent_blocks: 0,
            scratch: Scratch {
                high: [0; BLOCK_FRAMES],
                sound: Sound { input: [[T::ZERO; 2]; BLOCK_FRAMES], output: [[T::ZERO; 2]; BLOCK_FRAMES] },
                turns: Turns::NONE,
            },
            memory: Memory([T::ZERO; SAMPLES]),
        }
    }

    /// Derives the room from its bands, from the lowest up, and begins in silence. Without bands there is no room: nothing is added, at no cost.
    ///
    /// # Errors
    /// A [`RoomError`]; there is then no room.
    pub fn load(&mut self, bands: &[RoomBandRecord], rate: SampleRate) -> Result<(), RoomError> {
        (self.count, self.passed, self.silent_blocks) = (0, 0, 0);
        self.clear();
        self.memory.0.fill(T::ZERO);
        let plans = plan::plan(bands, rate, SAMPLES)?;
        let (mut below, mut start) = (1, 0);
        for (band, plan) in self.bands.iter_mut().zip(&plans) {
            *band = Band {
                state: NetworkConfig::new(plan).silent(),
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
        self.count = bands.len();
        Ok(())
    }

    /// Whether nothing sounds: until something comes in, nothing goes out.
    pub fn is_silent(&self) -> bool {
        self.silent
    }

    /// Number of bands; 0 where there is no room.
    pub fn band_count(&self) -> usize {
        self.count
    }

    /// Takes a run of the dry stereo sum (Q4.27) in and adds the room's answer to it.
    pub fn render(&mut self, out: &mut [[i32; 2]]) {
        if self.count == 0 {
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
        for band in &mut self.bands {
            (band.state, band.split_state) = (band.config.silent(), SplitState::SILENT);
        }
        self.upsampler_states = [UpsamplerState::SILENT; RATES];
        (self.inputs, self.outputs) = ([[0; BLOCK_FRAMES]; 2], [[[0; 2]; BLOCK_FRAMES]; 2]);
        (self.feed, self.dry, self.heard, self.worked) = (Feed::SILENT, 0, false, false);
        self.work = Work::NONE;
        self.silent = true;
    }
}

/// What comes in or goes out, and what is worked on.
fn turned<B>([a, b]: &mut [B; 2], side: bool) -> [&mut B; 2] {
    if side { [b, a] } else { [a, b] }
}
