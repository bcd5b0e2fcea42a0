//! A bank: its memory, its state, and what can be read of it.

use super::super::group::Group;
use super::super::mode::Mode;
use super::super::retirement::Retired;
use super::choke::ChokeState;
use super::mix::MixShift;
use super::origin::Origin;
use super::slot::SecondSlot;
use crate::fixed::Scale;

/// A bank of modes in fixed point.
///
/// Accuracy of a mode against the `f64` reference: 100 dB and better (`cargo test -p host-tests --test stages long_tails`).
#[derive(Debug)]
pub struct Bank<'m> {
    pub(super) modes: &'m mut [Mode],
    pub(super) groups: &'m mut [Group],
    pub(super) origins: &'m mut [Origin],
    /// How many of its modes and of its groups run plain; the others, mirrored, come behind.
    pub(super) plain_modes: u16,
    pub(super) plain_groups: u16,
    /// Factor of the force that is added to the sound: minus the half of h[0] that does not belong to the integral, or in
    /// a balanced bank minus the static response as well. That of the free modes, choked or not.
    pub(super) onset: Scale,
    pub(super) choke: ChokeState,
    /// Whether the allowance is enough for all contacts under way.
    pub(super) is_covered: bool,
    /// The position of slot 0, whose gains are the modes' own; and slot 1.
    pub(super) position: f32,
    pub(super) second: SecondSlot<'m>,
    /// |force| that the groups are still guarded for.
    pub(super) allowance: u64,
    /// The |force| since the last tick.
    pub(super) spent: u64,
    /// Bits by which the force is shifted left before it drives the modes, so that a weak one keeps its precision.
    pub(super) force_shift: u8,
    pub(super) mix_shift: MixShift,
    /// The sum of the modes' bounds stays below 2^this on the bus.
    pub(super) mix_bits: u8,
    /// Groups that refused the input they were last guarded for.
    pub(super) refusing: u16,
    pub(super) ringing_modes: u16,
    /// Ticks without input, modulo 256: what groups are due by.
    pub(super) clock: u8,
    /// Such ticks until some group's next guard.
    pub(super) due_ticks: u8,
    /// Most groups that a tick without input guards.
    pub(super) guards_per_tick: u8,
    pub(super) retired: Retired,
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
        }
    }

    /// The modes, in groups.
    pub fn modes(&self) -> &[Mode] {
        self.modes
    }

    /// The register groups.
    pub fn groups(&self) -> &[Group] {
        self.groups
    }

    /// Number of modes that it renders.
    pub fn mode_count(&self) -> usize {
        self.modes.len()
    }

    /// Whether anything rings.
    #[inline(always)]
    pub fn is_ringing(&self) -> bool {
        self.ringing_modes > 0
    }

    /// Modes that ring, those that share a group with one included.
    pub fn ringing_modes(&self) -> u32 {
        u32::from(self.ringing_modes)
    }

    /// Sum of the amplitudes that have been retired and may still be missing, in output units (1.0 = full scale).
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
