//! The bookkeeping of a bank: guards, retirement, the mix exponent.
//!
//! | when | what |
//! | --- | --- |
//! | a contact begins | all groups are guarded for the whole of it |
//! | a tick after other input, if what is left of the allowance is less than twice that input, or 32 times more | all ringing groups are guarded for four times that input |
//! | the first tick after a tick without, or the second after a contact | all ringing groups are guarded for none |
//! | later | each group when its fastest mode has decayed by a quarter of a bit, at the latest after 32 ticks |
//!
//! A free orbit never outgrows its guard ([`super::super::headroom`]), so that guards without input serve precision and retirement
//! alone: an exponent that lags by a quarter of a bit costs nothing that can be measured.

use super::super::group::{Group, Guard};
use super::super::retirement::Retirement;
use super::{Bank, Memory, MixShift, for_each_group};

/// The most that can come in a tick: 32 frames of 2^31.
pub(super) const MAX_ALLOWANCE: u64 = 32 << 31;

impl Bank {
    /// The bookkeeping of a tick: exponents follow the sound down, modes that have become inaudible retire.
    ///
    /// `retirement` is `None` where nothing may be skipped.
    pub fn tick(&mut self, memory: &mut Memory<'_>, retirement: Option<&mut Retirement>) {
        self.retired.decay();
        // What comes is expected to be at most twice what came; if it is more, `render` guards again.
        let expected = self.spent.saturating_mul(2);
        self.spent = 0;
        if self.ringing_modes == 0 {
            self.allowance = 0;
        } else if expected > 0 {
            if !self.is_covered && !self.allows(expected) {
                self.guard(memory, (2 * expected).min(MAX_ALLOWANCE), false);
            }
        } else if self.is_covered {
            // A contact may begin with zeros: one tick without force is not its end.
            self.is_covered = false;
        } else if self.allowance > 0 {
            // The force is over.
            (self.allowance, self.force_shift) = (0, 0);
            self.guard_due(memory, retirement, true);
        } else {
            self.passed_ticks += 1;
            if self.passed_ticks >= self.due_ticks {
                self.guard_due(memory, retirement, false);
            }
        }
    }

    /// Guards all groups for the whole contact that begins, which brings a sum of |force| of `input`. So its force, however it rises, is not
    /// cut into runs, and the ticks in between have nothing to do.
    pub fn expect(&mut self, memory: &mut Memory<'_>, input: u64) {
        let wanted = self.allowance.saturating_add(input);
        self.guard(memory, wanted.min(MAX_ALLOWANCE), true);
        self.is_covered = wanted <= MAX_ALLOWANCE;
    }

    /// Whether the allowance left is enough for an input, and not so much that precision would be wasted.
    fn allows(&self, expected: u64) -> bool {
        (expected..=32 * expected).contains(&self.allowance)
    }

    /// Whether the next tick guards any group, if no more input comes before it.
    pub fn is_guard_due(&self) -> bool {
        self.ringing_modes > 0
            && match (self.spent, self.allowance) {
                (0, 0) => self.passed_ticks + 1 >= self.due_ticks,
                (0, _) => !self.is_covered,
                (spent, _) => !self.is_covered && !self.allows(spent.saturating_mul(2)),
            }
    }

    /// Guards all groups for an allowance of |force|. `all` includes groups at rest.
    pub(super) fn guard(&mut self, memory: &mut Memory<'_>, allowance: u64, all: bool) {
        // No single force can exceed the allowance for their sum.
        let force_shift = allowance.leading_zeros().saturating_sub(33);
        for_each_group(self.modes, self.groups, memory.modes, memory.groups, |group, modes| {
            if group.ringing() || all && !group.is_shed() {
                let _: Guard = group.guard(modes, allowance, force_shift);
            }
        });
        self.force_shift = force_shift as u8; // at most 31
        self.allowance = allowance;
        self.prepare(memory);
    }

    /// Guards the groups whose time has come, or all that ring, for no input.
    fn guard_due(&mut self, memory: &mut Memory<'_>, mut retirement: Option<&mut Retirement>, all: bool) {
        let passed = self.passed_ticks;
        let retired = &mut self.retired;
        for_each_group(self.modes, self.groups, memory.modes, memory.groups, |group, modes| {
            if !group.ringing() || !(group.is_due(passed) || all) {
                return;
            }
            let unit = group.unit();
            let largest_v = group.follow(modes) as f32 * unit;
            if let Some(retirement) = retirement.as_mut().filter(|retirement| retirement.is_below(largest_v)) {
                retirement.consider(group, modes, retired);
            }
        });
        self.prepare(memory);
    }

    /// Finds the mix exponent for the groups' bounds and brings their plans up to date.
    pub(super) fn prepare(&mut self, memory: &mut Memory<'_>) {
        let groups = memory.groups.get_mut(self.groups.range()).unwrap_or(&mut []);
        let (mut sum, mut mix_exponent, mut ringing_modes, mut refusing, mut due_ticks) = (0u64, 0, 0, 0, u8::MAX);
        for group in groups.iter().filter(|group| group.ringing()) {
            sum = sum.saturating_add(group.mix_bound());
            mix_exponent = mix_exponent.max(group.smallest_mix_exponent());
            ringing_modes += group.count();
            refusing += u16::from(group.refusing());
            due_ticks = due_ticks.min(group.due_ticks());
        }
        // sum < 2^bits: shifted right by bits - 31 it stays below 2^31.
        let bits = 64 - sum.leading_zeros() as i32;
        let mix_exponent = mix_exponent.max(bits - 31).max(0);
        self.mix_shift = MixShift { bits: mix_exponent as u8, is_loud: bits > 30 }; // at most 33 bits
        (self.ringing_modes, self.refusing) = (ringing_modes as u16, refusing);
        (self.due_ticks, self.passed_ticks) = (due_ticks, 0);
        let force_shift = u32::from(self.force_shift);
        groups.iter_mut().for_each(|group: &mut Group| group.prepare(mix_exponent, force_shift));
    }
}
