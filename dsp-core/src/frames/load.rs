//! From a table to a bank in frames.

use super::bank::FrameBank;
use super::head::Head;
use super::mixer::FrameMixer;
use super::mode::{FrameMode, Line};
use super::numbers::numbers;
use super::pole::{Complex64, FramePole, MAX_DAMPING, MAX_DAMPING_OF_HEAD, times};
use super::{BLOCK_FRAMES, LINES};
use crate::SampleRate;
use crate::memory::{Lender, OutOfMemory, Region};
use crate::resonator::{BankError, BankTable, check_bank, gain_at};

/// Size of a bank in frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameBankSize {
    /// Number of modes below Nyquist that outlast the head.
    pub modes: usize,
}

/// Modes of a table that are rendered: index and pole.
fn rendered<'t>(table: &'t BankTable<'_>, rate: SampleRate) -> impl Iterator<Item = (usize, FramePole)> + use<'t> {
    let below_nyquist = move |hz: f64| hz < rate.hz() / 2.0;
    table.modes.iter().enumerate().filter_map(move |(index, record)| {
        let frequency_hz = f64::from(record.frequency_hz.get());
        let pole = || FramePole::new(frequency_hz, f64::from(record.decay_per_s.get()), rate);
        below_nyquist(frequency_hz).then(|| (index, pole()))
    })
}

/// True if frames hold a mode; else the head alone does.
fn outlasts_head(pole: &FramePole) -> bool {
    pole.damping <= MAX_DAMPING
}

impl<'m> FrameBank<'m> {
    /// Size of the bank of a table at a sample rate.
    ///
    /// # Errors
    /// A [`BankError`] for a table that no bank can hold.
    pub fn size(table: &BankTable<'_>, rate: SampleRate) -> Result<FrameBankSize, BankError> {
        check_bank(table, rate)?;
        Ok(FrameBankSize { modes: rendered(table, rate).filter(|(_, pole)| outlasts_head(pole)).count() })
    }

    /// Takes the memory of a bank, at rest and without modes: 84 bytes a mode, and 5.2 KB.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take(lender: &mut impl Lender<'m>, size: FrameBankSize) -> Result<Self, OutOfMemory> {
        Ok(Self {
            modes: lender.take(Region::Fast, size.modes, || FrameMode::SILENT)?,
            lines: lender.take(Region::Fast, LINES, Line::default)?,
            head: Head::take(lender)?,
            ..Self::empty()
        })
    }

    /// Derives the bank of a table in the memory that was taken for its [`size`](Self::size), with
    /// the gains from its bus to both sides. The spectra of the mixer serve as scratch.
    ///
    /// # Errors
    /// A [`BankError`]; the bank is then not to be played.
    pub fn load(
        &mut self,
        table: &BankTable<'_>,
        rate: SampleRate,
        gains: [f32; 2],
        mixer: &mut FrameMixer<'_>,
    ) -> Result<(), BankError> {
        check_bank(table, rate)?;
        self.gains = gains;
        self.place(table, rate);
        // Modes' states are their amplitudes for a force of one bus step at the first frame.
        for block in 0..2 {
            mixer.make_block(self);
            for (tap, frame) in self.head.floats().skip(block * BLOCK_FRAMES).zip(0..BLOCK_FRAMES) {
                *tap = mixer.made(frame).to_bits() as i32;
            }
        }
        self.modes.iter_mut().for_each(|mode| mode.state = [0.0; 2]);
        self.lines.iter_mut().for_each(|line| line.ringing = 0);
        let scale = table.weight / rate.hz();
        let mut taken = 0.0;
        for (index, pole) in rendered(table, rate) {
            let gain = complex_gain(table, index, scale);
            taken += if table.is_balanced { times(gain, pole.sum())[0] } else { gain[0] / 2.0 };
            if pole.damping > MAX_DAMPING_OF_HEAD {
                self.add_to_head(gain, pole.power(1));
            }
        }
        if let Some(tap) = self.head.floats().next() {
            *tap = (f32::from_bits(*tap as u32) - taken as f32).to_bits() as i32;
        }
        self.head.fix();
        Ok(())
    }

    /// Puts the modes in the order of their lines, and derives them.
    fn place(&mut self, table: &BankTable<'_>, rate: SampleRate) {
        let held = || rendered(table, rate).filter(|(_, pole)| outlasts_head(pole));
        self.lines.fill(Line::default());
        for (_, pole) in held() {
            if let Some(line) = self.lines.get_mut(pole.line) {
                line.count += 1; // banks count in 16 bits
            }
        }
        let scale = table.weight / rate.hz();
        for (index, pole) in held() {
            let (before, from) = self.lines.split_at_checked(pole.line).unwrap_or((&[], &[]));
            let first: usize = before.iter().map(|line| usize::from(line.count)).sum();
            let placed = from.first().map_or(0, |line| usize::from(line.ringing));
            let Some(modes) = self.modes.get_mut(first..=first + placed) else { continue };
            if let Some(mode) = modes.last_mut() {
                *mode = derived(&pole, complex_gain(table, index, scale));
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

    /// Adds a fast mode to the head by recursion in `f32`, its factor to 48 bits.
    fn add_to_head(&mut self, gain: Complex64, factor: Complex64) {
        let mut state = gain.map(|x| x as f32);
        let main = factor.map(|x| x as f32);
        let rest = [factor[0] - f64::from(main[0]), factor[1] - f64::from(main[1])].map(|x| x as f32);
        for tap in self.head.floats() {
            *tap = (f32::from_bits(*tap as u32) + state[0]).to_bits() as i32;
            let product = |[x, y]: [f32; 2]| [state[0] * x - state[1] * y, state[0] * y + state[1] * x];
            let (of_main, of_rest) = (product(main), product(rest));
            state = [of_main[0] + of_rest[0], of_main[1] + of_rest[1]];
        }
    }
}

/// Gain g of `h[n] = Re(g z^n)`, in bus steps a bus step of force.
fn complex_gain(table: &BankTable<'_>, index: usize, scale: f64) -> Complex64 {
    let (sine, cosine) = gain_at(table.gains, table.positions, index, 0.0);
    [f64::from(cosine) * scale, -f64::from(sine) * scale]
}

/// Mode of a pole and a gain. Its state is what a force of one bus step at the first frame of a
/// block makes, if the lines make its head, else 0.
fn derived(pole: &FramePole, gain: Complex64) -> FrameMode {
    let [half, whole, twice] = pole.powers();
    let by_lines = pole.damping <= MAX_DAMPING_OF_HEAD;
    let mut mode = FrameMode {
        state: if by_lines { times(gain, half).map(|x| x as f32) } else { [0.0; 2] },
        numbers: numbers([pole.distance as f32, pole.damping as f32]),
        gain: times(gain, twice).map(|x| x as f32),
        ..FrameMode::SILENT
    };
    mode.set_step(whole);
    mode
}

/// Square of a complex number's size.
fn size([x, y]: [f32; 2]) -> f32 {
    x * x + y * y
}
