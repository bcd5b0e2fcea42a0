//! Force of contacts that go on, as a pad expects it.

use crate::resonator::Bank;

/// Unit of the expected force, in bus steps.
pub(super) const EXPECTED_STEP: u64 = 256;

/// Bit of a striker in a set of a pad's strikers.
pub(super) const fn bit_of(striker: u8) -> u8 {
    1 << (striker & 7)
}

/// True if strikers, a bit each, drive the bank of an index. Bank 0 is the object's, and any
/// striker drives it; bank n + 1 is that of striker n.
pub(super) const fn is_driven(index: usize, strikers: u8) -> bool {
    index == 0 || strikers >> ((index - 1) & 7) & 1 == 1
}

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

    /// True if a bank, by its [number](is_driven), needs a guard.
    pub(super) fn lacks_guard(self, index: usize, bank: &Bank<'_>) -> bool {
        let lacks_input = is_driven(index, self.strikers) && self.steps > 0 && bank.lacks(self.input());
        // A bank without any allowance is guarded by its next force.
        bank.has_admitted() && (lacks_input || index == 0 && self.has_moved && bank.has_allowance())
    }
}
