//! From a table's gains to the injections of a force into the states.

use super::coefficient::{Pole, Turn};
use super::group::MAX_GAIN_EXPONENT;
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

/// Gains of a table at a position, as a bank plays them.
pub(super) struct GainLaw<'a> {
    table: &'a BankTable<'a>,
    /// Bus steps of state a bus step of force and sample, for a gain of 1.
    scale: f32,
    position: f32,
}

/// Gains of one mode at a position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ModeGain {
    /// Injection into u and v, in bus steps of state a bus step of force.
    pub(super) injection: (f32, f32),
    /// Part of the mode's response that the force itself takes away, times the rate. It is half of
    /// `h[0]`, or with [`BankTable::is_balanced`] the whole static response, so that a constant
    /// force is not heard ([`crate::radiation`]).
    pub(super) taken: f32,
}

impl<'a> GainLaw<'a> {
    pub(super) fn new(table: &'a BankTable<'a>, rate: SampleRate, position: f32) -> Self {
        // Single precision suffices: a strike at another position derives its gains while sound
        // plays.
        Self { table, scale: table.weight as f32 / rate.hz_f32(), position }
    }

    /// Gains of the table's mode `index`, of which `pole` is the pole without a hand.
    pub(super) fn of(&self, pole: Pole, index: usize) -> ModeGain {
        let (sine, cosine) = gain_at(self.table.gains, self.table.positions, index, self.position);
        let turn = Turn::new(pole.form, pole.coefficients);
        let taken = match self.table.is_balanced {
            false => cosine / 2.0,
            // The sum over all n counts half of h[0] too much: just the half that an unbalanced
            // bank takes away.
            true => {
                let (of_sine, of_cosine) = turn.sums(pole.mirrored);
                sine * of_sine + cosine * of_cosine
            }
        };
        let (sine, cosine) = (sine * self.scale, cosine * self.scale);
        // sin n(π - θ') = -(-1)^n sin nθ'
        let sine = if pole.mirrored { -sine } else { sine };
        ModeGain { injection: turn.orbit().state(sine, cosine), taken }
    }

    /// Factor of the force for a sum of [`ModeGain::taken`].
    pub(super) fn onset(&self, taken: f32) -> Scale {
        Scale::new(f64::from(-taken * self.scale))
    }
}
