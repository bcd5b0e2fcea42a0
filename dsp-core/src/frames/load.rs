//! From a table to a bank in frames.

use super::bank::{FrameBank, Positions};
use super::hand::Hand;
use super::head::{Head, fix};
use super::mixer::FrameMixer;
use super::mode::{FrameMode, Line};
use super::numbers::numbers;
use super::pole::{Complex64, FramePole, MAX_DAMPING, MAX_DAMPING_OF_HEAD, times};
use super::{BLOCK_FRAMES, LINES, POINTS};
use crate::SampleRate;
use crate::memory::{Memory, OutOfMemory, Region};
use crate::resonator::{BankError, BankTable, below_nyquist, check_bank, gain_at};

/// Size of a bank in frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameBankSize {
    /// Number of modes below Nyquist that outlast the head.
    pub modes: usize,
    /// Number of positions of the table.
    pub positions: usize,
    /// Frames of the longest contact of the pad's strikers at velocity 1.
    pub contact_frames: u32,
    /// True if the pad can be choked.
    pub has_hand: bool,
}

impl FrameBankSize {
    /// Nominal cycles a frame of a lone pad in its dearest tick: that of a strike, or under a force
    /// that never rests if a sensor's signal itself is the force (`is_direct`).
    ///
    /// The dearest tick depends on the contact: each of its frames is multiplied by a block of the
    /// head (`cargo test -p host-tests --test on_chip frames::long_contacts -- --nocapture`).
    /// Strikes below velocity 1 may last longer, which is not counted.
    pub fn cycles(&self, is_direct: bool) -> u32 {
        let modes = self.modes as f32;
        let direct = DIRECT_FRAME + DIRECT_MODE * modes;
        let frames = self.contact_frames as f32;
        let contact = CONTACT_FRAME * frames + LONG_CONTACT_FRAME * (frames - LONG_CONTACT).max(0.0);
        let struck = STRUCK_FRAME + (STRUCK_MODE - CONTACT_MODE * frames).max(0.0) * modes + contact;
        let struck = struck.min(direct);
        let hand = if self.has_hand { HAND_FRAME + HAND_MODE * modes } else { 0.0 };
        (hand + if is_direct { direct } else { struck }) as u32
    }
}

/// Nominal cycles a frame under a direct force, and those of each mode
/// (`cargo test -p host-tests --test on_chip frames -- --nocapture`).
const DRIVEN_FRAME: f32 = 1318.0;
const DRIVEN_MODE: f32 = 0.584;
/// Nominal cycles a frame of a lone pad, to the output: in the dearest tick of a strike, those of
/// each mode, of each frame of the contact and more beyond so many, and what each mode saves of
/// these: the tail is then there earlier.
const STRUCK_FRAME: f32 = 595.0;
const STRUCK_MODE: f32 = 0.75;
const CONTACT_FRAME: f32 = 2.45;
const LONG_CONTACT: f32 = 132.0;
const LONG_CONTACT_FRAME: f32 = 0.45;
const CONTACT_MODE: f32 = 0.000_2;
/// Nominal cycles a frame under a force that never rests, and those of each mode.
const DIRECT_FRAME: f32 = 1510.0;
const DIRECT_MODE: f32 = 0.739;
/// Cycles that a hand adds to both.
const HAND_FRAME: f32 = 135.0;
const HAND_MODE: f32 = 0.06;
/// Nominal cycles of a mode under a force in the fixed-point bank
/// (`cargo bench -p host-tests --bench run_time_vs_error`).
const DRIVEN_MODE_IN_BANK: f32 = 7.75;

/// Fewest modes of a bank that takes fewer cycles in frames than in the fixed-point bank, both
/// under a force that never rests: 184. So many let the transforms of frames pay in any case.
pub const FEWEST_MODES: usize = (DRIVEN_FRAME / (DRIVEN_MODE_IN_BANK - DRIVEN_MODE)) as usize + 1;

/// Fewest modes of one of several banks that together have [`FEWEST_MODES`], and share the
/// transforms: each takes fewer cycles in frames while it rings, and in the dearest tick of a
/// strike (docs/run_time_vs_error.md).
pub const FEWEST_MODES_OF_SEVERAL: usize = 64;

/// Modes of a checked table below Nyquist: index and pole.
fn rendered<'t>(table: &'t BankTable<'_>, rate: SampleRate) -> impl Iterator<Item = (usize, FramePole)> + use<'t> {
    below_nyquist(table, rate).filter_map(Result::ok).map(move |(index, record)| {
        let (frequency_hz, decay_per_s) = (record.frequency_hz.get(), record.decay_per_s.get());
        (index, FramePole::new(frequency_hz.into(), decay_per_s.into(), rate))
    })
}

