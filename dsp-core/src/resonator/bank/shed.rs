//! Shedding: the cycles and the loudness of each group, and leaving out the quietest groups.
//!
//! Groups are compared by a bound of their loudest mode's amplitude at the output, in steps of 3
//! dB: its ringing, and the input that the contacts under way may still bring. Groups of one step
//! are ordered as in the bank. The choice depends on the state alone, so that "leave out the n
//! quietest" means the same groups wherever the same events are played.

use super::super::group::Group;
use super::super::headroom::GROWTH_OF_V;
use super::run_cost::{Costs, UpcomingRun, Use};
use super::shed_plan::{Audience, ShedChoice, ShedPlan, bound, level};
use super::state::Bank;

/// Sum of what was left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shed {
    /// Number of register groups.
    pub groups: u32,
    /// Number of modes.
    pub modes: u32,
    /// Bound of the amplitude that is missing because of it, 1.0 = full scale, summed over the
    /// modes.
    pub amplitude: f32,
    /// Cycles saved until the tick's end, guards included, as far as there was a choice.
    pub cycles: u32,
    /// Number of groups among them that needed a guard in this tick.
    pub unguarded_groups: u32,
}

impl Shed {
    /// Nothing left out.
    pub const NOTHING: Self = Self { groups: 0, modes: 0, amplitude: 0.0, cycles: 0, unguarded_groups: 0 };
}

impl core::ops::AddAssign for Shed {
    fn add_assign(&mut self, other: Self) {
        self.groups += other.groups;
        self.modes += other.modes;
        self.amplitude += other.amplitude;
        self.cycles += other.cycles;
        self.unguarded_groups += other.unguarded_groups;
    }
}

impl Bank<'_> {
    /// Adds the bank's groups to a shed plan: the loudness of each, `SILENT` for those that would
    /// not run, and the cycles of each step of loudness. Under a force all groups would run that
    /// are not left out already, else those that ring.
    #[inline(never)]
    pub fn plan_shedding(
        &self,
        audience: &Audience,
        UpcomingRun { used, frames, guard }: UpcomingRun,
        plan: &mut ShedPlan<'_>,
    ) {
        let costs = Costs::new(used, frames.into());
        let places = plan.levels.iter_mut().skip(plan.surveyed);
        for (group, place) in self.groups.iter().zip(places) {
            if runs(group, used) {
                let level = level(group, audience);
                *place = level;
                plan.running += 1;
                plan.lowest = plan.lowest.min(level);
                let at = usize::from(level);
                if let (Some(groups), Some(total)) = (plan.groups.get_mut(at), plan.cycles.get_mut(at)) {
                    *groups += 1;
                    *total += costs.of(group.plan()) + u32::from(guard);
                }
            }
        }
        plan.pass_over(self.groups.len());
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

    /// Leaves out those of the chosen groups that would run. The cycles of the result are those of
    /// the choice's last level; the plan knows those of the others ([`ShedPlan::quietest`]).
    pub fn shed(
        &mut self,
        audience: &Audience,
        UpcomingRun { used, frames, guard }: UpcomingRun,
        choice: &mut ShedChoice<'_>,
    ) -> Shed {
        let costs = Costs::new(used, frames.into());
        let (mut count, mut modes, mut lost, mut saved, mut rang) = (0, 0, 0.0, 0, false);
        let mut start = 0;
        let levels = choice.levels;
        for (index, group) in self.groups.iter_mut().enumerate() {
            let level = levels.and_then(|levels| levels.get(index)).copied().unwrap_or(0);
            let first = start;
            start += group.count();
            if level > choice.threshold || !runs(group, used) {
                continue;
            }
            if level == choice.threshold {
                if choice.at_threshold == 0 {
                    continue;
                }
                choice.at_threshold -= 1;
                saved += costs.of(group.plan()) + u32::from(guard);
            }
            count += 1;
            modes += (start - first) as u32;
            lost += bound(group, audience) * (start - first) as f32;
            rang |= group.ringing();
            self.costs.leave_out(group);
            group.shed(self.modes.get_mut(first..start).unwrap_or(&mut []));
        }
        choice.pass_over(self.groups.len());
        // Groups at rest are no part of the mix.
        if rang {
            self.prepare();
        }
        Shed {
            groups: count,
            modes,
            amplitude: lost * (2 * GROWTH_OF_V) as f32 * audience.unit,
            cycles: saved,
            unguarded_groups: if guard > 0 { count } else { 0 },
        }
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

fn runs(group: &Group, used: Use) -> bool {
    group.ringing()
        || match used {
            Use::Free => false,
            Use::Driven => !group.is_shed(),
            Use::Struck => true,
        }
}
