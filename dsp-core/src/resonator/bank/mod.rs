//! The modal bank: `y[n] = (1/fs) Σ F[m] h[n-m]`, `h[n] = r^n (gs sin nθ + gc cos nθ)`, the first sample of h at half weight.

mod guard;
mod hand;
mod load;
mod position;
mod render;
mod shed;

pub use self::position::Place;
pub use hand::MODES_PER_TICK as HAND_MODES_PER_TICK;
pub use render::MixShift;
pub(super) use shed::half_octaves;
pub use shed::{Audience, Selection, Shed, Survey, UpcomingRun, Use};

use self::hand::HandState;
use self::position::Second;
use super::coefficient::Coefficients;
use super::group::Group;
use super::mode::Mode;
use super::retirement::Retired;
use crate::fixed::Scale;
use crate::table::layout::{GainRecord, ModeRecord};

/// What a bank needs for a hand and for new positions; only banks that can be choked or have several positions keep it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin {
    /// The mode's coefficients that are not in use: those under a hand, or, while one lies there, those without.
    other: Coefficients,
    /// By which share of itself the hand makes a coupled form's u larger, Q32; 0 where it is too large for its inverse to be quick.
    share: i32,
    /// The mode's index in the table, [`Origin::HELD`] and [`Origin::COUPLED`].
    index_and_flags: u16,
    /// Where among the bank's modes that mode lies which has this origin's place in the order of the table.
    slot: u16,
}

impl Origin {
    /// Fills memory before a kit is loaded.
    pub const NONE: Self = Self { other: Coefficients { delta: 0, epsilon: 0 }, share: 0, index_and_flags: 0, slot: 0 };
}

/// The modes of a table, as a bank is loaded from them.
#[derive(Clone, Copy, Debug)]
pub struct BankTable<'a> {
    /// Poles.
    pub modes: &'a [ModeRecord],
    /// Gains: all positions of the first mode, then of the second ...
    pub gains: &'a [GainRecord],
    /// Number of positions, at least 1.
    pub positions: usize,
    /// All gains are multiplied by this: reference force, and η for a striker.
    pub weight: f64,
    /// T60 in seconds of its choke, or 0.
    pub choke_t60_s: f64,
    /// True if the force itself takes away the modes' static response (`acceleration = "balance"`), beside half of `h[0]`.
    pub is_balanced: bool,
    /// A typical contact, (impulse in bus units of force times seconds, contact time in s): it decides the order of modes, not their sound.
    pub typical_contact: (f32, f32),
}

/// Why a bank cannot be loaded.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BankError {
    /// A mode decays faster than [`super::max_decay_per_s`] at this rate.
    DecayTooFast {
        /// Which mode of the table.
        mode: usize,
        /// Its decay in 1/s.
        decay_per_s: f32,
    },
    /// Gains times reference force times weight are beyond what the fixed-point form holds (2^14 times the rate).
    GainTooLarge,
}

/// Number of slices' items that a bank takes from lent memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BankSize {
    /// Modes below Nyquist.
    pub modes: usize,
    /// Register groups: a sixth of the modes, and up to six more.
    pub groups: usize,
    /// Modes with an [`Origin`]: all of a bank that can be choked or has several positions, or none.
    pub origins: usize,
}

/// What a bank did over a run of frames, in modes (times the frames of the run for the work).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BankWork {
    /// Modes that ran with input, times frames.
    pub driven_mode_frames: u32,
    /// Modes that rang freely, times frames.
    pub free_mode_frames: u32,
    /// Guards beyond the one a tick, because a force outgrew its allowance.
    pub extra_guards: u32,
    /// Runs of a group whose input was refused for want of room.
    pub refused: u32,
}

impl core::ops::AddAssign for BankWork {
    fn add_assign(&mut self, other: Self) {
        self.driven_mode_frames += other.driven_mode_frames;
        self.free_mode_frames += other.free_mode_frames;
        self.extra_guards += other.extra_guards;
        self.refused += other.refused;
    }
}

/// A bank of modes in fixed point.
///
/// Accuracy of a mode against the `f64` reference: 100 dB and better (`cargo test -p host-tests --test stages long_tails`).
#[derive(Debug)]
pub struct Bank<'m> {
    modes: &'m mut [Mode],
    groups: &'m mut [Group],
    origins: &'m mut [Origin],
    /// How many of its modes and of its groups run plain; the others, mirrored, come behind.
    plain_modes: u16,
    plain_groups: u16,
    /// Factor of the force that is added to the sound: minus the half of h[0] that does not belong to the integral, or in
    /// a balanced bank minus the static response as well. That of the free modes, choked or not.
    onset: Scale,
    hand: HandState,
    /// Whether the allowance is enough for all contacts under way.
    is_covered: bool,
    /// The position of slot 0, whose gains are the modes' own; and slot 1.
    position: f32,
    second: Second<'m>,
    /// |force| that the groups are still guarded for.
    allowance: u64,
    /// The |force| since the last tick.
    spent: u64,
    /// Bits by which the force is shifted left before it drives the modes, so that a weak one keeps its precision.
    force_shift: u8,
    mix_shift: MixShift,
    /// The sum of the modes' bounds stays below 2^this on the bus.
    mix_bits: u8,
    /// Groups that refused the input they were last guarded for.
    refusing: u16,
    ringing_modes: u16,
    /// Ticks without input, modulo 256: what groups are due by.
    clock: u8,
    /// Such ticks until some group's next guard.
    due_ticks: u8,
    /// Most groups that a tick without input guards.
    guards_per_tick: u8,
    retired: Retired,
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
            hand: HandState::NONE,
            is_covered: false,
            position: 0.0,
            second: Second::none(),
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
fn for_each_group(modes: &mut [Mode], groups: &mut [Group], mut visit: impl FnMut(&mut Group, &mut [Mode])) {
    let mut rest = modes;
    for group in groups {
        let Some((modes, behind)) = rest.split_at_mut_checked(group.count()) else { return };
        visit(group, modes);
        rest = behind;
    }
}
