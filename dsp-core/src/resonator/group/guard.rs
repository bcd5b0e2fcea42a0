//! Guards: exponents follow the sound, so that nothing wraps and nothing falls into a dead band.

use super::super::headroom::{LIMIT, ROUNDING};
use super::super::mode::{Mode, State};
use super::{Group, MIN_EXPONENT, REFUSING, RINGING};
use crate::fixed;

/// Largest block exponent: a state of `LIMIT` then stands for 2^-2 of a bus step.
const MAX_EXPONENT: i32 = 31;
/// Addition to a size that was found: the largest effect of rounding, and the 4 that
/// [`Group::size`] may lack.
const MARGIN: u32 = ROUNDING as u32 + 4;
/// Size at the largest exponent below which a mode is less than 1/8 of a bus step, which the mix
/// rounds to nothing.
const SILENCE: u64 = 1 << 27;

impl Group {
    /// Shifts the states down by `bits`, for a hand that may make them larger; at the end of the
    /// exponents by two. A guard must follow.
    pub(in crate::resonator) fn lower_for_growth(&mut self, modes: &mut [Mode], bits: u8) {
        if self.ringing() {
            let most = (self.exponent() - MIN_EXPONENT + 2).clamp(0, 30) as i8;
            self.lower(modes, (bits as i8).min(most));
        }
    }

