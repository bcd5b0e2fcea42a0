//! The modal bank: `y[n] = (1/fs) Σ F[m] h[n-m]`, `h[n] = r^n (gs sin nθ + gc cos nθ)`, the first sample of h at half weight.

use core::ops::Range;

use super::TICK_FRAMES;
use super::coefficient::{Coefficients, delta_of_t60};
use super::gain::{check_gains, gain_at, gain_law, move_pole, onset, orbit_gains};
use super::group::{GROUP_MODES, Group, Guard};
use super::mode::Mode;
use super::order::{order_key, order_modes, pole_of};
use super::retirement::{Retired, Retirement};
use crate::SampleRate;
use crate::fixed::{self, Scale};
use crate::table::layout::{GainRecord, ModeRecord};

/// What a bank needs to find its way back after a choke or to a new position; only banks that can be choked or have several
/// positions keep it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin {
    /// The mode's coefficients as loaded.
    coefficients: Coefficients,
    /// The mode's index in the table.
    index: u16,
}

impl Origin {
    /// Fills memory before a kit is loaded.
    pub const NONE: Self = Self { coefficients: Coefficients { delta: 0, epsilon: 0 }, index: 0 };
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
    /// A typical contact, (impulse in bus units of force times seconds, contact time in s): it decides the order of modes, not their sound.
    pub typical_contact: (f32, f32),
}

/// Why a bank cannot be loaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BankError {
    /// More modes than the engine has room for.
    TooManyModes,
    /// More register groups than the engine has room for.
    TooManyGroups,
    /// More modes with positions or choke than the engine has room for.
    TooManyOrigins,
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

/// Memory in which banks live: each takes a contiguous part of each slice.
#[derive(Debug)]
pub struct Memory<'m> {
    /// Modes of all banks.
    pub modes: &'m mut [Mode],
    /// Register groups of all banks.
    pub groups: &'m mut [Group],
    /// Origins of all banks that keep them.
    pub origins: &'m mut [Origin],
}

/// How much of a [`Memory`] has been given away.
#[derive(Clone, Copy, Debug, Default)]
pub struct Used {
    /// Modes.
    pub modes: usize,
    /// Groups.
    pub groups: usize,
    /// Origins.
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
/// Accuracy against the `f64` reference: 96 dB and better (`cargo bench -p host-tests --bench accuracy`).
#[derive(Clone, Debug)]
pub struct Bank {
    modes: Range<usize>,
    groups: Range<usize>,
    origins: Range<usize>,
    /// The half of h[0] that does not belong to the integral: -Σ gc / (2 fs), times the force, is added to the sound.
    onset: Scale,
    choke_delta: i32,
    choked: bool,
    position: f32,
    /// What is left of the |force| for which the groups were guarded.
    allowance: u64,
    /// The |force| since the last tick.
    spent: u64,
    /// Bits by which the force is shifted left before it drives the modes, so that a weak one keeps its precision.
    force_shift: u32,
    /// Groups that refused the input they were last guarded for.
    refusing: u32,
    mix_exponent: i32,
    ringing: bool,
    retired: Retired,
}

impl Bank {
    /// A bank without modes.
    pub const EMPTY: Self = Self {
        modes: 0..0,
        groups: 0..0,
        origins: 0..0,
        onset: Scale::ZERO,
        choke_delta: 0,
        choked: false,
        position: 0.0,
        allowance: 0,
        spent: 0,
        force_shift: 0,
        refusing: 0,
        mix_exponent: 0,
        ringing: false,
        retired: Retired::NOTHING,
    };

