//! Overload: what each group will cost, how loud it is, and leaving out the quietest.
//!
//! Groups are compared by a bound of their loudest mode's amplitude at the output, in steps of 3 dB: what rings, and what the contacts under
//! way may still bring. Among groups of one step the order is that of the bank. The choice depends on the state alone, so that "leave out the
//! n quietest" means the same groups wherever the same events are played.

use super::super::group::{GROUP_MODES, Group};
use super::super::headroom::GROWTH_OF_V;
use super::super::kernel::Plan;
use super::Bank;
use crate::time::TICK_FRAMES;

/// Half octaves that stand for nothing.
const NOTHING_TO_COME: i16 = -4000;

/// Steps of loudness that are told apart: 3 dB each, from -180 dBFS.
const LEVELS: usize = 64;

/// How a bank will run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Ringing on.
    Free,
    /// Under a force.
    Driven,
}

/// Who listens, and what is still to come.
#[derive(Clone, Copy, Debug)]
pub struct Audience {
    /// Output (1.0 = full scale) that a bus step of the bank makes.
    unit: f32,
    unit_half_octaves: i16,
    /// Far below all where nothing is to come.
    input_half_octaves: i16,
    contact_half_octaves: i16,
}

impl Audience {
    /// `unit` is the output (1.0 = full scale) that a bus step makes; `input` bounds the sum of |force| still to come, bus steps;
    /// `contact_samples` is the length of the longest contact under way: modes far above its corner frequency get less of it (0: count them in
    /// full).
    pub fn new(unit: f32, input: f32, contact_samples: f32) -> Self {
        // A float's exponent and the first bit of its fraction count half octaves.
        let half_octaves = |x: f32| (x.to_bits() >> 22) as i16 - (127 << 1);
        Self {
            unit,
            unit_half_octaves: half_octaves(unit),
            input_half_octaves: if input > 0.0 { half_octaves(input) } else { NOTHING_TO_COME },
            contact_half_octaves: half_octaves(contact_samples).max(0),
        }
    }
}

/// All groups of an engine by loudness.
#[derive(Debug)]
pub struct Survey<'l> {
    /// The level of each group in the order in which the banks are surveyed, or [`SILENT`].
    levels: &'l mut [u8],
    /// Number of groups that have been surveyed.
    surveyed: usize,
    /// What each level has and costs: groups, cycles.
    groups: [u16; LEVELS],
    cycles: [u32; LEVELS],
}

impl<'l> Survey<'l> {
    /// A survey of no group yet; `levels` has a byte for each group of the engine.
    pub fn new(levels: &'l mut [u8]) -> Self {
        levels.fill(SILENT);
        Self { levels, surveyed: 0, groups: [0; LEVELS], cycles: [0; LEVELS] }
    }

    /// Gives the levels' memory back.
    pub fn into_levels(self) -> &'l mut [u8] {
        self.levels
    }

    /// Passes over groups that will not run.
    pub fn pass_over(&mut self, groups: usize) {
        self.surveyed += groups;
    }

    /// How many of the quietest groups have to go to free so many cycles.
    pub fn quietest_that_free(&self, excess: u32) -> u16 {
        let (mut total, mut chosen) = (0, 0u16);
        for (&cycles, &groups) in self.cycles.iter().zip(&self.groups) {
            if total + cycles >= excess {
                // Of the level in which the excess ends, as many as are needed if the cheapest go first: a single mode costs a third of a
                // full group's share.
                let share = (excess - total).div_ceil((cycles / u32::from(groups.max(1))).max(1));
                return chosen + (share + share / 2 + 1).min(u32::from(groups)) as u16;
            }
            (total, chosen) = (total + cycles, chosen + groups);
        }
        chosen
    }

    /// The `count` quietest groups, and what those of them cost that lie below the level of the last.
    pub fn quietest(&self, count: u16) -> (Selection<'_>, u32) {
        let (mut left, mut cycles_below) = (count, 0);
        for ((&groups, &cycles), threshold) in self.groups.iter().zip(&self.cycles).zip(0u8..) {
            if groups > left {
                let at_threshold = u32::from(left);
                return (Selection { levels: Some(self.levels), threshold, at_threshold }, cycles_below);
            }
            (left, cycles_below) = (left - groups, cycles_below + cycles);
        }
        (Selection { levels: Some(self.levels), threshold: LEVELS as u8, at_threshold: 0 }, cycles_below)
    }
}

