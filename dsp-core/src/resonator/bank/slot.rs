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
    /// Gains of all modes; empty where the bank has one slot only.
    pub(super) gains: &'m mut [InputGain],
    /// As [`Bank::onset`], for force in this slot.
    pub(super) onset: Scale,
}

impl SecondSlot<'_> {
    /// No gains, and none to come.
    pub(super) const fn none() -> Self {
        Self { has_positions: false, is_set: false, position: 0.0, gains: &mut [], onset: Scale::ZERO }
    }
}

/// Which slot a strike drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The slot.
    pub slot: u8,
    /// True if its gains must be derived for the strike's position: [`Bank::set_position`].
    pub moves: bool,
    /// True if both slots are taken by other positions, of which it gets the nearer.
    pub is_merged: bool,
}

impl Place {
    /// Slot 0 as it is.
    pub const FIRST: Self = Self { slot: 0, moves: false, is_merged: false };
}