    /// Derives a bank from a table for a sample rate and puts it behind what is `used`.
    ///
    /// Modes at or above Nyquist are left out. The others are ordered by form and, within a form, by how long a typical
    /// strike keeps them audible, so that modes that end together share a group.
    ///
    /// # Errors
    /// A [`BankError`]; the memory behind `used` is then unspecified, `used` unchanged.
    pub fn load(
        table: &BankTable<'_>,
        rate: SampleRate,
        memory: &mut Memory<'_>,
        used: &mut Used,
    ) -> Result<Self, BankError> {
        check_gains(table, rate)?;
        let keeps_origins = table.positions > 1 || table.choke_t60_s > 0.0;
        let modes = order_modes(table, rate, memory.modes, used.modes)?;
        let origins = used.origins..used.origins + if keeps_origins { modes.len() } else { 0 };
        if origins.end > memory.origins.len() {
            return Err(BankError::TooManyOrigins);
        }
        let mut bank = Self { origins, ..Self::EMPTY };
        let mut group_end = used.groups;
        let mut cosine_sum = 0.0;
        let mut start = modes.start;
        while let Some(first) = memory.modes.get(start).filter(|_| start < modes.end) {
            let key = order_key(first);
            let same = memory.modes.get(start..modes.end).unwrap_or(&[]).iter().take(GROUP_MODES);
            let count = same.take_while(|mode| order_key(mode) == key).count();
            let group_slot = memory.groups.get_mut(group_end).ok_or(BankError::TooManyGroups)?;
            let group_modes = memory.modes.get_mut(start..start + count).unwrap_or(&mut []);
            let mut indices = [0usize; GROUP_MODES];
            for (slot, (mode, index)) in group_modes.iter_mut().zip(&mut indices).enumerate() {
                *index = mode.state.u as usize;
                let pole =
                    table.modes.get(*index).and_then(|record| pole_of(record, rate)).ok_or(BankError::TooManyModes)?;
                *mode = Mode { coefficients: pole.coefficients, ..Mode::SILENT };
                cosine_sum += f64::from(gain_at(table.gains, table.positions, *index, 0.0).1);
                if slot == 0 {
                    *group_slot = Group::new(pole.form, pole.mirrored, count as u8);
                }
                if keeps_origins {
                    let origin = bank.origins.start + start - modes.start + slot;
                    if let Some(origin) = memory.origins.get_mut(origin) {
                        *origin = Origin { coefficients: pole.coefficients, index: *index as u16 };
                    }
                }
            }
            let gain = gain_law(table, rate, 0.0);
            let gains = orbit_gains(group_slot, |slot| gain(indices.get(slot).copied()));
            group_slot.set_gains(group_modes, gains);
            start += count;
            group_end += 1;
        }
        bank.groups = used.groups..group_end;
        bank.modes = modes;
        bank.onset = onset(cosine_sum, table, rate);
        if table.choke_t60_s > 0.0 {
            bank.choke_delta = delta_of_t60(table.choke_t60_s, rate);
        }
        *used = Used { modes: bank.modes.end, groups: bank.groups.end, origins: bank.origins.end };
        Ok(bank)
    }

    /// Number of modes that it renders.
    pub fn mode_count(&self) -> usize {
        self.modes.len()
    }

    /// Whether anything rings.
    pub fn is_ringing(&self) -> bool {
        self.ringing
    }

    /// Sum of the amplitudes that have been retired and may still be missing, in output units (1.0 = full scale).
    pub fn retired_amplitude(&self) -> f32 {
        self.retired.amplitude()
    }

    /// Moves the striking point for the contacts that follow: gains are interpolated between the table's positions.
    ///
    /// About 300 cycles a mode on a Cortex-M4F where the table has several positions; nothing otherwise.
    pub fn set_position(&mut self, position: f32, table: &BankTable<'_>, rate: SampleRate, memory: &mut Memory<'_>) {
        if table.positions > 1 && position != self.position {
            self.position = position;
            self.derive_gains(table, rate, memory);
        }
    }

    /// Raises the decay of every mode to the choke's, or lets go again. The sound goes on without a step.
    pub fn set_choked(&mut self, choked: bool, table: &BankTable<'_>, rate: SampleRate, memory: &mut Memory<'_>) {
        if self.choke_delta == 0 || choked == self.choked {
            return;
        }
        self.choked = choked;
        let choke_delta = self.choke_delta;
        let origins = memory.origins.get(self.origins.clone()).unwrap_or(&[]);
        let mut origins = origins.iter();
        for_each_group(&self.modes, &self.groups, memory.modes, memory.groups, |group, modes| {
            // A moved pole may have a larger u for the same sound.
            group.make_room(modes);
            for (mode, origin) in modes.iter_mut().zip(origins.by_ref()) {
                let rest = origin.coefficients;
                let target = if choked { rest.choked(group.form(), choke_delta) } else { rest };
                move_pole(group, mode, target);
            }
        });
        self.derive_gains(table, rate, memory);
        self.guard(memory, 0, false);
    }

