//! A bank's memory and state.

use super::super::group::Group;
use super::super::mode::Mode;
use super::super::retirement::Retired;
use super::choke::ChokeState;
use super::mix::MixShift;
use super::origin::Origin;
use super::run_cost::BankCosts;
use super::slot::SecondSlot;
use crate::fixed::Scale;

/// A bank of modes in fixed point.
///
/// Accuracy of a mode against the `f64` reference: 100 dB and better
/// (`cargo test -p host-tests --test stages long_tails`).
#[derive(Debug)]
pub struct Bank<'m> {
    pub(super) modes: &'m mut [Mode],
    pub(super) groups: &'m mut [Group],
    pub(super) origins: &'m mut [Origin],
    /// Numbers of modes and groups that run plain; the others, mirrored, come behind.
    pub(super) plain_modes: u16,
    pub(super) plain_groups: u16,
    /// Factor of the force that is added to the sound: minus the half of `h[0]` that does not
    /// belong to the integral, and in a balanced bank minus the static response. Derived from the
    /// free modes, under a hand too.
    pub(super) onset: Scale,
    pub(super) choke: ChokeState,
    /// True if the allowance suffices for all contacts under way.
    pub(super) is_covered: bool,
    /// Position of slot 0, whose gains are the modes' own; and slot 1.
    pub(super) position: f32,
    pub(super) second: SecondSlot<'m>,
    /// Sum of |force| that the groups are still guarded for.
    pub(super) allowance: u64,
    /// Sum of |force| since the last tick.
    pub(super) spent: u64,
    /// Number of bits by which the force is shifted left before it drives the modes, so that a weak
    /// one keeps its precision.
    pub(super) force_shift: u8,
    pub(super) mix_shift: MixShift,
    /// Bits of the sum of the modes' bounds on the bus: it stays below 2^this.
    pub(super) mix_bits: u8,
    /// Number of groups that refused the input of their last guard.
    pub(super) refusing: u16,
    pub(super) ringing_modes: u16,
    /// Ticks without input, modulo 256: the clock of the groups' guards.
    pub(super) clock: u8,
    /// Ticks without input until some group's next guard.
    pub(super) due_ticks: u8,
    /// Maximum number of groups that a tick without input guards.
    pub(super) guards_per_tick: u8,
    pub(super) retired: Retired,
    /// Cycles of its runs, for the budget.
    pub(super) costs: BankCosts,
}

impl Bank<'_> {
    /// A bank without modes.
    pub const fn empty() -> Self {
        Self {
            modes: &mut [],
            groups: &mut [],
            origins: &mut [],
            plain_modes: 0,
            plain_groups: 0,
            onset: Scale::ZERO,
            choke: ChokeState::NONE,
            is_covered: false,
            position: 0.0,
            second: SecondSlot::none(),
            allowance: 0,
            spent: 0,
            force_shift: 0,
            mix_shift: MixShift { bits: 0, is_loud: false },
            mix_bits: 0,
            refusing: 0,
            ringing_modes: 0,
            clock: 0,
            due_ticks: 0,
            guards_per_tick: 0,
            retired: Retired::NOTHING,
            costs: BankCosts::NONE,
        }
    }

    /// Modes, group by group.
    pub fn modes(&self) -> &[Mode] {
        self.modes
    }

    /// Register groups.
    pub fn groups(&self) -> &[Group] {
        self.groups
    }

    /// Number of modes, those at or above Nyquist left out.
    pub fn mode_count(&self) -> usize {
        self.modes.len()
    }

    /// True if any mode rings.
    #[inline(always)]
    pub fn is_ringing(&self) -> bool {
        self.ringing_modes > 0
    }

    /// Number of modes that ring, those that share a group with one included.
    pub fn ringing_modes(&self) -> u32 {
        u32::from(self.ringing_modes)
    }

    /// Sum of the amplitudes that have been retired and may still be missing, in output units (1.0
    /// = full scale).
    #[inline(always)]
    pub fn retired_amplitude(&self) -> f32 {
        self.retired.amplitude()
    }
}

/// Calls `visit` with each group and its modes.
pub(super) fn for_each_group(modes: &mut [Mode], groups: &mut [Group], mut visit: impl FnMut(&mut Group, &mut [Mode])) {
    let mut rest = modes;
    for group in groups {
        let Some((modes, behind)) = rest.split_at_mut_checked(group.count()) else { return };
        visit(group, modes);
        rest = behind;
    }
}