/// True if frames hold a mode; else the head alone does.
fn outlasts_head(pole: &FramePole) -> bool {
    pole.damping <= MAX_DAMPING
}

impl<'m> FrameBank<'m> {
    /// Size of the bank of a table at a sample rate, for contacts of no length.
    ///
    /// # Errors
    /// A [`BankError`] for a table that no bank can hold.
    pub fn size(table: &BankTable<'_>, rate: SampleRate) -> Result<FrameBankSize, BankError> {
        check_bank(table, rate)?;
        let modes = rendered(table, rate).filter(|(_, pole)| outlasts_head(pole)).count();
        let has_hand = table.choke_t60_s > 0.0;
        Ok(FrameBankSize { modes, positions: table.positions, contact_frames: 0, has_hand })
    }

    /// Number of modes of a table below Nyquist.
    pub fn mode_count_of(table: &BankTable<'_>, rate: SampleRate) -> usize {
        rendered(table, rate).count()
    }

    /// True if frames can choke a pad as its table says: by at most 24 dB in a block, T60 14.5 ms
    /// at 44.1 kHz.
    pub fn can_choke(table: &BankTable<'_>, rate: SampleRate) -> bool {
        Hand::can_have(table.choke_t60_s, rate)
    }

    /// Takes the memory of a bank, at rest and without modes: 84 bytes a mode, and 7.3 KB.
    ///
    /// A bank of several positions takes 2 bytes a mode, 2 KB a position and 2.1 KB more.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(memory: &mut Memory<'m>, size: FrameBankSize) -> Result<Self, OutOfMemory> {
        let mut bank = Self {
            modes: memory.take(Region::Fast, size.modes, FrameMode::default)?,
            lines: memory.take(Region::Fast, LINES, Line::default)?,
            heads: [Head::take(memory, size.positions <= 1)?, Head::empty()],
            ..Self::empty()
        };
        if size.positions > 1 {
            bank.heads[1] = Head::take(memory, false)?;
            bank.positions = Positions {
                count: size.positions,
                heads: memory.take(Region::Bulk, size.positions * POINTS, || 0)?,
                indices: memory.take(Region::Fast, size.modes, || 0)?,
                ..bank.positions
            };
        }
        Ok(bank)
    }

    /// Derives the bank of a table in the memory that was taken for its [`size`](Self::size), with
    /// the gains from its bus to both sides. The spectra of the mixer serve as scratch.
    ///
    /// # Errors
    /// A [`BankError`]; the bank is then not to be played.
    pub fn load(
        &mut self,
        table: &BankTable<'m>,
        rate: SampleRate,
        gains: [f32; 2],
        mixer: &mut FrameMixer<'_>,
    ) -> Result<(), BankError> {
        check_bank(table, rate)?;
        self.gains = gains;
        self.hand = Hand::new(table.choke_t60_s, rate);
        self.mode_count = rendered(table, rate).count() as u16; // banks count in 16 bits
        self.place_modes(table, rate);
        for (index, mode) in self.positions.indices.iter_mut().zip(&*self.modes) {
            *index = mode.state[0].to_bits() as u16; // 12 bits and a flag
        }
        for index in 0..table.positions {
            let position = index as f32 / (table.positions - 1).max(1) as f32;
            // With several positions the first slot only holds each head until it is copied.
            self.make_head(table, rate, position, mixer);
            let taps = self.positions.heads.get_mut(index * POINTS..).unwrap_or(&mut []);
            taps.iter_mut().zip(self.heads[0].by_lag()).for_each(|(to, from)| *to = *from);
        }
        self.modes.iter_mut().for_each(|mode| mode.state = [0.0; 2]);
        self.lines.iter_mut().for_each(|line| line.ringing = 0);
        if table.positions == 1 {
            self.heads[0].fix();
            mixer.make_response(&mut self.heads[0]);
            return Ok(());
        }
        self.positions.indices.iter_mut().for_each(|index| *index &= !BY_RECURSION);
        self.positions.exponent = fix(self.positions.heads);
        (self.positions.gains, self.positions.scale) = (table.gains, (table.weight / rate.hz()) as f32);
        self.set_position(0, 0.0);
        self.set_position(1, 0.0);
        self.derive(0, 0..self.modes.len());
        Ok(())
    }

    /// Puts the modes in the order of their lines, and derives them but for their gains. Until they
    /// have some, `gain` holds z^(N/2), and the bits of `state[0]` the index in the table, with
    /// [`BY_RECURSION`].
    fn place_modes(&mut self, table: &BankTable<'_>, rate: SampleRate) {
        let held = || rendered(table, rate).filter(|(_, pole)| outlasts_head(pole));
        self.lines.fill(Line::default());
        for (_, pole) in held() {
            if let Some(line) = self.lines.get_mut(pole.line) {
                line.count += 1; // banks count in 16 bits
            }
        }
        for (index, pole) in held() {
            let (before, from) = self.lines.split_at_checked(pole.line).unwrap_or((&[], &[]));
            let first: usize = before.iter().map(|line| usize::from(line.count)).sum();
            let placed = from.first().map_or(0, |line| usize::from(line.ringing));
            let Some(modes) = self.modes.get_mut(first..=first + placed) else { continue };
            if let Some(mode) = modes.last_mut() {
                *mode = derived(&pole, index);
            }
            // By insertion, the slowest first.
            for at in (1..modes.len()).rev() {
                match modes.get_mut(at - 1..=at) {
                    Some([before, mode]) if size(mode.step) > size(before.step) => core::mem::swap(before, mode),
                    _ => break,
                }
            }
            if let Some(line) = self.lines.get_mut(pole.line) {
                line.ringing += 1;
            }
        }
    }

    /// Makes the first head hold the response at a position, as floats. Modes whose table has one
    /// position get their gains.
    fn make_head(&mut self, table: &BankTable<'_>, rate: SampleRate, position: f32, mixer: &mut FrameMixer<'_>) {
        let scale = table.weight / rate.hz();
        let mut indices = self.positions.indices.iter();
        for mode in &mut *self.modes {
            let index = indices.next().copied().unwrap_or(mode.state[0].to_bits() as u16);
            let gain = complex_gain(table, usize::from(index & !BY_RECURSION), position, scale).map(|x| x as f32);
            let half = mode.gain;
            // The state after a force of one bus step at the first frame of a block.
            mode.state = if index & BY_RECURSION == 0 { product(gain, half) } else { [0.0; 2] };
            if table.positions == 1 {
                let whole = product(half, half);
                mode.gain = product(gain, product(whole, whole));
            }
        }
        for block in 0..2 {
            mixer.make_block(self);
            for (tap, frame) in self.heads[0].by_lag().skip(block * BLOCK_FRAMES).zip(0..BLOCK_FRAMES) {
                *tap = mixer.made(frame).to_bits() as i32;
            }
        }
        let mut taken = 0.0;
        for (index, pole) in rendered(table, rate) {
            let gain = complex_gain(table, index, position, scale);
            taken += if table.is_balanced { times(gain, pole.sum())[0] } else { gain[0] / 2.0 };
            if is_by_recursion(&pole) {
                self.heads[0].add(gain, pole.power(1));
            }
        }
        if let Some(tap) = self.heads[0].by_lag().next() {
            *tap = (f32::from_bits(*tap as u32) - taken as f32).to_bits() as i32;
        }
    }
}