    fn derive_gains(&mut self, table: &BankTable<'_>, rate: SampleRate, memory: &mut Memory<'_>) {
        let origins = memory.origins.get(self.origins.clone()).unwrap_or(&[]);
        let gain = gain_law(table, rate, self.position);
        let mut first = 0;
        for_each_group(&self.modes, &self.groups, memory.modes, memory.groups, |group, modes| {
            let index = |slot: usize| origins.get(first + slot).map(|origin| usize::from(origin.index));
            let gains = orbit_gains(group, |slot| gain(index(slot)));
            group.set_gains(modes, gains);
            first += modes.len();
        });
        let cosines = origins
            .iter()
            .map(|origin| f64::from(gain_at(table.gains, table.positions, usize::from(origin.index), self.position).1));
        self.onset = onset(cosines.sum(), table, rate);
        // New gains need new guards.
        self.allowance = 0;
    }

    /// The bookkeeping of a tick: exponents follow the sound down, modes that have become inaudible retire.
    ///
    /// `retirement` is `None` where nothing may be skipped.
    pub fn tick(&mut self, memory: &mut Memory<'_>, retirement: Option<&mut Retirement>) {
        self.retired.decay();
        if !self.ringing {
            self.spent = 0;
            self.allowance = 0;
            return;
        }
        // What comes is expected to be at most twice what came; if it is more, `render` guards again.
        let expected = self.spent.saturating_mul(2);
        if let (0, Some(retirement)) = (expected, retirement) {
            let retired = &mut self.retired;
            for_each_group(&self.modes, &self.groups, memory.modes, memory.groups, |group, modes| {
                retirement.consider(group, modes, retired);
            });
        }
        self.spent = 0;
        self.guard(memory, expected, false);
    }

    /// Guards all groups for an allowance of |force|. `all` includes groups at rest.
    fn guard(&mut self, memory: &mut Memory<'_>, allowance: u64, all: bool) {
        let mut refused = 0;
        let mut sum = 0u64;
        let mut mix_exponent = 0;
        let mut ringing = false;
        // No single force can exceed the allowance for their sum.
        let force_shift = allowance.leading_zeros().saturating_sub(33);
        for_each_group(&self.modes, &self.groups, memory.modes, memory.groups, |group, modes| {
            if group.ringing() || all {
                refused += u32::from(group.guard(modes, allowance, force_shift) == Guard::Refused);
            }
            if group.ringing() {
                ringing = true;
                sum = sum.saturating_add(group.mix_bound());
                mix_exponent = mix_exponent.max(group.smallest_mix_exponent());
            }
        });
        // sum < 2^bits: shifted right by bits - 31 it stays below 2^31.
        let bits = 64 - sum.leading_zeros() as i32;
        self.mix_exponent = mix_exponent.max(bits - 31).max(0);
        self.ringing = ringing;
        self.force_shift = force_shift;
        self.allowance = allowance;
        self.refusing = refused;
    }

    /// Adds the bank's sound for a run of at most a tick's frames to `out`.
    ///
    /// `force` is the input in bus steps, `None` where there is none; `odd_start` says whether the first frame's absolute number is odd;
    /// `skip` leaves out groups at rest and the input work of a zero force. The bits do not depend on how a caller cuts time into runs.
    pub fn render(
        &mut self,
        memory: &mut Memory<'_>,
        force: Option<&[i32]>,
        odd_start: bool,
        skip: bool,
        out: &mut [i32],
    ) -> BankWork {
        let mut work = BankWork::default();
        let Some(force) = force.filter(|force| !skip || force.iter().any(|&x| x != 0)) else {
            if self.ringing || !skip {
                self.run(memory, None, odd_start, skip, out, &mut work);
            }
            return work;
        };
        let (mut force, mut out, mut odd) = (force, out, odd_start);
        while !force.is_empty() && !out.is_empty() {
            let (count, spent) = affordable(force, self.allowance);
            if count == 0 {
                let next = force.first().map_or(0, |x| u64::from(x.unsigned_abs()));
                // Room for a tick of twice this force, or four times what this tick has brought already, at most for what can come at all.
                let wanted = (next * 2 * TICK_FRAMES as u64).max(self.spent.saturating_mul(4));
                self.guard(memory, wanted.min((TICK_FRAMES as u64) << 31), true);
                work.extra_guards += 1;
                continue;
            }
            let (now, later) = force.split_at_checked(count).unwrap_or((force, &[]));
            let (out_now, out_later) =
                core::mem::take(&mut out).split_at_mut_checked(count).unwrap_or((&mut [], &mut []));
            self.run(memory, Some(now), odd, skip, out_now, &mut work);
            work.refused += self.refusing;
            self.allowance -= spent;
            self.spent = self.spent.saturating_add(spent);
            (force, out, odd) = (later, out_later, odd ^ (count % 2 == 1));
        }
        work
    }

