//! Loudness of the groups of an engine, and the choice of those that are left out.

use super::super::group::Group;

/// Half octaves that stand for no input at all.
const NOTHING_TO_COME: i16 = -4000;

/// Number of steps of loudness: 3 dB each, from -180 dBFS.
const LEVELS: usize = 64;

/// Scale of the output, and the input that is still to come.
#[derive(Clone, Copy, Debug)]
pub struct Audience {
    /// Output (1.0 = full scale) that a bus step of the bank makes.
    pub(super) unit: f32,
    unit_half_octaves: i16,
    /// Input in half octaves, [`NOTHING_TO_COME`] if none is to come.
    input_half_octaves: i16,
    contact_half_octaves: i16,
}

impl Audience {
    /// `unit` is the output (1.0 = full scale) that a bus step makes. `input` bounds the sum of
    /// |force| still to come, in bus steps. `contact_samples` is the length of the longest contact
    /// under way, of which modes far above its corner frequency get less; 0 counts them in full.
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

/// All groups of an engine by loudness, and their cycles.
#[derive(Debug)]
pub struct ShedPlan<'l> {
    /// Level of each group in the order of the banks, or [`SILENT`].
    pub(super) levels: &'l mut [u8],
    /// Number of groups that have been added.
    pub(super) surveyed: usize,
    /// Groups and cycles of each level.
    pub(super) groups: [u16; LEVELS],
    /// Number of groups that would run.
    pub(super) running: u16,
    /// Lowest level of a group. Most plans have groups at few of the levels.
    pub(super) lowest: u8,
    pub(super) cycles: [u32; LEVELS],
}

impl<'l> ShedPlan<'l> {
    /// A plan of no group yet; `levels` has a byte for each group of the engine.
    pub fn new(levels: &'l mut [u8]) -> Self {
        levels.fill(SILENT);
        Self { levels, surveyed: 0, groups: [0; LEVELS], running: 0, lowest: LEVELS as u8, cycles: [0; LEVELS] }
    }

    /// Gives the levels' memory back.
    pub fn into_levels(self) -> &'l mut [u8] {
        self.levels
    }

    /// Passes over groups that will not run.
    pub fn pass_over(&mut self, groups: usize) {
        self.surveyed += groups;
    }

    /// Cycles, groups and number of each level from the lowest one on.
    #[inline(always)]
    fn occupied(&self) -> impl Iterator<Item = (&u32, &u16, u8)> {
        let from = usize::from(self.lowest)..;
        let of_level = |((cycles, groups), level)| (cycles, groups, level);
        let cycles = self.cycles.get(from.clone()).unwrap_or(&[]);
        cycles.iter().zip(self.groups.get(from).unwrap_or(&[])).zip(self.lowest..).map(of_level)
    }

    /// Number of the quietest groups that must go to free `excess` cycles. The loudest one stays,
    /// even if its cycles are missing, because a strike without it would be silent. A tick keeps
    /// time free that they come from (`cargo test -p virtual-board --test boards load`).
    pub fn quietest_that_free(&self, excess: u32) -> u16 {
        let (mut total, mut chosen) = (0, 0u16);
        for (&cycles, &groups, _) in self.occupied() {
            if total + cycles >= excess {
                // Of the level in which the excess ends, as many as suffice if the cheapest go
                // first: a single mode costs a third of a full group's share.
                let share = (excess - total).div_ceil((cycles / u32::from(groups.max(1))).max(1));
                let share = (share + share / 2 + 1).min(u32::from(groups)) as u16;
                return (chosen + share).min(self.running.saturating_sub(1));
            }
            (total, chosen) = (total + cycles, chosen + groups);
        }
        self.running.saturating_sub(1)
    }

    /// Choice of the `count` quietest groups, and the cycles of those that lie below the level of
    /// the last.
    pub fn quietest(&self, count: u16) -> (ShedChoice<'_>, u32) {
        let (mut left, mut cycles_below) = (count, 0);
        for (&cycles, &groups, threshold) in self.occupied() {
            if groups > left {
                let at_threshold = u32::from(left);
                return (ShedChoice { levels: Some(self.levels), threshold, at_threshold }, cycles_below);
            }
            (left, cycles_below) = (left - groups, cycles_below + cycles);
        }
        (ShedChoice { levels: Some(self.levels), threshold: LEVELS as u8, at_threshold: 0 }, cycles_below)
    }
}

/// Choice of the groups that are left out.
#[derive(Debug)]
pub struct ShedChoice<'a> {
    /// Level of each group of the engine that has not been passed yet; `None` if all are equally
    /// quiet.
    pub(super) levels: Option<&'a [u8]>,
    /// Level below which all groups go.
    pub(super) threshold: u8,
    /// Number of groups at that level that still go, in the order of the banks.
    pub(super) at_threshold: u32,
}

impl ShedChoice<'static> {
    /// Choice of all groups.
    pub const ALL: Self = Self { levels: None, threshold: LEVELS as u8, at_threshold: 0 };
}

impl ShedChoice<'_> {
    /// Passes over groups that will not run, in the order of the plan.
    pub fn pass_over(&mut self, groups: usize) {
        self.levels = self.levels.and_then(|levels| levels.get(groups..));
    }
}

/// Level of a group that would not run.
const SILENT: u8 = u8::MAX;

/// Half a bound of the amplitude of a mode of the group, ringing and input still to come, in bus
/// steps.
#[inline(always)]
pub(super) fn bound(group: &Group, audience: &Audience) -> f32 {
    // Powers of two within a factor of two of the truth, which `shed` makes up for.
    let of_half_octaves = |half_octaves: i32| f32::from_bits((((half_octaves >> 1) + 127).max(0) as u32) << 23);
    // One more for the loss of both factors when they are rounded down.
    let coming = of_half_octaves(group.gain_half_octaves() + i32::from(audience.input_half_octaves) + 2);
    if group.ringing() { coming + of_half_octaves(group.ringing_half_octaves()) } else { coming }
}

/// Loudness in steps of 3 dB: that of the ringing or of the input to come, whichever is louder.
#[inline(always)]
pub(super) fn level(group: &Group, audience: &Audience) -> u8 {
    let lost = lost_to_the_contact(group, audience.contact_half_octaves.into());
    let coming = group.gain_half_octaves() + i32::from(audience.input_half_octaves) - lost;
    let loudest = if group.ringing() { coming.max(group.ringing_half_octaves()) } else { coming };
    (loudest + i32::from(audience.unit_half_octaves) + 60).clamp(0, LEVELS as i32 - 1) as u8
}

/// Part of a contact's impulse that does not reach the group's first mode, in half octaves: the
/// spectrum of a pulse of N samples falls as 1/(1 + (2 f N/fs)²), and (2 f N/fs)² = θ² N²/π².
#[inline(always)]
fn lost_to_the_contact(group: &Group, contact_half_octaves: i32) -> i32 {
    (group.angle_quarter_octaves() + 2 * contact_half_octaves - 7).max(0)
}
