//! A register group: modes of one form that share a block exponent.

use super::bank::half_octaves;
use super::coefficient::{Form, Orbit};
use super::headroom::{GROWTH_OF_V, LIMIT, ROUNDING};
use super::kernel::Plan;
use super::mode::{Mode, State};
use crate::fixed;

/// Modes in a full group: two register sets of three (free) or three of two (driven).
pub const GROUP_MODES: usize = 6;

/// Largest block exponent: a state of `LIMIT` then stands for 2^-2 of a bus step.
const MAX_EXPONENT: i32 = 31;
/// Smallest block exponent: a state of `LIMIT` then stands for 2^26 times full scale.
const MIN_EXPONENT: i32 = -24;
/// Largest interval between two guards of a group that rings freely: 21 ms at 48 kHz.
const MAX_GUARD_TICKS: u32 = 32;
/// What is added to a size that was found: what rounding may add to it, and the 4 that [`Group::size`] may lack.
const MARGIN: u32 = ROUNDING as u32 + 4;
/// Below this size at the largest exponent a mode is less than 1/8 of a bus step, which the mix rounds to nothing.
const SILENCE: u64 = 1 << 27;
/// Largest exponent of a gain mantissa: from rest, the smallest block exponent then holds a tick of the largest force (2^36 bus steps).
pub(super) const MAX_GAIN_EXPONENT: i32 = 29 - MIN_EXPONENT - 36 - 1;

/// What a group of modes shares: its form, its block exponent and the bounds that go with it.
///
/// A state of value x stands for `x · 2^-exponent` bus steps. The states are kept just below [`LIMIT`] by shifting them at
/// guards, so that the damping term `δu` never falls into its dead band, however far the sound has decayed.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Group {
    /// What a kernel needs to know; kept up to date by [`Group::prepare`].
    plan: Plan,
    /// Size of the largest injection: max(|gain.u| · 2^k, |gain.v|) over the modes.
    gain_peak: u32,
    /// What the state's size, input included, stays below until the next guard.
    bound: u32,
    /// A gain mantissa g stands for `g · 2^(gain_exponent - 31)` bus steps a bus step of force.
    gain_exponent: i16,
    exponent: i8,
    mirrored: bool,
    ringing: bool,
    /// Whether input must be kept out until the next guard.
    refusing: bool,
    /// Ticks between two guards while nothing drives the group: in that time its fastest mode decays by half a bit.
    guard_ticks: u8,
    /// The bank's clock (ticks without input, modulo 256) at the next one.
    due_at: u8,
}

impl Group {
    /// A group of no modes, to fill memory before a kit is loaded.
    pub const EMPTY: Self = Self {
        plan: Plan::EMPTY,
        gain_peak: 0,
        bound: 0,
        gain_exponent: 0,
        exponent: 0,
        mirrored: false,
        ringing: false,
        refusing: false,
        guard_ticks: 0,
        due_at: 0,
    };

    pub(super) fn new(form: Form, mirrored: bool, count: u8) -> Self {
        Self { plan: Plan::new(form, count), mirrored, ..Self::EMPTY }
    }

    /// Number of modes.
    pub fn count(&self) -> usize {
        self.plan.count()
    }

    /// The arithmetic of its modes.
    pub fn form(&self) -> Form {
        self.plan.form()
    }

    pub(super) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Whether its modes run at fs/2 - f.
    pub fn mirrored(&self) -> bool {
        self.mirrored
    }

    /// Leaves the group out: its sound ends, and no input reaches it until [`Group::admit`].
    pub(super) fn shed(&mut self, modes: &mut [Mode]) {
        if self.ringing {
            self.silence(modes);
        }
        self.plan.set_shed(true);
    }

    /// Lets input reach it again.
    pub(super) fn admit(&mut self) {
        self.plan.set_shed(false);
    }

    /// Whether it is left out for want of time.
    pub(super) fn is_shed(&self) -> bool {
        self.plan.is_shed()
    }