/// Which groups are left out.
#[derive(Debug)]
pub struct Selection<'a> {
    /// The level of each group of the engine that has not been passed yet; `None`: all are equally quiet.
    levels: Option<&'a [u8]>,
    /// What is below this level goes.
    threshold: u8,
    /// Of those at it so many more go, in the order of the banks.
    at_threshold: u32,
}

impl Selection<'static> {
    /// Everything.
    pub const ALL: Self = Self { levels: None, threshold: LEVELS as u8, at_threshold: 0 };
}

impl Selection<'_> {
    /// Passes over groups that will not run, in the order of the survey.
    pub fn pass_over(&mut self, groups: usize) {
        self.levels = self.levels.and_then(|levels| levels.get(groups..));
    }
}

/// The level of a group that would not run.
const SILENT: u8 = u8::MAX;

/// How a bank will run until the tick's end.
#[derive(Clone, Copy, Debug)]
pub struct UpcomingRun {
    /// Under a force or not.
    pub used: Use,
    /// Frames, at most a tick.
    pub frames: u8,
    /// Cycles that a group's guard will take on top, 0 where none is due.
    pub guard: u16,
}

/// What was left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shed {
    /// Register groups.
    pub groups: u32,
    /// Modes.
    pub modes: u32,
    /// Bound of the amplitude that is missing by it, 1.0 = full scale, summed over the modes.
    pub amplitude: f32,
    /// Cycles that it saves until the tick's end, guards included, where there was a choice.
    pub cycles: u32,
    /// Groups among them that needed a guard in this tick.
    pub unguarded_groups: u32,
}

impl Shed {
    /// Nothing.
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
    /// Puts the loudness of each of its groups at the group's place in the survey, `SILENT` for those that would not run, and adds up
    /// what each step of loudness costs. Under a force all would run that are not left out already, else those that ring.
    #[inline(never)]
    pub fn survey(
        &self,
        audience: &Audience,
        UpcomingRun { used, frames, guard }: UpcomingRun,
        survey: &mut Survey<'_>,
    ) {
        let costs = Costs::new(used, frames.into());
        let places = survey.levels.iter_mut().skip(survey.surveyed);
        for (group, place) in self.groups.iter().zip(places) {
            if runs(group, used) {
                let level = level(group, audience);
                *place = level;
                let at = usize::from(level);
                if let (Some(groups), Some(total)) = (survey.groups.get_mut(at), survey.cycles.get_mut(at)) {
                    *groups += 1;
                    *total += costs.of(group.plan()) + u32::from(guard);
                }
            }
        }
        survey.pass_over(self.groups.len());
    }

    /// What the bank will cost over a run of frames, without what comes once a call; and how many groups will run.
    pub fn cycles(&self, used: Use, frames: u32) -> (u32, u32) {
        let costs = Costs::new(used, frames);
        self.groups
            .iter()
            .filter(|group| runs(group, used))
            .fold((0, 0), |(total, count), group| (total + costs.of(group.plan()), count + 1))
    }

    /// Groups of the bank, at rest or not.
    pub fn group_count(&self) -> u32 {
        self.groups.len() as u32
    }

    /// Whether any group would run under a force.
    pub fn has_admitted(&self) -> bool {
        self.groups.iter().any(|group| !group.is_shed())
    }

    /// Number of modes in groups that are left out.
    pub fn shed_mode_count(&self) -> usize {
        self.groups.iter().filter(|group| group.is_shed()).map(Group::count).sum()
    }

    /// Whether a force now would find the groups unguarded, so that all of them must be guarded at once.
    pub fn is_unguarded(&self) -> bool {
        self.allowance == 0
    }

