//! Order of a bank's modes in groups: by side and form, and within a form by the time for which a
//! typical strike keeps them audible.

use super::coefficient::{Pole, max_decay_per_s};
use super::gain::check_gains;
use super::mode::Mode;
use super::retirement::Retirement;
use super::table::{BankError, BankTable};
use crate::SampleRate;
use crate::table::layout::ModeRecord;

pub(super) fn pole_of(record: &ModeRecord, rate: SampleRate) -> Option<Pole> {
    Pole::new(f64::from(record.frequency_hz.get()), f64::from(record.decay_per_s.get()), rate)
}

/// A mode of a table that is rendered.
pub(super) struct Rendered {
    index: usize,
    pole: Pole,
}

impl Rendered {
    /// Side and form, by which modes are grouped: 0 to 7.
    pub(super) fn key(&self) -> i32 {
        i32::from(self.pole.mirrored) << 2 | self.pole.form as i32
    }
}

/// Modes of a table below Nyquist with their indices; an error for one that decays too fast.
pub(crate) fn below_nyquist<'t>(
    table: &'t BankTable<'_>,
    rate: SampleRate,
) -> impl Iterator<Item = Result<(usize, &'t ModeRecord), BankError>> + use<'t> {
    let modes = table.modes;
    let sounds = move |record: &ModeRecord| f64::from(record.frequency_hz.get()) < rate.hz() / 2.0;
    modes.iter().enumerate().filter(move |(_, record)| sounds(record)).map(move |(index, record)| {
        let decay_per_s = record.decay_per_s.get();
        match f64::from(decay_per_s) > max_decay_per_s(rate) {
            true => Err(BankError::DecayTooFast { mode: index, decay_per_s }),
            false => Ok((index, record)),
        }
    })
}

/// Checks the gains of a table, and the decays of its modes below Nyquist.
pub(crate) fn check_bank(table: &BankTable<'_>, rate: SampleRate) -> Result<(), BankError> {
    check_gains(table, rate)?;
    below_nyquist(table, rate).try_for_each(|mode| mode.map(|_| ()))
}

/// Modes of a table below Nyquist, with their poles.
pub(super) fn rendered<'t>(
    table: &'t BankTable<'_>,
    rate: SampleRate,
) -> impl Iterator<Item = Result<Rendered, BankError>> + use<'t> {
    below_nyquist(table, rate).filter_map(move |mode| match mode {
        Ok((index, record)) => pole_of(record, rate).map(|pole| Ok(Rendered { index, pole })),
        Err(error) => Some(Err(error)),
    })
}

/// Fills `modes` with the table's rendered modes in the order of their groups. Until they are
/// derived, a mode holds its table index in `state.u`, its lifetime in `state.v` and its side and
/// form in `gain.u`.
pub(super) fn order_modes(table: &BankTable<'_>, rate: SampleRate, modes: &mut [Mode]) -> Result<(), BankError> {
    for (slot, mode) in modes.iter_mut().zip(rendered(table, rate)) {
        let mode = mode?;
        *slot = Mode::SILENT;
        slot.state.u = mode.index as i32;
        slot.state.v = lifetime_ms(table, mode.index);
        slot.gain.u = mode.key();
    }
    sort(modes);
    Ok(())
}

/// Sorts by side and form, lifetime (longest first) and index. By insertion: the library's sort
/// would be 4 KB of flash, and this is less than a tenth of the cost of deriving the coefficients.
fn sort(modes: &mut [Mode]) {
    let is_before = |a: &Mode, b: &Mode| {
        let key = |mode: &Mode| (order_key(mode), core::cmp::Reverse(mode.state.v), mode.state.u);
        key(a) < key(b)
    };
    for end in 1..=modes.len() {
        for at in (1..end).rev() {
            match modes.get_mut(at - 1..=at) {
                Some([before, mode]) if is_before(mode, before) => core::mem::swap(before, mode),
                _ => break,
            }
        }
    }
}

pub(super) fn order_key(mode: &Mode) -> i32 {
    mode.gain.u
}

/// Time for which a typical strike keeps a mode above the retirement threshold. It decides the
/// order of groups, so that only its order of magnitude matters.
fn lifetime_ms(table: &BankTable<'_>, index: usize) -> i32 {
    let Some(record) = table.modes.get(index) else { return 0 };
    let (frequency_hz, decay_per_s) = (record.frequency_hz.get(), record.decay_per_s.get());
    let (impulse, contact_time_s) = table.typical_contact;
    let gains = table.gains.get(index * table.positions..).unwrap_or(&[]).iter().take(table.positions);
    let gain = gains.fold(0.0f32, |gain, at| gain.max(at.sine.get().abs()).max(at.cosine.get().abs()));
    // The spectrum of a contact pulse falls as 1/f² above 1/(2 τ).
    let corner = 2.0 * frequency_hz * contact_time_s;
    let level = gain * table.weight as f32 * impulse / (1.0 + corner * corner);
    let periods = logarithm((level / Retirement::THRESHOLD).max(1.0));
    (1000.0 * periods / decay_per_s) as i32
}

/// Natural logarithm to 6 %: a float's bits are its exponent followed by nearly its fraction's
/// logarithm.
fn logarithm(number: f32) -> f32 {
    const LN_2_OF_BITS: f32 = core::f32::consts::LN_2 / 8_388_608.0;
    (number.to_bits() as i32 - (127 << 23)) as f32 * LN_2_OF_BITS
}