    /// Bound of a mode's amplitude until the next guard, bus steps: what rings and what the guard has allowed for.
    pub(super) fn amplitude_bound(&self) -> f32 {
        if self.ringing { self.bound as f32 * self.unit() } else { 0.0 }
    }

    /// `2 log2` of [`Group::amplitude_bound`], `None` at rest.
    pub(super) fn ringing_half_octaves(&self) -> Option<i32> {
        self.ringing.then(|| half_octaves(self.bound) - 2 * self.exponent())
    }

    /// `2 log2` of [`Group::largest_gain`].
    pub(super) fn gain_half_octaves(&self) -> i32 {
        half_octaves(self.gain_peak) + 2 * (i32::from(self.gain_exponent) - 31)
    }

    /// Bus steps of state that a bus step of force makes at most.
    pub(super) fn largest_gain(&self) -> f32 {
        // Exponents are -148 to 16: as a float's, or as good as 0.
        let exponent = (127 + i32::from(self.gain_exponent) - 31).max(0) as u32;
        self.gain_peak as f32 * f32::from_bits(exponent << 23)
    }

    /// Whether its input is kept out at present.
    pub(super) fn refusing(&self) -> bool {
        self.refusing
    }

    /// Whether any of its modes may have a state other than zero.
    pub fn ringing(&self) -> bool {
        self.ringing
    }

    /// The block exponent: states count 2^-exponent bus steps.
    pub fn exponent(&self) -> i32 {
        i32::from(self.exponent)
    }

    /// Sets the input gains, in bus steps of state a bus step of force: `gains` gives (into u, into v) for each mode, below
    /// 2^[`MAX_GAIN_EXPONENT`].
    pub(super) fn set_gains(&mut self, modes: &mut [Mode], gains: impl Fn(usize, &Mode) -> (f32, f32)) {
        let weight = (1u32 << self.form().shift()) as f32;
        let peak = modes
            .iter()
            .enumerate()
            .map(|(index, mode)| gains(index, mode))
            .fold(0.0f32, |peak, (u, v)| peak.max((u * weight).abs()).max(v.abs()));
        let (_, exponent) = libm::frexpf(peak);
        self.gain_exponent = exponent as i16;
        let mut gain_peak = 0;
        let mut has_phase = false;
        for (index, mode) in modes.iter_mut().enumerate() {
            let (u, v) = gains(index, mode);
            let mantissa = |gain: f32| libm::rintf(libm::scalbnf(gain, 31 - exponent)) as i32;
            mode.gain.u = mantissa(u);
            mode.gain.v = mantissa(v);
            gain_peak = size_of(self.form(), mode.gain.u, mode.gain.v).max(gain_peak);
            has_phase |= mode.gain.v != 0;
        }
        self.plan.set_phase(has_phase);
        self.gain_peak = gain_peak.min(u64::from(u32::MAX)) as u32;
    }

    /// Shifts the states down by two bits, for poles that are about to move. A guard must follow.
    pub(super) fn make_room(&mut self, modes: &mut [Mode]) {
        if self.ringing {
            self.lower(modes, 2);
        }
    }

    #[cold]
    fn lowered(&mut self, modes: &mut [Mode]) -> u32 {
        self.lower(modes, 16);
        self.size(modes)
    }

    fn lower(&mut self, modes: &mut [Mode], bits: i8) {
        each_state(modes, |x| fixed::rounding_shift_right(x, bits.unsigned_abs().into()));
        self.exponent -= bits;
    }

    /// The largest size of the modes' states, less at most 4; at most 2^31, as [`super::headroom`] proves.
    #[inline(always)]
    fn size(&self, modes: &[Mode]) -> u32 {
        let shift = self.form().shift();
        let (largest_u, largest_v) = largest(modes);
        debug_assert!(u64::from(largest_u) << shift <= 1 << 31, "headroom: u << {shift}");
        largest_u.wrapping_shl(shift).max(largest_v)
    }

