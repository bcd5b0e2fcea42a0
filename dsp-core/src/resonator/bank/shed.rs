//! Overload: what each group will cost, how loud it is, and leaving out the quietest.
//!
//! Groups are compared by a bound of their loudest mode's amplitude at the output, in steps of 3 dB: what rings, and what the contacts under
//! way may still bring. Among groups of one step the order is that of the bank. The choice depends on the state alone, so that "leave out the
//! n quietest" means the same groups wherever the same events are played.

use super::super::coefficient::Form;
use super::super::group::{GROUP_MODES, Group};
use super::super::headroom::GROWTH_OF_V;
use super::super::kernel::Plan;
use super::super::mode::Mode;
use super::{Bank, Memory, for_each_group};

/// Steps of loudness that are told apart: 3 dB each, from -180 dBFS.
pub const LEVELS: usize = 64;

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
    /// Bound of the sum of |force| still to come, bus steps.
    input: f32,
    unit_half_octaves: i32,
    input_half_octaves: Option<i32>,
    contact_half_octaves: i32,
}

impl Audience {
    /// `unit` is the output (1.0 = full scale) that a bus step makes; `input` bounds the sum of |force| still to come, bus steps;
    /// `contact_samples` is the length of the longest contact under way: modes far above its corner frequency get less of it (0: count them in
    /// full).
    pub fn new(unit: f32, input: f32, contact_samples: f32) -> Self {
        // A float's exponent and the first bit of its fraction count half octaves.
        let half_octaves = |x: f32| (x.to_bits() >> 22) as i32 - (127 << 1);
        Self {
            unit,
            input,
            unit_half_octaves: half_octaves(unit),
            input_half_octaves: (input > 0.0).then(|| half_octaves(input)),
            contact_half_octaves: half_octaves(contact_samples).max(0),
        }
    }
}

/// All groups of an engine by loudness.
#[derive(Debug)]
pub struct Survey<'a> {
    /// The level of each group, or [`SILENT`].
    pub levels: &'a mut [u8],
    /// What each level has and costs.
    pub steps: [Step; LEVELS],
}

/// What a level has and costs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Step {
    /// Groups.
    pub groups: u32,
    /// What they will cost.
    pub cycles: u32,
}

/// The level of a group that would not run.
pub const SILENT: u8 = u8::MAX;

/// What was left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shed {
    /// Register groups.
    pub groups: u32,
    /// Modes.
    pub modes: u32,
    /// Bound of the amplitude that is missing by it, 1.0 = full scale, summed over the modes.
    pub amplitude: f32,
    /// Cycles that it saves in the kernels until the tick's end.
    pub cycles: u32,
}

impl core::ops::AddAssign for Shed {
    fn add_assign(&mut self, other: Self) {
        self.groups += other.groups;
        self.modes += other.modes;
        self.amplitude += other.amplitude;
        self.cycles += other.cycles;
    }
}

impl Bank {
    /// Puts the loudness of each of its groups at the group's place in the survey, [`SILENT`] for those that would not run, and adds up
    /// what each step of loudness costs. Under a force all would run that are not left out already, else those that ring. `guard` are the
    /// cycles that a group's guard will take on top.
    #[inline(never)]
    pub fn survey(
        &self,
        groups: &[Group],
        modes: &[Mode],
        audience: Audience,
        (used, frames, guard): (Use, u32, u32),
        survey: &mut Survey<'_>,
    ) {
        let mut modes = modes.get(self.modes.range()).unwrap_or(&[]);
        let groups = groups.get(self.groups.range()).unwrap_or(&[]);
        for (group, place) in groups.iter().zip(survey.levels.get_mut(self.groups.range()).unwrap_or(&mut [])) {
            let Some((own, behind)) = modes.split_at_checked(group.count()) else { return };
            modes = behind;
            *place = SILENT;
            if runs(group, used) {
                let level = level(group, own, audience);
                *place = level;
                if let Some(step) = survey.steps.get_mut(usize::from(level)) {
                    step.groups += 1;
                    step.cycles += cycles(group.plan(), used, frames) + guard;
                }
            }
        }
    }

    /// What the bank will cost over a run of frames, without what comes once a call; and how many groups will run.
    pub fn cycles(&self, groups: &[Group], used: Use, frames: u32) -> (u32, u32) {
        let groups = groups.get(self.groups.range()).unwrap_or(&[]).iter();
        groups
            .filter(|group| runs(group, used))
            .fold((0, 0), |(total, count), group| (total + cycles(group.plan(), used, frames), count + 1))
    }

    /// Groups of the bank, at rest or not.
    pub fn group_count(&self) -> u32 {
        self.groups.range().len() as u32
    }

