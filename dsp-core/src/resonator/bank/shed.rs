//! Shedding: the cycles and the loudness of each group, and leaving out the quietest groups.
//!
//! Groups are compared by a bound of their loudest mode's amplitude at the output, in steps of 3
//! dB: its ringing, and the input that the contacts under way may still bring. Groups of one step
//! are ordered as in the bank. The choice depends on the state alone, so that "leave out the n
//! quietest" means the same groups wherever the same events are played.

use super::super::group::Group;
#[cfg(feature = "counts")]
use super::super::headroom::GROWTH_OF_V;
use super::run_cost::{UpcomingRun, Use, whole_driven};
#[cfg(feature = "counts")]
use super::shed_plan::bound;
use super::shed_plan::{Audience, ShedChoice, ShedPlan, runs};
use super::state::Bank;

/// Sum of what was left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shed {
    /// Number of register groups.
    pub groups: u32,
    /// Number of modes.
    pub modes: u32,
    /// Bound of the amplitude that is missing because of it, 1.0 = full scale, summed over the
    /// modes. Kept on a PC alone (feature `counts`).
    #[cfg(feature = "counts")]
    pub amplitude: f32,
    /// Cycles saved until the tick's end, guards included, if there was a choice.
    pub cycles: u32,
    /// Number of groups among them that needed a guard in this tick.
    pub unguarded_groups: u32,
}

impl Shed {
    /// Nothing left out.
    pub const NOTHING: Self = Self {
        groups: 0,
        modes: 0,
        #[cfg(feature = "counts")]
        amplitude: 0.0,
        cycles: 0,
        unguarded_groups: 0,
    };
}

impl core::ops::AddAssign for Shed {
    fn add_assign(&mut self, other: Self) {
        self.groups += other.groups;
        self.modes += other.modes;
        #[cfg(feature = "counts")]
        {
            self.amplitude += other.amplitude;
        }
        self.cycles += other.cycles;
        self.unguarded_groups += other.unguarded_groups;
    }
}

impl Bank<'_> {
    /// Adds the bank's groups to a shed plan. Under a force all would run that are not left out
    /// already, else those that ring. Each counts the mean of the cycles of all that would run.
    pub fn plan_shedding(
        &self,
        audience: &Audience,
        UpcomingRun { used, frames, guard }: UpcomingRun,
        plan: &mut ShedPlan,
    ) {
        if let Some(cycles_each) = self.costs.cycles(used, frames.into()).checked_div(self.costs.groups(used)) {
            plan.add(self.groups, audience, used, cycles_each + u32::from(guard));
        }
    }

    /// Cycles of the bank over a run of frames, without those of the call.
    #[inline(always)]
    pub fn cycles(&self, used: Use, frames: u32) -> u32 {
        self.costs.cycles(used, frames)
    }

    /// Number of groups that run.
    #[inline(always)]
    pub fn running_groups(&self, used: Use) -> u32 {
        self.costs.groups(used)
    }

    /// Number of groups of the bank, at rest or not.
    pub fn group_count(&self) -> u32 {
        self.groups.len() as u32
    }

    /// True if any group would run under a force.
    pub fn has_admitted(&self) -> bool {
        self.groups.iter().any(|group| !group.is_shed())
    }

    /// Number of modes in groups that are left out.
    pub fn shed_mode_count(&self) -> usize {
        self.groups.iter().filter(|group| group.is_shed()).map(Group::count).sum()
    }

    /// True if the groups are unguarded, so that a force would have all of them guarded at once.
    pub fn is_unguarded(&self) -> bool {
        self.allowance == 0
    }

    /// Leaves out those of the chosen groups that would run, of which the first may stay. The plan
    /// knows their cycles ([`ShedPlan::quietest_that_free`]).
    #[inline(never)] // few registers: the loop stays short
    pub fn shed(
        &mut self,
        audience: &Audience,
        run: UpcomingRun,
        choice: &mut ShedChoice,
        mut first_stays: bool,
    ) -> Shed {
        let mut shed = Shed::NOTHING;
        let (mut cycles, mut rang) = (0, false);
        let mut rest = &mut *self.modes;
        for group in &mut *self.groups {
            let (own, others) = rest.split_at_mut_checked(group.count()).unwrap_or_default();
            rest = others;
            if !runs(group, run.used) || core::mem::take(&mut first_stays) || !choice.takes(group, audience) {
                continue;
            }
            shed.groups += 1;
            shed.modes += own.len() as u32; // at most 6
            #[cfg(feature = "counts")]
            {
                shed.amplitude += bound(group, audience) * own.len() as f32;
            }
            rang |= group.ringing();
            cycles += whole_driven(group.plan());
            group.shed(own);
        }
        self.costs.leave_out(shed.groups, cycles);
        // Groups at rest are no part of the mix.
        if rang {
            self.prepare();
        }
        #[cfg(feature = "counts")]
        {
            shed.amplitude *= (2 * GROWTH_OF_V) as f32 * audience.unit;
        }
        shed.unguarded_groups = if run.guard > 0 { shed.groups } else { 0 };
        shed
    }

    /// Lets input reach all groups again, for a new strike.
    pub fn admit(&mut self) {
        let mut admitted = false;
        for group in self.groups.iter_mut().filter(|group| group.is_shed()) {
            group.admit();
            admitted = true;
        }
        if admitted {
            // They are not guarded for the input of the others.
            self.allowance = 0;
            self.costs.admit();
        }
    }
}
