//! Loudness of the groups of an engine, and the choice of those that are left out.

use super::super::group::Group;
use super::run_cost::Use;

/// Half octaves that stand for no input at all.
const NOTHING_TO_COME: i16 = -4000;

/// Number of steps of loudness: 3 dB each, from -108 dBFS.
const LEVELS: usize = 40;

/// Step of 0 dBFS.
const FULL_SCALE: i16 = 36;

/// Scale of the output, and the input that is still to come.
#[derive(Clone, Copy, Debug)]
pub struct Audience {
    /// Output (1.0 = full scale) that a bus step of the bank makes.
    #[cfg(feature = "counts")]
    pub(super) unit: f32,
    /// Level of one bus step, in steps of 3 dB.
    step: i16,
    /// Input in half octaves, [`NOTHING_TO_COME`] if none is to come.
    input_half_octaves: i16,
    /// Part of a contact's impulse that does not reach a mode of 2π f/fs = 1, in half octaves.
    corner_half_octaves: i16,
}

impl Audience {
    /// `unit` is the output (1.0 = full scale) that a bus step makes. `input` bounds the sum of
    /// |force| still to come, in bus steps. `contact_samples` is the length of the longest contact
    /// under way, of which modes far above its corner frequency get less; 0 counts them in full.
    pub fn new(unit: f32, input: f32, contact_samples: f32) -> Self {
        // A float's exponent and the first bit of its fraction count half octaves.
        let half_octaves = |x: f32| (x.to_bits() >> 22) as i16 - (127 << 1);
        Self {
            #[cfg(feature = "counts")]
            unit,
            step: half_octaves(unit) + FULL_SCALE,
            input_half_octaves: if input > 0.0 { half_octaves(input) } else { NOTHING_TO_COME },
            // The spectrum of a pulse of N samples falls as 1/(1 + (2 f N/fs)²), and (2 f N/fs)² =
            // θ² N²/π².
            corner_half_octaves: 2 * half_octaves(contact_samples).max(0) - 7,
        }
    }
}

/// All groups of an engine by loudness, and their cycles.
#[derive(Debug)]
pub struct ShedPlan {
    /// Number of groups of each level.
    groups: [u16; LEVELS],
    /// Cycles of the groups of each level.
    cycles: [u32; LEVELS],
    /// Number of groups that would run.
    running: u16,
    /// Number of levels from the lowest one of a group on. Most plans have groups at few levels.
    occupied: u8,
}

impl ShedPlan {
    /// A plan of no group yet.
    pub const EMPTY: Self = Self { groups: [0; LEVELS], cycles: [0; LEVELS], running: 0, occupied: 0 };

    /// Adds those groups of a bank that would run; `cycles_each` is the mean of their cycles.
    #[inline(never)] // few registers: the loop stays short
    pub(super) fn add(&mut self, groups: &[Group], audience: &Audience, used: Use, cycles_each: u32) {
        for group in groups.iter().filter(|group| runs(group, used)) {
            let level = level(group, audience);
            self.occupied = self.occupied.max(LEVELS as u8 - level);
            let at = usize::from(level);
            if let (Some(groups), Some(cycles)) = (self.groups.get_mut(at), self.cycles.get_mut(at)) {
                *groups += 1;
                *cycles += cycles_each;
                self.running += 1;
            }
        }
    }

    /// Cycles, groups and number of each level from the lowest one of a group on.
    #[inline(always)]
    fn levels(&self) -> impl Iterator<Item = (u32, u32, u8)> {
        let lowest = LEVELS as u8 - self.occupied;
        let from = usize::from(lowest)..;
        let of_level = |((&cycles, &groups), level)| (cycles, u32::from(groups), level);
        let cycles = self.cycles.get(from.clone()).unwrap_or(&[]);
        cycles.iter().zip(self.groups.get(from).unwrap_or(&[])).zip(lowest..).map(of_level)
    }

    /// Choice of the quietest groups that must go to free `excess` cycles, and their cycles. The
    /// loudest one stays, even if its cycles are missing, because a strike without it would be
    /// silent. A tick keeps time free that they come from (`cargo test -p virtual-board --test
    /// boards load`).
    pub fn quietest_that_free(&self, excess: u32) -> (ShedChoice, u32) {
        let (mut left, mut freed) = (u32::from(self.running.saturating_sub(1)), 0);
        for (cycles, groups, threshold) in self.levels() {
            if freed + cycles >= excess || groups > left {
                let each = cycles / groups.max(1);
                // Of the level in which the excess ends, as many as suffice if the cheapest go
                // first: a single mode costs a third of a full group's share.
                let share = (excess - freed).div_ceil(each.max(1));
                let at_threshold = (share + share / 2 + 1).min(groups).min(left);
                return (ShedChoice { threshold, at_threshold }, freed + each * at_threshold);
            }
            (left, freed) = (left - groups, freed + cycles);
        }
        (ShedChoice::ALL, freed)
    }

    /// Choice of the `count` quietest groups.
    pub fn quietest(&self, count: u16) -> ShedChoice {
        let mut left = u32::from(count);
        for (_, groups, threshold) in self.levels() {
            if groups > left {
                return ShedChoice { threshold, at_threshold: left };
            }
            left -= groups;
        }
        ShedChoice::ALL
    }
}

/// Choice of the groups that are left out.
#[derive(Debug, PartialEq, Eq)]
pub struct ShedChoice {
    /// Level below which all groups go.
    threshold: u8,
    /// Number of groups at that level that still go, in the order of the banks.
    at_threshold: u32,
}

impl ShedChoice {
    /// Choice of all groups.
    pub const ALL: Self = Self { threshold: LEVELS as u8, at_threshold: 0 };

    /// True if a group is chosen that would run.
    #[inline(always)]
    pub(super) fn takes(&mut self, group: &Group, audience: &Audience) -> bool {
        let level = level(group, audience);
        let is_last = level == self.threshold && self.at_threshold > 0;
        self.at_threshold -= u32::from(is_last);
        level < self.threshold || is_last
    }
}

/// True if a group would run.
#[inline(always)]
pub(super) fn runs(group: &Group, used: Use) -> bool {
    group.ringing()
        || match used {
            Use::Free => false,
            Use::Driven => !group.is_shed(),
            Use::Struck => true,
        }
}

/// Half a bound of the amplitude of a mode of the group, ringing and input still to come, in bus
/// steps.
#[cfg(feature = "counts")]
pub(super) fn bound(group: &Group, audience: &Audience) -> f32 {
    // Powers of two within a factor of two of the truth, which `shed` makes up for.
    let of_half_octaves = |half_octaves: i32| f32::from_bits((((half_octaves >> 1) + 127).max(0) as u32) << 23);
    // One more for the loss of both factors when they are rounded down.
    let coming = of_half_octaves(group.gain_half_octaves() + i32::from(audience.input_half_octaves) + 2);
    if group.ringing() { coming + of_half_octaves(group.ringing_half_octaves()) } else { coming }
}

/// Loudness in steps of 3 dB: that of the ringing or of the input to come, whichever is louder.
/// Of a contact's impulse the first mode decides how much reaches the group.
#[inline(always)]
fn level(group: &Group, audience: &Audience) -> u8 {
    let lost = (group.angle_quarter_octaves() + i32::from(audience.corner_half_octaves)).max(0);
    let coming = group.gain_half_octaves() + i32::from(audience.input_half_octaves) - lost;
    let loudest = if group.ringing() { coming.max(group.ringing_half_octaves()) } else { coming };
    (loudest + i32::from(audience.step)).clamp(0, LEVELS as i32 - 1) as u8
}
