//! The two slots of a bank: gains of up to two positions.

use super::super::mode::InputGain;
use crate::fixed::Scale;

/// Slot 1 of a bank.
#[derive(Debug)]
pub(super) struct SecondSlot<'m> {
    /// True if the bank's table has several positions.
    pub(super) has_positions: bool,
    /// True once gains have been derived for the slot.
    pub(super) is_set: bool,
    pub(super) position: f32,
    /// Gains of all modes; empty if the bank has one slot only.
    pub(super) gains: &'m mut [InputGain],
    /// Factor of the force in this slot that is added to the sound ([`Bank::onset`](super::Bank)).
    pub(super) onset: Scale,
}

impl SecondSlot<'_> {
    /// A slot without gains, which no position can take.
    pub(super) const fn none() -> Self {
        Self { has_positions: false, is_set: false, position: 0.0, gains: &mut [], onset: Scale::ZERO }
    }
}

/// Slot that a strike drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Number of the slot.
    pub slot: u8,
    /// True if its gains must be derived for the strike's position: [`super::Bank::set_position`].
    pub moves: bool,
    /// True if other positions take both slots, so that the strike drives the nearer one.
    pub is_merged: bool,
}

impl Place {
    /// Slot 0 with its present gains.
    pub const FIRST: Self = Self { slot: 0, moves: false, is_merged: false };
}
