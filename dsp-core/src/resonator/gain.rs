//! From a table's gains to the injections of a force into the states.

use super::coefficient::{Coefficients, Orbit, Pole};
use super::group::{Group, MAX_GAIN_EXPONENT};
use super::mode::Mode;
use super::table::{BankError, BankTable};
use crate::SampleRate;
use crate::fixed::Scale;
use crate::table::layout::GainRecord;

/// Gains (sine, cosine) of a table's mode at a position, linear between the table's positions.
pub(crate) fn gain_at(gains: &[GainRecord], positions: usize, index: usize, position: f32) -> (f32, f32) {
    let place = position * (positions.saturating_sub(1)) as f32;
    let below = (place as usize).min(positions.saturating_sub(1));
    let fraction = place - below as f32;
    let at = |position: usize| gains.get(index * positions + position.min(positions.saturating_sub(1)));
    match (at(below), at(below + 1)) {
        (Some(low), Some(high)) if fraction > 0.0 => {
            let between = |low: f32, high: f32| low + (high - low) * fraction;
            (between(low.sine.get(), high.sine.get()), between(low.cosine.get(), high.cosine.get()))
        }
        (Some(low), _) => (low.sine.get(), low.cosine.get()),
        (None, _) => (0.0, 0.0),
    }
}

/// Least gain, in bus steps of state a bus step of force and sample, that is refused. An [`Orbit`]
/// makes at most four times as much of a gain, which the smallest block exponent still holds.
pub(super) const MAX_GAIN: f64 = (1u32 << (MAX_GAIN_EXPONENT - 2)) as f64;

pub(super) fn check_gains(table: &BankTable<'_>, rate: SampleRate) -> Result<(), BankError> {
    let largest = table
        .gains
        .iter()
        .fold(0.0f32, |largest, gain| largest.max(gain.sine.get().abs()).max(gain.cosine.get().abs()));
    let gain = (f64::from(largest) * table.weight / rate.hz()).abs();
    if gain < MAX_GAIN { Ok(()) } else { Err(BankError::GainTooLarge) }
}

/// Law of a table's gains at a position, by mode, in bus steps of state a bus step of force and
/// sample.
pub(super) fn gain_law<'a>(
    table: &'a BankTable<'_>,
    rate: SampleRate,
    position: f32,
) -> impl Fn(Option<usize>) -> (f32, f32) + use<'a> {
    let scale = (table.weight / rate.hz()) as f32;
    let (gains, positions) = (table.gains, table.positions);
    move |index| {
        let (sine, cosine) = index.map_or((0.0, 0.0), |index| gain_at(gains, positions, index, position));
        (sine * scale, cosine * scale)
    }
}

/// Turns phase gains into injections of a group's form: `gain` gives a mode's (sine, cosine),
/// `pole` its coefficients without a hand.
pub(super) fn orbit_gains<G: Fn(usize) -> (f32, f32), P: Fn(usize, &Mode) -> Coefficients>(
    group: &Group,
    gain: G,
    pole: P,
) -> impl Fn(usize, &Mode) -> (f32, f32) + use<G, P> {
    let (form, mirrored) = (group.form(), group.mirrored());
    move |slot, mode| {
        let (sine, cosine) = gain(slot);
        // sin n(π - θ') = -(-1)^n sin nθ'
        let sine = if mirrored { -sine } else { sine };
        Orbit::new(form, pole(slot, mode)).state(sine, cosine)
    }
}

/// Part of a mode's response at a position that the force itself takes away, times the rate. It is
/// half of `h[0]`, or with [`BankTable::is_balanced`] the whole static response, so that a constant
/// force is not heard ([`crate::radiation`]).
pub(super) fn taken_at_once(table: &BankTable<'_>, pole: Pole, index: usize, position: f32) -> f64 {
    let (sine, cosine) = gain_at(table.gains, table.positions, index, position);
    if !table.is_balanced {
        return f64::from(cosine) / 2.0;
    }
    // The sum over all n counts half of h[0] too much: just the half that an unbalanced bank takes
    // away. Single precision suffices, as for the injections: a strike at another position derives
    // it while sound plays.
    let (of_sine, of_cosine) = pole.sums();
    f64::from(sine * of_sine + cosine * of_cosine)
}

/// Factor of the force for a sum of [`taken_at_once`].
pub(super) fn onset(taken: f64, table: &BankTable<'_>, rate: SampleRate) -> Scale {
    Scale::new(-taken * table.weight / rate.hz())
}
