//! Headroom of a pad's banks for the force that is expected.

use super::ongoing::{EXPECTED_STEP, Ongoing, bit_of, is_driven};
use super::state::Voice;
use crate::resonator::Bank;

impl Voice<'_, '_> {
    /// True if a contact that moves along the object can take its slot with it.
    pub fn follows_positions(&self) -> bool {
        self.moves && self.banks.first().is_some_and(Bank::has_positions)
    }

    /// Notes that a slot of the object has moved, whose gains need a guard.
    pub fn note_move(&mut self) {
        self.ongoing.has_moved = true;
    }

    /// Expects a force that goes on, by a striker: the sum of |force| of the tick that begins, in
    /// bus steps.
    pub fn expect_ongoing(&mut self, striker: u8, input: u64) {
        let steps = u32::try_from(input.div_ceil(EXPECTED_STEP)).unwrap_or(u32::MAX);
        self.ongoing.steps = self.ongoing.steps.saturating_add(steps);
        self.ongoing.strikers |= bit_of(striker);
        self.struck = true;
        self.admit();
    }

    /// Number of register groups that [`Voice::meet_ongoing`] would guard.
    pub fn groups_to_guard_for_ongoing(&self) -> u32 {
        let banks = self.banks.iter().enumerate().filter(|(index, bank)| self.ongoing.lacks_guard(*index, bank));
        banks.map(|(_, bank)| bank.group_count()).sum()
    }

    /// Guards the banks for the contacts that go on, where they need it; call it before the tick's
    /// first run.
    pub fn meet_ongoing(&mut self) {
        let ongoing = core::mem::replace(&mut self.ongoing, Ongoing::NONE);
        for (index, bank) in self.banks.iter_mut().enumerate() {
            if ongoing.lacks_guard(index, bank) {
                bank.expect_ongoing(ongoing.input());
            }
        }
    }

    /// Guards the banks that contacts which have just begun will drive; call it before their first
    /// run. The bank of another striker stays as it is: at rest it costs nothing.
    pub fn meet_expected(&mut self) {
        let expected = u64::from(core::mem::take(&mut self.expected)) * EXPECTED_STEP;
        let strikers = core::mem::take(&mut self.expected_strikers);
        if expected > 0 {
            self.wake();
            // A bank whose groups are all shed needs no guard.
            for (index, bank) in self.banks.iter_mut().enumerate() {
                if is_driven(index, strikers) && bank.has_admitted() {
                    bank.expect(expected);
                }
            }
        }
    }
}