    /// Whether any group would run under a force.
    pub fn has_admitted(&self, groups: &[Group]) -> bool {
        groups.get(self.groups.range()).unwrap_or(&[]).iter().any(|group| !group.is_shed())
    }

    /// Whether a force now would find the groups unguarded, so that all of them must be guarded at once.
    pub fn is_unguarded(&self) -> bool {
        self.allowance == 0
    }

    /// Leaves out the groups whose level is below `threshold`, and the first `at_threshold` of those at it.
    pub fn shed(
        &mut self,
        memory: &mut Memory<'_>,
        audience: Audience,
        (used, frames): (Use, u32),
        levels: &[u8],
        (threshold, at_threshold): (u8, &mut u32),
    ) -> Shed {
        let (mut shed, mut rang) = (Shed::default(), false);
        let mut levels = levels.get(self.groups.range()).unwrap_or(&[]).iter();
        for_each_group(self.modes, self.groups, memory.modes, memory.groups, |group, modes| {
            let level = levels.next().copied().unwrap_or(SILENT);
            if level > threshold || level == SILENT || level == threshold && *at_threshold == 0 || !runs(group, used) {
                return;
            }
            if level == threshold {
                *at_threshold -= 1;
            }
            let count = group.count() as u32;
            let lost = group.amplitude_bound() + group.largest_gain() * audience.input;
            let amplitude = lost * audience.unit * (GROWTH_OF_V as u32 * count) as f32;
            shed += Shed { groups: 1, modes: count, amplitude, cycles: cycles(group.plan(), used, frames) };
            rang |= group.ringing();
            group.shed(modes);
        });
        // Groups at rest are no part of the plan.
        if rang {
            self.prepare(memory);
        }
        shed
    }

    /// Lets input reach all groups again: a new strike is a new chance.
    pub fn admit(&mut self, memory: &mut Memory<'_>) {
        let groups = memory.groups.get_mut(self.groups.range()).unwrap_or(&mut []);
        let mut admitted = false;
        for group in groups.iter_mut().filter(|group| group.is_shed()) {
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

/// Loudness in steps of 3 dB: the louder of what rings and what may come.
fn level(group: &Group, modes: &[Mode], audience: Audience) -> u8 {
    let ringing = group.ringing_half_octaves().unwrap_or(i32::MIN / 2);
    let coming = match audience.input_half_octaves {
        Some(input) => {
            group.gain_half_octaves() + input - lost_to_the_contact(group, modes, audience.contact_half_octaves)
        }
        None => i32::MIN / 2,
    };
    (ringing.max(coming) + audience.unit_half_octaves + 60).clamp(0, LEVELS as i32 - 1) as u8
}

/// How much of a contact's impulse does not reach the group's first mode, in half octaves: the spectrum of a pulse of N samples falls as
/// 1/(1 + (2 f N/fs)²).
fn lost_to_the_contact(group: &Group, modes: &[Mode], contact_half_octaves: i32) -> i32 {
    let epsilon = modes.first().map_or(1, |mode| mode.coefficients.epsilon.unsigned_abs());
    // e² = 4 sin²(θ/2), θ ≈ e; ε is Q32.
    let step_squared = match group.form() {
        _ if group.mirrored() => 3,
        Form::Coupled => 2 * (half_octaves(epsilon) - 64),
        form => half_octaves(epsilon) - 64 + 2 * form.shift() as i32,
    };
    // (2 f N/fs)² = e² N²/π².
    (step_squared + 2 * contact_half_octaves - 7).max(0)
}

/// `2 log2(x)`, rounded down; 0 for 0.
pub(in super::super) fn half_octaves(x: u32) -> i32 {
    let zeros = x.leading_zeros().min(31);
    let normal = x << zeros;
    2 * (31 - zeros as i32) + (normal >> 30 & 1) as i32
}

/// Cycles of a group over a run, from what the assembly does with its modes (nominal model; `cargo test -p host-tests --test virtual_budget`
/// holds the sums to 3 %).
fn cycles(plan: &Plan, used: Use, frames: u32) -> u32 {
    let count = plan.count().min(GROUP_MODES);
    let whole = frames == super::super::TICK_FRAMES as u32;
    let table = match (used, whole, plan.has_phase()) {
        (Use::Free, true, _) => &WHOLE_FREE,
        (Use::Driven, true, false) => &WHOLE_GAIN,
        (Use::Driven, true, true) => &WHOLE_PHASE,
        (Use::Free, false, _) => {
            let count = count as u32;
            return OTHER_GROUP + count / 3 * (65 + 21 * frames) + count % 3 * (35 + 12 * frames);
        }
        (Use::Driven, false, _) => {
            let count = count as u32;
            return OTHER_GROUP + count / 2 * (60 + 23 * frames) + count % 2 * (40 + 16 * frames);
        }
    };
    table.get(count).copied().unwrap_or(0)
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