    /// Leaves out those of the selected groups that would run. The cycles in what it gives are those of the selection's last level: of the
    /// others the survey knows ([`Survey::quietest`]).
    pub fn shed(
        &mut self,
        audience: &Audience,
        UpcomingRun { used, frames, guard }: UpcomingRun,
        selection: &mut Selection<'_>,
    ) -> Shed {
        let costs = Costs::new(used, frames.into());
        let (mut count, mut modes, mut lost, mut saved, mut rang) = (0, 0, 0.0, 0, false);
        let mut start = 0;
        let levels = selection.levels;
        for (index, group) in self.groups.iter_mut().enumerate() {
            let level = levels.and_then(|levels| levels.get(index)).copied().unwrap_or(0);
            let first = start;
            start += group.count();
            if level > selection.threshold || !runs(group, used) {
                continue;
            }
            if level == selection.threshold {
                if selection.at_threshold == 0 {
                    continue;
                }
                selection.at_threshold -= 1;
                saved += costs.of(group.plan()) + u32::from(guard);
            }
            count += 1;
            modes += (start - first) as u32;
            lost += bound(group, audience) * (start - first) as f32;
            rang |= group.ringing();
            group.shed(self.modes.get_mut(first..start).unwrap_or(&mut []));
        }
        selection.pass_over(self.groups.len());
        // Groups at rest are no part of the plan.
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

    /// Lets input reach all groups again: a new strike is a new chance.
    pub fn admit(&mut self) {
        let mut admitted = false;
        for group in self.groups.iter_mut().filter(|group| group.is_shed()) {
            group.admit();
            admitted = true;
        }
        if admitted {
            // They are not guarded for the input that the others are.
            self.allowance = 0;
        }
    }
}

fn runs(group: &Group, used: Use) -> bool {
    group.ringing() || used == Use::Driven && !group.is_shed()
}

/// Half a bound of what a mode of the group rings with and of what may still come, bus steps.
#[inline(always)]
fn bound(group: &Group, audience: &Audience) -> f32 {
    // Powers of two within a factor of two of the truth, which `shed` makes up for.
    let of_half_octaves = |half_octaves: i32| f32::from_bits((((half_octaves >> 1) + 127).max(0) as u32) << 23);
    // One more for what both factors lose when they are rounded down.
    let coming = of_half_octaves(group.gain_half_octaves() + i32::from(audience.input_half_octaves) + 2);
    if group.ringing() { coming + of_half_octaves(group.ringing_half_octaves()) } else { coming }
}

/// Loudness in steps of 3 dB: the louder of what rings and what may come.
#[inline(always)]
fn level(group: &Group, audience: &Audience) -> u8 {
    let lost = lost_to_the_contact(group, audience.contact_half_octaves.into());
    let coming = group.gain_half_octaves() + i32::from(audience.input_half_octaves) - lost;
    let loudest = if group.ringing() { coming.max(group.ringing_half_octaves()) } else { coming };
    (loudest + i32::from(audience.unit_half_octaves) + 60).clamp(0, LEVELS as i32 - 1) as u8
}

/// How much of a contact's impulse does not reach the group's first mode, in half octaves: the spectrum of a pulse of N samples falls as
/// 1/(1 + (2 f N/fs)²), and (2 f N/fs)² = θ² N²/π².
#[inline(always)]
fn lost_to_the_contact(group: &Group, contact_half_octaves: i32) -> i32 {
    (group.angle_quarter_octaves() + 2 * contact_half_octaves - 7).max(0)
}

/// `2 log2(x)`, rounded down; 0 for 0.
pub(in super::super) fn half_octaves(x: u32) -> i32 {
    let zeros = x.leading_zeros().min(31);
    let normal = x << zeros;
    2 * (31 - zeros as i32) + (normal >> 30 & 1) as i32
}

/// Cycles of groups over a run, from what the assembly does with their modes (nominal model; `cargo test -p host-tests --test on_chip budget`
/// holds the sums to 3 %).
struct Costs {
    used: Use,
    frames: u32,
    /// Of a whole tick: groups with one gain, and with gain and phase.
    plain: &'static [u32; GROUP_MODES + 1],
    phase: &'static [u32; GROUP_MODES + 1],
}

impl Costs {
    fn new(used: Use, frames: u32) -> Self {
        let (plain, phase) = match used {
            Use::Free => (&WHOLE_FREE, &WHOLE_FREE),
            Use::Driven => (&WHOLE_GAIN, &WHOLE_PHASE),
        };
        Self { used, frames, plain, phase }
    }

    #[inline(always)]
    fn of(&self, plan: &Plan) -> u32 {
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
                Use::Driven => count / 2 * (60 + 23 * frames) + count % 2 * (40 + 16 * frames),
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
/// The walk to a full group of the form before, and to any other.
const FULL_GROUP: u32 = 14;
const OTHER_GROUP: u32 = 50;
