//! Bookkeeping of a bank: guards, retirement, the mix exponent.
//!
//! | when | guarded |
//! | --- | --- |
//! | a contact begins | all groups, for the whole contact |
//! | a tick after other input X, unless 2X to 64X of the allowance is left | all ringing, for 16X |
//! | the first tick after one without input, or the second after a contact | all ringing fall due |
//! | then | each when its fastest mode has lost half a bit, at the latest after 64 ticks |
//!
//! A free orbit never outgrows its guard ([`super::super::headroom`]), so that guards without input
//! serve precision and retirement alone: an exponent that lags by half a bit costs nothing that can
//! be measured. So they are spread over ticks: no tick guards more groups than
//! [`Bank::guards_per_tick`], about three more than fall due in it on average.

use super::super::group::{Group, MAX_GUARD_TICKS};
use super::super::retirement::{Retired, Retirement};
use super::mix::MixShift;
use super::state::{Bank, for_each_group};

/// Largest sum of |force| of a tick: 32 frames of 2^31.
pub(super) const MAX_ALLOWANCE: u64 = 32 << 31;

impl Bank<'_> {
    /// Does a tick's bookkeeping: exponents follow the sound down, and inaudible modes retire.
    ///
    /// `retirement` is `None` if nothing may be skipped.
    pub fn tick(&mut self, retirement: Option<&mut Retirement>) {
        self.retired.decay();
        // The next input is expected to be at most twice the last one; if it is more, `render`
        // guards again.
        let expected = core::mem::take(&mut self.spent).saturating_mul(2);
        if self.ringing_modes == 0 {
            self.allowance = 0;
            return;
        }
        if expected > 0 {
            if !self.is_covered && !self.allows(expected) {
                self.guard((8 * expected).min(MAX_ALLOWANCE), false);
            }
            return;
        }
        if self.is_covered {
            // A contact may begin with zeros: one tick without force is not its end.
            self.is_covered = false;
            return;
        }
        // Exponents that were lowered for a loud input cost the mix its last bits: they are raised
        // at once.
        let all = core::mem::take(&mut self.allowance) > 0 && self.mix_shift.bits > 0;
        self.clock = self.clock.wrapping_add(1);
        self.due_ticks = self.due_ticks.saturating_sub(1);
        self.choke.pass(1);
        if self.due_ticks == 0 {
            self.guard_due(retirement, if all { u8::MAX } else { self.most_guards() });
        }
    }

    /// Maximum number of groups that a tick guards: under a hand they fall due more often.
    fn most_guards(&self) -> u8 {
        let groups = self.groups.len();
        let longest = usize::from(self.choke.longest_guard_ticks().max(1));
        let held = if self.choke.lies { groups / longest + groups / 16 + 3 } else { 0 };
        self.guards_per_tick.max(held.min(usize::from(u8::MAX)) as u8)
    }

    /// Guards all groups for the whole contact that begins, whose |force| sums up to `input`. So
    /// its force, however it rises, is not cut into runs, and the ticks in between have no work.
    pub fn expect(&mut self, input: u64) {
        let wanted = self.allowance.saturating_add(input);
        self.guard(wanted.min(MAX_ALLOWANCE), true);
        self.is_covered = wanted <= MAX_ALLOWANCE;
    }

    /// Guards all groups for a force that goes on, whose |force| sums up to `input` in the tick
    /// that begins: for 16 such ticks. The allowance of impacts under way stays.
    pub fn expect_ongoing(&mut self, input: u64) {
        let wanted = input.saturating_mul(16).max(self.allowance);
        self.guard(wanted.min(MAX_ALLOWANCE), true);
    }

    /// True if any input is allowed.
    pub fn has_allowance(&self) -> bool {
        self.allowance > 0
    }

    /// True if the allowance does not suffice for an input.
    pub fn lacks(&self, input: u64) -> bool {
        self.allowance < input
    }

    /// True if the next tick guards all ringing groups for a force that goes on.
    pub fn is_driven_guard_due(&self) -> bool {
        let is_driven = self.ringing_modes > 0 && self.spent > 0 && !self.is_covered;
        is_driven && !self.allows(self.spent.saturating_mul(2))
    }

    /// Ends the sound of all modes at once. A hand stays.
    pub fn rest(&mut self) {
        for_each_group(self.modes, self.groups, |group, modes| group.silence(modes));
        (self.allowance, self.spent, self.is_covered, self.retired) = (0, 0, false, Retired::NOTHING);
        self.prepare();
    }

    /// True if the rest of the allowance suffices for an input, without being so large that
    /// precision is wasted.
    #[inline(always)]
    fn allows(&self, expected: u64) -> bool {
        (expected..=32 * expected).contains(&self.allowance)
    }

    /// Number of coming ticks in which the bank has no work if it gets no input. The caller may
    /// count them and call [`Bank::pass`] later.
    pub fn rest_ticks(&self) -> u8 {
        if self.spent > 0 || self.allowance > 0 || self.is_covered || self.is_being_reached() {
            return 0;
        }
        match self.ringing_modes {
            0 if self.retired.amplitude() == 0.0 => u8::MAX,
            // The missing sound decays, which a caller that waits for silence wants to know.
            0 => MAX_GUARD_TICKS as u8,
            _ => self.due_ticks.saturating_sub(1),
        }
    }

    /// Lets ticks pass, at most [`Bank::rest_ticks`].
    pub fn pass(&mut self, ticks: u8) {
        if self.retired.amplitude() > 0.0 {
            (0..ticks).for_each(|_| self.retired.decay());
        }
        if self.ringing_modes > 0 {
            self.clock = self.clock.wrapping_add(ticks);
            self.due_ticks = self.due_ticks.saturating_sub(ticks);
            self.choke.pass(ticks);
        }
    }

    /// True if the next tick guards any group, without more input before it. `passed` are ticks
    /// that the bank has not been told of.
    pub fn is_guard_due(&self, passed: u8) -> bool {
        self.ringing_modes > 0
            && match (self.spent, self.allowance) {
                (0, 0) => self.due_ticks <= 1 + passed,
                (0, _) => !self.is_covered,
                (spent, _) => !self.is_covered && !self.allows(spent.saturating_mul(2)),
            }
    }

    /// Guards all groups for an allowance of |force|, or without `all` only the groups that ring.
    #[inline(never)]
    pub(super) fn guard(&mut self, allowance: u64, all: bool) {
        // No single force can exceed the allowance for their sum.
        let force_shift = allowance.leading_zeros().saturating_sub(33);
        let (clock, longest) = (self.clock, self.choke.longest_guard_ticks());
        for_each_group(self.modes, self.groups, |group, modes| {
            if group.ringing() || all && !group.is_shed() {
                group.guard(modes, allowance, force_shift);
                group.schedule(clock, allowance > 0, longest);
            }
        });
        self.choke.meet_guard(self.is_being_reached());
        self.force_shift = force_shift as u8; // at most 31
        self.allowance = allowance;
        self.prepare();
    }

    /// Guards groups that are due, at most `at_most`.
    #[inline(never)]
    fn guard_due(&mut self, mut retirement: Option<&mut Retirement>, at_most: u8) {
        let (clock, mix, longest) = (self.clock, self.mix_shift, self.choke.longest_guard_ticks());
        let (mut left, mut due_ticks) = (at_most, i8::MAX);
        // While the sum of the groups' bounds is small enough, the exponent of one group does not
        // concern the others.
        let mut is_settled = mix.bits == 0 && !mix.is_loud;
        let retired = &mut self.retired;
        for_each_group(self.modes, self.groups, |group, modes| {
            if !group.ringing() {
                return;
            }
            group.hasten(clock, longest);
            if group.due_ticks(clock) <= 0 && left > 0 {
                left -= 1;
                let (exponent, unit) = (group.exponent(), group.unit());
                let largest_v = group.follow(modes) as f32 * unit;
                if let Some(retirement) = retirement.as_mut().filter(|retirement| retirement.is_below(largest_v)) {
                    retirement.consider(group, modes, retired);
                }
                // The bound of a free orbit holds for ever: only a new bound, or its end, changes
                // the sum.
                is_settled &= group.ringing() && group.exponent() >= exponent;
                group.scale_mix(0);
                group.schedule(clock, false, longest);
            }
            due_ticks = due_ticks.min(group.due_ticks(clock));
        });
        self.due_ticks = due_ticks.max(0) as u8;
        if !is_settled {
            self.prepare();
        }
    }

    /// Guards all ringing groups, where there is no input.
    pub(super) fn guard_all_at_rest(&mut self) {
        let (clock, longest) = (self.clock, self.choke.longest_guard_ticks());
        for_each_group(self.modes, self.groups, |group, modes| {
            if group.ringing() {
                group.follow(modes);
                group.schedule(clock, false, longest);
            }
        });
        self.choke.meet_guard(self.is_being_reached());
        self.prepare();
    }

    /// Derives the number of groups that a tick may guard, from the intervals that they need. After
    /// load.
    pub(super) fn count_guards(&mut self) {
        let groups = &self.groups;
        let due: u32 = groups.iter().map(Group::guards_in_longest_interval).sum();
        // Guards that fall due on average, one sixteenth of all groups, so that none is late by
        // more than 16 ticks, and two, because each call looks at all groups.
        let guards = (due + groups.len() as u32 * MAX_GUARD_TICKS / 16) / MAX_GUARD_TICKS + 2;
        self.guards_per_tick = guards.min(u32::from(u8::MAX)) as u8;
    }

    /// Finds the mix exponent for the groups' bounds and brings their plans up to date.
    #[inline(never)]
    pub(super) fn prepare(&mut self) {
        let groups = &mut *self.groups;
        let (mut sum, mut mix_exponent, mut ringing_modes, mut refusing, mut due_ticks) = (0u64, 0, 0, 0, i8::MAX);
        self.costs.none_rings();
        for group in groups.iter().filter(|group| group.ringing()) {
            self.costs.rings(group);
            sum = sum.saturating_add(group.mix_bound());
            mix_exponent = mix_exponent.max(group.smallest_mix_exponent());
            ringing_modes += group.count();
            refusing += u16::from(group.refusing());
            due_ticks = due_ticks.min(group.due_ticks(self.clock));
        }
        // sum < 2^bits: shifted right by bits - 31 it stays below 2^31.
        let bits = 64 - sum.leading_zeros() as i32;
        let mix_exponent = mix_exponent.max(bits - 31).max(0);
        self.mix_shift = MixShift { bits: mix_exponent as u8, is_loud: bits > 30 }; // at most 33 bits
        self.mix_bits = bits as u8; // at most 64
        (self.ringing_modes, self.refusing) = (ringing_modes as u16, refusing);
        self.due_ticks = due_ticks.max(0) as u8;
        let force_shift = u32::from(self.force_shift);
        groups.iter_mut().for_each(|group: &mut Group| group.prepare(mix_exponent, force_shift));
    }
}