    /// A run for which the groups are guarded.
    fn run(
        &mut self,
        memory: &mut Memory<'_>,
        force: Option<&[i32]>,
        odd_start: bool,
        skip: bool,
        out: &mut [i32],
        work: &mut BankWork,
    ) {
        let frames = out.len().min(TICK_FRAMES);
        let force_shift = self.force_shift;
        let (mut mix, mut mirrored_mix) = ([0; TICK_FRAMES], [0; TICK_FRAMES]);
        let (mut plain_force, mut mirrored_force) = ([0; TICK_FRAMES], [0; TICK_FRAMES]);
        for (frame, &x) in force.unwrap_or(&[]).iter().take(frames).enumerate() {
            // Within the allowance |x| << force_shift stays below 2^31.
            let x = fixed::saturating_shift_left(x, force_shift);
            if let (Some(plain), Some(mirrored)) = (plain_force.get_mut(frame), mirrored_force.get_mut(frame)) {
                (*plain, *mirrored) = (x, alternate(x, odd_start, frame));
            }
        }
        let (Some(mix), Some(mirrored_mix), Some(plain_force), Some(mirrored_force)) = (
            mix.get_mut(..frames),
            mirrored_mix.get_mut(..frames),
            plain_force.get(..frames),
            mirrored_force.get(..frames),
        ) else {
            return; // frames is at most a tick
        };
        let mix_exponent = self.mix_exponent;
        for_each_group(&self.modes, &self.groups, memory.modes, memory.groups, |group, modes| {
            if skip && !group.ringing() {
                return;
            }
            let (own_force, mix) = match group.mirrored() {
                false => (plain_force, &mut *mix),
                true => (mirrored_force, &mut *mirrored_mix),
            };
            group.render(modes, force.map(|_| (own_force, force_shift)), mix_exponent, mix);
            let mode_frames = (modes.len() * frames) as u32;
            if force.is_some() {
                work.driven_mode_frames += mode_frames;
            } else {
                work.free_mode_frames += mode_frames;
            }
        });
        let mut onsets = force.unwrap_or(&[]).iter().map(|&x| self.onset.apply_wide(x));
        for (frame, (out, (&plain, &mirrored))) in out.iter_mut().zip(mix.iter().zip(mirrored_mix.iter())).enumerate() {
            // Modes and onset cancel where the force rises, so that only their sum may saturate.
            let sum = i64::from(plain) + i64::from(alternate(mirrored, odd_start, frame));
            let sound = (sum << mix_exponent) + onsets.next().unwrap_or(0);
            *out = fixed::qadd(*out, fixed::saturate(sound));
        }
    }
}

/// `(-1)^n x` with n the absolute number of the frame.
fn alternate(x: i32, odd_start: bool, frame: usize) -> i32 {
    if odd_start == (frame % 2 == 1) { x } else { x.saturating_neg() }
}

/// The longest beginning of a force whose sum of magnitudes is within the allowance, and that sum.
fn affordable(force: &[i32], allowance: u64) -> (usize, u64) {
    let mut spent = 0;
    let mut count = 0;
    for x in force {
        let more = spent + u64::from(x.unsigned_abs());
        if more > allowance {
            break;
        }
        spent = more;
        count += 1;
    }
    (count, spent)
}

/// Calls `visit` with each group and its modes.
fn for_each_group(
    modes: &Range<usize>,
    groups: &Range<usize>,
    all_modes: &mut [Mode],
    all_groups: &mut [Group],
    mut visit: impl FnMut(&mut Group, &mut [Mode]),
) {
    let mut rest = all_modes.get_mut(modes.clone()).unwrap_or(&mut []);
    for group in all_groups.get_mut(groups.clone()).unwrap_or(&mut []) {
        let Some((modes, behind)) = rest.split_at_mut_checked(group.count()) else { return };
        visit(group, modes);
        rest = behind;
    }
}