    /// Shifts the states so that nothing can wrap while the sum of |force| stays within `allowance` (bus steps), and so that they
    /// use all the room that leaves; where no exponent holds the input, it is refused. The force will come shifted left by `force_shift` bits.
    /// See [`super::headroom`].
    #[inline(never)]
    pub(super) fn guard(&mut self, modes: &mut [Mode], allowance: u64, force_shift: u32) {
        self.refusing = false;
        // At rest there is nothing to look at, and nothing to shift.
        let modes = if self.ringing { modes } else { &mut [] };
        let mut size = self.size(modes);
        if size == 0 && modes.iter().all(|mode| mode.state == State::default()) {
            if allowance == 0 || self.gain_peak == 0 {
                self.ringing = false;
                self.bound = 0;
                return;
            }
            // Nothing rings: start from the finest exponent that the gains allow, so that small inputs keep all their bits.
            self.exponent = self.largest_exponent(Some(force_shift)) as i8;
        }
        let input = loop {
            match self.input_size(allowance) {
                Some(input) => break input,
                // A faint tail meets a force that is not even countable in its units. Ends at the latest where exponents do.
                None => size = self.lowered(modes),
            }
        };
        if !self.normalise(modes, size, input, (allowance > 0).then_some(force_shift)) {
            self.refusing = true;
            self.normalise(modes, size, 0, None);
        }
        self.ringing = true;
        if allowance == 0 && self.exponent() == MAX_EXPONENT && u64::from(self.bound) < SILENCE {
            self.silence(modes);
        }
    }

    /// Shifts the states up as far as they have decayed: what a guard without input is, at a third of its cost. Gives the largest |v|, in
    /// states of the exponent before, less at most 1.
    #[inline(always)]
    pub(super) fn follow(&mut self, modes: &mut [Mode]) -> u32 {
        let (largest_u, largest_v) = largest(modes);
        // At most 2^31 each, as `size` says. A total below 2^29 is what a guard aims at.
        let total = largest_u.wrapping_shl(self.form().shift()).max(largest_v).saturating_add(MARGIN);
        let up = total.leading_zeros() as i32 - 3;
        if up < 0 || self.exponent() + up >= MAX_EXPONENT || total == MARGIN {
            self.guard(modes, 0, 0);
            return largest_v;
        }
        if up > 0 {
            each_state(modes, |x| x.wrapping_shl(up as u32));
            self.exponent += up as i8;
        }
        self.bound = total << up;
        self.refusing = false;
        largest_v
    }

    /// Ends the group's sound at once.
    pub(super) fn silence(&mut self, modes: &mut [Mode]) {
        for mode in modes {
            mode.state = Default::default();
        }
        self.ringing = false;
        self.bound = 0;
    }

    /// Whether there is an exponent that holds states of this size and input; then the states have it.
    #[inline(never)]
    fn normalise(&mut self, modes: &mut [Mode], size: u32, input: u64, force_shift: Option<u32>) -> bool {
        let total = u64::from(size).saturating_add(input).saturating_add(u64::from(MARGIN));
        // total < 2^bits, and shifting to 29 bits puts it into [LIMIT/2, LIMIT).
        let bits = match u32::try_from(total) {
            Ok(total) => 32 - total.leading_zeros() as i32,
            Err(_) => 64 - total.leading_zeros() as i32,
        };
        let wanted = self.exponent() + 29 - bits;
        // Room that was made below the smallest exponent stays.
        let smallest = MIN_EXPONENT.min(self.exponent());
        let exponent = wanted.min(self.largest_exponent(force_shift)).max(smallest);
        let shift = exponent - self.exponent();
        let bound = match u32::try_from(total) {
            // Shifted up it stays below LIMIT.
            Ok(total) if shift >= 0 && bits + shift <= 32 => total << shift,
            Ok(total) if shift < 0 => (total >> (-shift).min(31)) + 1,
            _ => wide_bound(total, shift),
        };
        if u64::from(bound) > LIMIT && input > 0 {
            return false;
        }
        match shift {
            0 => {}
            1.. => each_state(modes, |x| x.wrapping_shl(shift as u32)), // the bound says that this loses nothing
            -31..0 => {
                let (shift, half) = (-shift as u32, -shift as u32 - 1);
                each_state(modes, |x| x.wrapping_shr(shift) + (x.wrapping_shr(half) & 1));
            }
            _ => each_state(modes, |_| 0),
        }
        self.exponent = exponent as i8;
        self.bound = bound;
        true
    }

