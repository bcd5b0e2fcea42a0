//! Origins: the poles of a bank's modes as the table has them.

use super::super::coefficient::{Coefficients, Form, change_of_u};

/// What a bank needs for a hand and for new positions; only banks that can be choked or have several positions keep it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin {
    /// The mode's coefficients that are not in use: those under a hand, or, while one lies there, those without.
    pub(super) other: Coefficients,
    /// By which share of itself the hand makes a coupled form's u larger, Q32; 0 where it is too large for its inverse to be quick.
    pub(super) share: i32,
    /// The mode's index in the table, [`Origin::HELD`] and [`Origin::COUPLED`].
    pub(super) index_and_flags: u16,
    /// Where among the bank's modes that mode lies which has this origin's place in the order of the table.
    pub(super) slot: u16,
}

impl Origin {
    /// Fills memory before a kit is loaded.
    pub const NONE: Self = Self { other: Coefficients { delta: 0, epsilon: 0 }, share: 0, index_and_flags: 0, slot: 0 };
}

impl Origin {
    /// The mode is under a hand.
    pub(super) const HELD: u16 = 1 << 15;
    /// The mode is of the coupled form.
    pub(super) const COUPLED: u16 = 1 << 14;

    pub(super) fn new(form: Form, choked: Coefficients, index: u16) -> Self {
        let coupled = if form == Form::Coupled { Self::COUPLED } else { 0 };
        const { assert!(crate::table::range::MODES_PER_BANK <= Self::COUPLED as usize) };
        Self { other: choked, share: 0, index_and_flags: index | coupled, slot: 0 }
    }

    /// The mode's index in the table.
    pub(super) fn index(&self) -> usize {
        usize::from(self.index_and_flags & (Self::COUPLED - 1))
    }

    pub(super) fn is_coupled(&self) -> bool {
        self.index_and_flags & Self::COUPLED != 0
    }

    fn is_held(&self) -> bool {
        self.index_and_flags & Self::HELD != 0
    }

    /// The coefficients without a hand of a mode that has `present` ones.
    pub(super) fn at_rest(&self, present: Coefficients) -> Coefficients {
        if self.is_held() { self.other } else { present }
    }

    /// What the hand makes of a gain into u that was derived without it.
    pub(super) fn held_gain(&self, present: Coefficients, gain: i32) -> i32 {
        let change = if self.is_held() && self.is_coupled() { change_of_u(self.other, present) } else { 0.0 };
        grown(gain, change)
    }
}

/// A number that grows by a share of itself, rounded towards what it was.
#[inline(always)]
pub(super) fn grown(number: i32, share: f32) -> i32 {
    number.saturating_add((number as f32 * share) as i32)
}

/// Puts the slots of the modes into the origins, in the order of the table.
pub(super) fn set_order(origins: &mut [Origin]) {
    for slot in 0..origins.len() {
        let Some(index) = origins.get(slot).map(Origin::index) else { return };
        let place = origins.iter().filter(|origin| origin.index() < index).count();
        if let Some(origin) = origins.get_mut(place) {
            origin.slot = slot as u16; // banks count in 16 bits
        }
    }
}
