//! Force of contacts that go on, as a pad expects it.

use crate::resonator::Bank;

/// Unit of the expected force, in bus steps.
pub(super) const EXPECTED_STEP: u64 = 256;

/// Force of contacts that go on, in the tick that begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ongoing {
    /// Sum of |force| in units of [`EXPECTED_STEP`], rounded up.
    pub(super) steps: u32,
    /// Strikers of the contacts: a bit for each.
    pub(super) strikers: u8,
    /// True if a slot has moved since the last guard.
    pub(super) has_moved: bool,
}

impl Ongoing {
    /// No force.
    pub(super) const NONE: Self = Self { steps: 0, strikers: 0, has_moved: false };

    /// Sum of |force| in bus steps.
    pub(super) fn input(self) -> u64 {
        u64::from(self.steps) * EXPECTED_STEP
    }

    /// True if a bank needs a guard: bank 0 is the object's, the others are those of the strikers.
    pub(super) fn lacks_guard(self, index: usize, bank: &Bank<'_>) -> bool {
        let is_driven = index == 0 || self.strikers >> ((index - 1) & 7) & 1 == 1;
        let lacks_input = is_driven && self.steps > 0 && bank.lacks(self.input());
        // A bank without any allowance is guarded by its next force.
        bank.has_admitted() && (lacks_input || index == 0 && self.has_moved && bank.has_allowance())
    }
}