    /// Gains become multipliers of 2^(gain_exponent + 1 + exponent - force_shift), which must not exceed 1.
    fn largest_exponent(&self, force_shift: Option<u32>) -> i32 {
        let driven = |shift: u32| (shift as i32 - i32::from(self.gain_exponent) - 1).max(MIN_EXPONENT);
        force_shift.map_or(MAX_EXPONENT, driven).min(MAX_EXPONENT)
    }

    /// Size of what an input with a sum of |force| of `allowance` can inject, in units of the present exponent, rounded up; `None`
    /// where it exceeds 2^62.
    fn input_size(&self, allowance: u64) -> Option<u64> {
        if allowance == 0 || self.gain_peak == 0 {
            return Some(0);
        }
        // 32 frames of at most 2^31, expected twice: the allowance has at most 37 bits, so that this product has at most 61.
        let allowance = ((allowance >> 8) + 1).min(1 << 30) as u32;
        let product = u64::from(allowance) * u64::from(self.gain_peak);
        let shift = i32::from(self.gain_exponent) + self.exponent() - 23;
        match shift {
            ..=-64 => Some(1),
            // The same of the high word, at a third of the cost.
            -63..=-32 => Some(u64::from(((product >> 32) as u32 >> (-shift - 32)) + 1)),
            -31..0 => Some((product >> -shift) + 1),
            _ => (product.leading_zeros() as i32 > shift + 1).then(|| product << shift),
        }
    }

    /// Brings the kernel's plan up to date, after the group's guard and once the bank's mix exponent is known.
    pub(super) fn prepare(&mut self, mix_exponent: i32, force_shift: u32) {
        let gain_shift = match self.refusing {
            // Nothing is left of a gain: the input is kept out.
            true => 31,
            false => (force_shift as i32 - (i32::from(self.gain_exponent) + 1 + self.exponent())).clamp(0, 31),
        };
        self.plan.set(self.ringing, gain_shift as u32, mix_scale(self.exponent() + mix_exponent));
    }

    /// Derives from its poles how often it needs a guard while nothing drives it. After load, choke and release.
    pub(super) fn schedule_guards(&mut self, modes: &[Mode]) {
        // Half a bit: 32 samples of -log2(1 - δ)/2 bits each, δ in Q32, to first order.
        const HALF_BIT: u32 = 93_000_000;
        let fastest = modes.iter().fold(0, |fastest, mode| mode.coefficients.delta.max(fastest));
        self.guard_ticks = (HALF_BIT / fastest.unsigned_abs().max(1)).clamp(1, MAX_GUARD_TICKS) as u8;
    }

    /// Guards that it needs in 32 ticks without input, rounded up.
    pub(super) fn guards_in_32_ticks(&self) -> u32 {
        MAX_GUARD_TICKS.div_ceil(u32::from(self.guard_ticks.max(1)))
    }

    /// Sets the multiplier that brings its states to a mix of this exponent, after the group's guard.
    pub(super) fn scale_mix(&mut self, mix_exponent: i32) {
        self.plan.set_mix_scale(mix_scale(self.exponent() + mix_exponent));
    }