impl Head<'_> {
    /// Adds a fast mode to taps that are floats by recursion in `f32`, its factor to 48 bits.
    fn add(&mut self, gain: Complex64, factor: Complex64) {
        let mut state = gain.map(|x| x as f32);
        let main = factor.map(|x| x as f32);
        let rest = [factor[0] - f64::from(main[0]), factor[1] - f64::from(main[1])].map(|x| x as f32);
        for tap in self.by_lag() {
            *tap = (f32::from_bits(*tap as u32) + state[0]).to_bits() as i32;
            let (of_main, of_rest) = (product(state, main), product(state, rest));
            state = [of_main[0] + of_rest[0], of_main[1] + of_rest[1]];
        }
    }
}

/// Flag of a mode whose head a recursion makes.
const BY_RECURSION: u16 = 1 << 15;

/// True if a recursion makes the head of a mode, because it decays too fast for the lines.
fn is_by_recursion(pole: &FramePole) -> bool {
    pole.damping > MAX_DAMPING_OF_HEAD
}

/// Gain g of `h[n] = Re(g z^n)` at a position, in bus steps a bus step of force.
fn complex_gain(table: &BankTable<'_>, index: usize, position: f32, scale: f64) -> Complex64 {
    let (sine, cosine) = gain_at(table.gains, table.positions, index, position);
    [f64::from(cosine) * scale, -f64::from(sine) * scale]
}

/// Mode of a pole with its index, before it has gains.
fn derived(pole: &FramePole, index: usize) -> FrameMode {
    let [half, whole] = pole.powers();
    let flag = if is_by_recursion(pole) { BY_RECURSION } else { 0 };
    let mut mode = FrameMode {
        state: [f32::from_bits(u32::from(index as u16 | flag)), 0.0],
        numbers: numbers([pole.distance as f32, pole.damping as f32]),
        gain: half.map(|x| x as f32),
        ..FrameMode::default()
    };
    mode.set_step(whole);
    mode
}

/// Product of two complex numbers.
fn product(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// Square of a complex number's size.
fn size([x, y]: [f32; 2]) -> f32 {
    x * x + y * y
}
