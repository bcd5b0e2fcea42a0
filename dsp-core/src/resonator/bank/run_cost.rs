//! Cycles of a bank's next run.

use super::super::group::{GROUP_MODES, Plan};
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

/// Cycles of groups over a run, from the assembly's treatment of their modes (nominal model;
/// `cargo test -p host-tests --test on_chip budget` holds the sums to 3 %).
pub(super) struct Costs {
    used: Use,
    frames: u32,
    /// Cycles of a whole tick, for groups with one gain, and with gain and phase.
    plain: &'static [u32; GROUP_MODES + 1],
    phase: &'static [u32; GROUP_MODES + 1],
}

impl Costs {
    pub(super) fn new(used: Use, frames: u32) -> Self {
        let (plain, phase) = match used {
            Use::Free => (&WHOLE_FREE, &WHOLE_FREE),
            Use::Driven | Use::Struck => (&WHOLE_GAIN, &WHOLE_PHASE),
        };
        Self { used, frames, plain, phase }
    }

    #[inline(always)]
    pub(super) fn of(&self, plan: &Plan) -> u32 {
        if self.frames != TICK_FRAMES as u32 {
            return self.of_cut_tick(plan);
        }
        let table = if plan.has_phase() { self.phase } else { self.plain };
        table.get(plan.count()).copied().unwrap_or(0)
    }

    #[cold]
    #[inline(never)]
    fn of_cut_tick(&self, plan: &Plan) -> u32 {
        let (count, frames) = (plan.count() as u32, self.frames);
        OTHER_GROUP
            + match self.used {
                Use::Free => count / 3 * (65 + 21 * frames) + count % 3 * (35 + 12 * frames),
                Use::Driven | Use::Struck => count / 2 * (60 + 23 * frames) + count % 2 * (40 + 16 * frames),
            }
    }
}

/// Cycles of a group over a whole tick, by its number of modes.
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