    /// Sets the time of its next guard after one for no input, or, where that may still come, at once when it ends.
    pub(super) fn schedule(&mut self, clock: u8, has_input: bool) {
        self.due_at = clock.wrapping_add(if has_input { 0 } else { self.guard_ticks });
    }

    /// Ticks until the next guard without input; below 0 where it is late.
    pub(super) fn due_ticks(&self, clock: u8) -> i8 {
        self.due_at.wrapping_sub(clock) as i8
    }

    /// Bound of the sum of the group's modes in bus steps, rounded up, saturating.
    pub(super) fn mix_bound(&self) -> u64 {
        // In eighths, so that it fits 32 bits: 2^29 states of growth 4 times six modes, bound by an exponent that leaves room.
        let eighths = u64::from(self.bound / 8 + 1) * GROWTH_OF_V * self.count() as u64;
        match self.exponent() - 3 {
            shift @ 0..=31 => u64::from((eighths.min(u64::from(u32::MAX)) as u32) >> shift) + 1,
            shift @ 32.. => (eighths >> shift) + 1,
            shift => eighths << -shift, // at most 2^34 · 2^27
        }
    }

    /// The smallest mix exponent with which this group's mix scale fits.
    pub(super) fn smallest_mix_exponent(&self) -> i32 {
        2 - self.exponent()
    }

    /// Bus steps that a state of 1 stands for, 2^-exponent; exponents are small enough to be a float's.
    pub(super) fn unit(&self) -> f32 {
        f32::from_bits(((127 - self.exponent()) as u32) << 23)
    }

    /// The largest and the summed amplitude of the group's modes in bus steps, exact to 1e-5; `None` while some state alone shows that one
    /// is louder than `threshold`, which is the usual case and quick to see.
    pub(super) fn amplitudes_below(&self, modes: &[Mode], threshold: f32) -> Option<f32> {
        let unit = self.unit();
        let mut sum = 0.0;
        for mode in modes {
            let (u, v) = (mode.state.u as f32 * unit, mode.state.v as f32 * unit);
            if v.abs() > threshold {
                return None;
            }
            let (sine, cosine) = Orbit::new(self.form(), mode.coefficients).phases(u, v);
            let amplitude = libm::sqrtf(sine * sine + cosine * cosine);
            if amplitude.is_nan() || amplitude > threshold {
                return None;
            }
            sum += amplitude;
        }
        Some(sum)
    }
}

/// A bound beyond 32 bits, or at the end of the exponents.
#[cold]
fn wide_bound(total: u64, shift: i32) -> u32 {
    let bound = if shift >= 0 { total << shift.min(34) } else { (total >> (-shift).min(63)) + 1 };
    u32::try_from(bound).unwrap_or(u32::MAX)
}

/// `max(|u| · 2^k, |v|)`: the size of a state or an injection.
fn size_of(form: Form, u: i32, v: i32) -> u64 {
    (u64::from(u.unsigned_abs()) << form.shift()).max(u64::from(v.unsigned_abs()))
}

/// The largest |u| and the largest |v|, where negative ones count one less: an operation less each.
#[inline(always)]
fn largest(modes: &[Mode]) -> (u32, u32) {
    modes.iter().fold((0, 0), |(u, v), mode| {
        let magnitude = |x: i32| (x ^ (x >> 31)) as u32;
        (magnitude(mode.state.u).max(u), magnitude(mode.state.v).max(v))
    })
}

#[inline(always)]
fn each_state(modes: &mut [Mode], shifted: impl Fn(i32) -> i32) {
    for mode in modes {
        mode.state.u = shifted(mode.state.u);
        mode.state.v = shifted(mode.state.v);
    }
}

/// 2^-(shift) as a Q32 multiplier: what brings a state to the mix. Nothing above 2^-1 can occur, nothing below 2^-32 is heard.
fn mix_scale(shift: i32) -> i32 {
    match shift {
        2..=32 => 1 << (32 - shift),
        _ => 0,
    }
}
