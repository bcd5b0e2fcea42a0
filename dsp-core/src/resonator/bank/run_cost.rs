//! Cycles of a bank's next run.

use super::super::group::{GROUP_MODES, Group, Plan};
use crate::time::TICK_FRAMES;

/// Use of a bank in its next run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Rings without a force.
    Free,
    /// Runs under a force.
    Driven,
    /// Runs under the force of a strike that is still to come: it reaches groups that are left out
    /// until then.
    Struck,
}

/// A bank's run until the tick's end.
#[derive(Clone, Copy, Debug)]
pub struct UpcomingRun {
    /// Use of the bank.
    pub used: Use,
    /// Number of frames, at most a tick.
    pub frames: u8,
    /// Extra cycles of a group's guard, 0 if none is due.
    pub guard: u16,
}

/// Groups that run, and their cycles over a whole tick.
#[derive(Clone, Copy, Debug)]
struct Running {
    cycles: u32,
    groups: u16,
}

impl Running {
    const NONE: Self = Self { cycles: 0, groups: 0 };
}

/// Groups of a bank that run in each [`Use`].
#[derive(Clone, Copy, Debug)]
pub(super) struct BankCosts {
    /// Groups that ring.
    free: Running,
    /// Groups that are not left out: all that ring are among them.
    driven: Running,
    all: Running,
}

impl BankCosts {
    pub(super) const NONE: Self = Self { free: Running::NONE, driven: Running::NONE, all: Running::NONE };

    /// Counts all groups of a bank: after load, and when gains have changed.
    #[inline(never)] // rare
    pub(super) fn count(&mut self, groups: &[Group]) {
        (self.all, self.driven) = (Running::NONE, Running::NONE);
        for group in groups {
            let cycles = whole_driven(group.plan());
            self.all.cycles += cycles;
            self.all.groups += 1; // banks count in 16 bits
            if !group.is_shed() {
                self.driven.cycles += cycles;
                self.driven.groups += 1;
            }
        }
    }

    /// Takes note that nothing is left out.
    pub(super) fn admit(&mut self) {
        self.driven = self.all;
    }

    /// Takes out groups that are left out from now on, with their [`whole_driven`] cycles.
    pub(super) fn leave_out(&mut self, groups: u32, cycles: u32) {
        self.driven.cycles = self.driven.cycles.saturating_sub(cycles);
        self.driven.groups = self.driven.groups.saturating_sub(groups as u16); // banks count in 16 bits
    }

    /// Begins to count the groups that ring.
    #[inline(always)]
    pub(super) fn none_rings(&mut self) {
        self.free = Running::NONE;
    }

    /// Counts a group that rings.
    #[inline(always)]
    pub(super) fn rings(&mut self, group: &Group) {
        self.free.cycles += WHOLE_FREE.get(group.count()).copied().unwrap_or(0);
        self.free.groups += 1;
    }

    #[inline(always)]
    fn running(&self, used: Use) -> &Running {
        match used {
            Use::Free => &self.free,
            Use::Driven => &self.driven,
            Use::Struck => &self.all,
        }
    }

    /// Cycles of a run of at most a tick. A shorter one takes less a group, but more a frame.
    #[inline(always)]
    pub(super) fn cycles(&self, used: Use, frames: u32) -> u32 {
        let whole = self.running(used).cycles;
        if frames == TICK_FRAMES as u32 {
            return whole;
        }
        // Of 1024. From a quarter of a tick on, full groups are within 6 % of the kernels; those
        // with phases are up to 20 % above.
        let share = if used == Use::Free { 133 + 43 * frames } else { 127 + 49 * frames };
        (whole * share) >> 10
    }

    #[inline(always)]
    pub(super) fn groups(&self, used: Use) -> u32 {
        self.running(used).groups.into()
    }
}

/// Cycles of a group under a force over a whole tick.
#[inline(always)]
pub(super) fn whole_driven(plan: &Plan) -> u32 {
    let table = if plan.has_phase() { &WHOLE_PHASE } else { &WHOLE_GAIN };
    table.get(plan.count()).copied().unwrap_or(0)
}

/// Cycles of a group over a whole tick, by its number of modes, from the assembly's treatment of
/// them (nominal model; `cargo test -p host-tests --test on_chip budget` holds the sums to 3 %).
const WHOLE_FREE: [u32; GROUP_MODES + 1] = by_count(3, FREE_THREE, [0, FREE_ONE, FREE_TWO]);
const WHOLE_GAIN: [u32; GROUP_MODES + 1] = by_count(2, GAIN_TWO, [0, DRIVEN_ONE, 0]);
const WHOLE_PHASE: [u32; GROUP_MODES + 1] = by_count(2, PHASE_TWO, [0, DRIVEN_ONE, 0]);

const fn by_count(set: usize, of_set: u32, leftover: [u32; 3]) -> [u32; GROUP_MODES + 1] {
    let mut table = [0; GROUP_MODES + 1];
    let mut count = 1;
    while count <= GROUP_MODES {
        let walk = if count == GROUP_MODES { FULL_GROUP } else { OTHER_GROUP };
        table[count] = (count / set) as u32 * of_set + leftover[count % set] + walk;
        count += 1;
    }
    table
}

const FREE_THREE: u32 = 514;
const FREE_TWO: u32 = 372;
const FREE_ONE: u32 = 230;
const GAIN_TWO: u32 = 483;
const PHASE_TWO: u32 = 581;
const DRIVEN_ONE: u32 = 340;
/// Cycles of the walk to a full group of the form before, and to any other group.
const FULL_GROUP: u32 = 14;
const OTHER_GROUP: u32 = 50;