    /// Guards a group at rest, without a look at its states. False, and nothing is decided, if the
    /// input is unusually large.
    #[inline(always)]
    fn prepare_rest(&mut self, allowance: u64, force_shift: u32) -> bool {
        if allowance == 0 || self.gain_peak == 0 {
            self.bound = 0;
            return true;
        }
        // The finest exponent that the gains allow, so that small inputs keep all their bits, or
        // the one that holds the input.
        let finest = self.largest_exponent(Some(force_shift));
        // The product has at most 62 bits, as in `input_size`.
        let allowance = ((allowance >> 8) + 1).min(1 << 30) as u32;
        let product = u64::from(allowance) * u64::from(self.gain_peak);
        let (high, low) = ((product >> 32) as u32, product as u32);
        let bits = if high > 0 { 64 - high.leading_zeros() as i32 } else { 32 - low.leading_zeros() as i32 };
        let scale = i32::from(self.gain_exponent) - 23;
        // Exponent with which the input ends below 2^29.
        let exponent = finest.min(29 - bits - scale);
        let shift = scale + exponent;
        if exponent < MIN_EXPONENT || shift <= -64 {
            return false;
        }
        // bits + shift <= 29.
        let input = match shift {
            0.. => low << shift,
            -32..0 => (product >> -shift) as u32,
            _ => high >> (-shift - 32),
        };
        let bound = input + 1 + MARGIN;
        if u64::from(bound) > LIMIT {
            return false;
        }
        self.bound = bound;
        self.exponent = exponent as i8;
        self.status |= RINGING;
        true
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

    /// Largest size of the modes' states, less at most 4; at most 2^31
    /// ([`super::super::headroom`]).
    #[inline(always)]
    fn size(&self, modes: &[Mode]) -> u32 {
        let shift = self.form().shift();
        let (largest_u, largest_v) = largest(modes);
        debug_assert!(u64::from(largest_u) << shift <= 1 << 31, "headroom: u << {shift}");
        largest_u.wrapping_shl(shift).max(largest_v)
    }

    /// Shifts the states so that nothing can wrap while the sum of |force| stays within `allowance`
    /// (bus steps), and so that they use the rest of the headroom. If no exponent holds the input,
    /// it is refused. The force will come shifted left by `force_shift` bits. See
    /// [`super::super::headroom`].
    #[inline(never)]
    pub(in crate::resonator) fn guard(&mut self, modes: &mut [Mode], allowance: u64, force_shift: u32) {
        self.status &= !REFUSING;
        if !self.ringing() && self.prepare_rest(allowance, force_shift) {
            return;
        }
        // At rest there are no states to look at or to shift.
        let modes = if self.ringing() { modes } else { &mut [] };
        let mut size = self.size(modes);
        if size == 0 && modes.iter().all(|mode| mode.state == State::default()) {
            if allowance == 0 || self.gain_peak == 0 {
                self.status &= !RINGING;
                self.bound = 0;
                return;
            }
            // Nothing rings: start from the finest exponent that the gains allow, so that small
            // inputs keep all their bits.
            self.exponent = self.largest_exponent(Some(force_shift)) as i8;
        }
        let input = loop {
            match self.input_size(allowance) {
                Some(input) => break input,
                // A faint tail meets a force beyond the range of its units. The loop ends at the
                // smallest exponent at the latest.
                None => size = self.lowered(modes),
            }
        };
        if !self.normalise(modes, size, input, (allowance > 0).then_some(force_shift)) {
            self.status |= REFUSING;
            self.normalise(modes, size, 0, None);
        }
        self.status |= RINGING;
        if allowance == 0 && self.exponent() == MAX_EXPONENT && u64::from(self.bound) < SILENCE {
            self.silence(modes);
        }
    }

    /// Shifts the states up as far as they have decayed: a guard without input, at a third of its
    /// cost. Gives the largest |v|, in states of the exponent before, less at most 1.
    #[inline(always)]
    pub(in crate::resonator) fn follow(&mut self, modes: &mut [Mode]) -> u32 {
        let (largest_u, largest_v) = largest(modes);
        // At most 2^31 each, as `size` says. A guard aims at a total below 2^29.
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
        self.status &= !REFUSING;
        largest_v
    }

    /// Ends the group's sound at once.
    pub(in crate::resonator) fn silence(&mut self, modes: &mut [Mode]) {
        for mode in modes {
            mode.state = Default::default();
        }
        self.status &= !RINGING;
        self.bound = 0;
    }

    /// Brings the states to the exponent that holds their size and an input. False if there is
    /// none.
    #[inline(never)]
    fn normalise(&mut self, modes: &mut [Mode], size: u32, input: u64, force_shift: Option<u32>) -> bool {
        let total = u64::from(size).saturating_add(input).saturating_add(u64::from(MARGIN));
        // total < 2^bits, and shifting to 29 bits puts it into [LIMIT/2, LIMIT).
        let bits = match u32::try_from(total) {
            Ok(total) => 32 - total.leading_zeros() as i32,
            Err(_) => 64 - total.leading_zeros() as i32,
        };
        let wanted = self.exponent() + 29 - bits;
        // An exponent that was lowered below the smallest one stays.
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

    /// Largest exponent with which the gains' multipliers, 2^(gain_exponent + 1 + exponent -
    /// force_shift), do not exceed 1.
    fn largest_exponent(&self, force_shift: Option<u32>) -> i32 {
        let driven = |shift: u32| (shift as i32 - i32::from(self.gain_exponent) - 1).max(MIN_EXPONENT);
        force_shift.map_or(MAX_EXPONENT, driven).min(MAX_EXPONENT)
    }

    /// Size of the largest injection of an input with a sum of |force| of `allowance`, in units of
    /// the present exponent, rounded up; `None` if it exceeds 2^62.
    fn input_size(&self, allowance: u64) -> Option<u64> {
        if allowance == 0 || self.gain_peak == 0 {
            return Some(0);
        }
        // 32 frames of at most 2^31, expected twice: the allowance has at most 37 bits, so that
        // this product has at most 61.
        let allowance = ((allowance >> 8) + 1).min(1 << 30) as u32;
        let product = u64::from(allowance) * u64::from(self.gain_peak);
        let shift = i32::from(self.gain_exponent) + self.exponent() - 23;
        match shift {
            ..=-64 => Some(1),
            // The high word suffices, at a third of the cost.
            -63..=-32 => Some(u64::from(((product >> 32) as u32 >> (-shift - 32)) + 1)),
            -31..0 => Some((product >> -shift) + 1),
            _ => (product.leading_zeros() as i32 > shift + 1).then(|| product << shift),
        }
    }
}

/// A bound beyond 32 bits, or at the end of the exponents.
#[cold]
fn wide_bound(total: u64, shift: i32) -> u32 {
    let bound = if shift >= 0 { total << shift.min(34) } else { (total >> (-shift).min(63)) + 1 };
    u32::try_from(bound).unwrap_or(u32::MAX)
}

/// Largest |u| and largest |v|; negative numbers count one less, which saves an operation each.
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
