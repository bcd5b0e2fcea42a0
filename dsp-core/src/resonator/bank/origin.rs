//! Origins: a bank's memory of its modes' poles and table places.

use super::super::coefficient::{Coefficients, Form, change_of_u};

/// Data of a mode for a hand and for new positions; only banks that can be choked or have several
/// positions keep it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin {
    /// Coefficients of the mode that are not in use: those under a hand, or, while one lies there,
    /// those without.
    pub(super) other: Coefficients,
    /// Share of itself by which the hand makes a coupled form's u larger, Q32; 0 if it is too large
    /// for its quick inverse.
    pub(super) share: i32,
    /// Index of the mode in the table, with [`Origin::HELD`] and [`Origin::COUPLED`].
    pub(super) index_and_flags: u16,
    /// Place among the bank's modes of the mode that is at this origin's place in the order of the
    /// table.
    pub(super) slot: u16,
}

impl Origin {
    /// Origin that fills memory before a kit is loaded.
    pub const NONE: Self = Self { other: Coefficients { delta: 0, epsilon: 0 }, share: 0, index_and_flags: 0, slot: 0 };
    /// Flag of a mode under a hand.
    pub(super) const HELD: u16 = 1 << 15;
    /// Flag of a mode of the coupled form.
    pub(super) const COUPLED: u16 = 1 << 14;

    pub(super) fn new(form: Form, choked: Coefficients, index: u16) -> Self {
        let coupled = if form == Form::Coupled { Self::COUPLED } else { 0 };
        const { assert!(crate::table::range::MODES_PER_BANK <= Self::COUPLED as usize) };
        Self { other: choked, share: 0, index_and_flags: index | coupled, slot: 0 }
    }

    /// Index of the mode in the table.
    pub(super) fn index(&self) -> usize {
        usize::from(self.index_and_flags & (Self::COUPLED - 1))
    }

    pub(super) fn is_coupled(&self) -> bool {
        self.index_and_flags & Self::COUPLED != 0
    }

    fn is_held(&self) -> bool {
        self.index_and_flags & Self::HELD != 0
    }

    /// Coefficients without a hand of a mode with `present` ones.
    pub(super) fn at_rest(&self, present: Coefficients) -> Coefficients {
        if self.is_held() { self.other } else { present }
    }

    /// Gain into u under the present hand, from one that was derived without a hand.
    pub(super) fn held_gain(&self, present: Coefficients, gain: i32) -> i32 {
        let change = if self.is_held() && self.is_coupled() { change_of_u(self.other, present) } else { 0.0 };
        grown(gain, change)
    }
}

/// Number that has grown by a share of itself, rounded towards its former value.
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
