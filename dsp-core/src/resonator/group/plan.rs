//! A group's data for the kernels.

use super::super::coefficient::Form;

/// Number of modes in a full group: two register sets of three (free) or three of two (driven).
pub const GROUP_MODES: usize = 6;

/// A group as a kernel meets it: its loops, its number of modes, its shifts. Eight bytes, laid out
/// as the assembly reads them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Plan {
    free_kind: u8,
    driven_kind: u8,
    gain_shift: u8,
    count: u8,
    mix_scale: i32,
}

/// Bits of a kind: 0 and 1 are the form.
const FORM: u8 = 3;
const PHASE: u8 = 1 << 2;
/// Only in the free kind, at which a kernel passes by a group at rest.
const SHED: u8 = 1 << 5;
const NOT_FULL: u8 = 1 << 6;
const RINGING: u8 = 1 << 7;

impl Plan {
    /// A plan of no modes.
    pub const EMPTY: Self = Self { free_kind: 0, driven_kind: 0, gain_shift: 0, count: 0, mix_scale: 0 };

    /// A plan of `count` modes of a form, at most [`GROUP_MODES`], at rest, with gains without
    /// phase.
    pub fn new(form: Form, count: u8) -> Self {
        let count = count.min(GROUP_MODES as u8);
        let full = if usize::from(count) == GROUP_MODES { 0 } else { NOT_FULL };
        let kind = form as u8 | full;
        Self { free_kind: kind, driven_kind: kind, count, ..Self::EMPTY }
    }

    /// Sets whether any of the modes has a gain into v.
    pub fn set_phase(&mut self, has_phase: bool) {
        self.driven_kind = self.driven_kind & !PHASE | if has_phase { PHASE } else { 0 };
    }

    /// Sets the results of a guard: whether the group rings, by how many bits its gains are shifted
    /// right (0 to 31, rounding down), and the Q32 multiplier that brings its states to the mix (0
    /// to 2^30).
    pub fn set(&mut self, ringing: bool, gain_shift: u32, mix_scale: i32) {
        let ringing = if ringing { RINGING } else { 0 };
        self.free_kind = self.free_kind & !RINGING | ringing;
        self.driven_kind = self.driven_kind & !RINGING | ringing;
        self.gain_shift = gain_shift.min(31) as u8;
        self.mix_scale = mix_scale;
    }

    /// Sets the Q32 multiplier that brings the group's states to the mix, 0 to 2^30.
    pub fn set_mix_scale(&mut self, mix_scale: i32) {
        self.mix_scale = mix_scale;
    }

    /// Sets whether the group is left out for want of time; it must be at rest then.
    pub fn set_shed(&mut self, shed: bool) {
        self.free_kind = self.free_kind & !SHED | if shed { SHED } else { 0 };
    }

    /// True if the group is left out for want of time.
    pub fn is_shed(&self) -> bool {
        self.free_kind & SHED != 0
    }

    /// Number of modes.
    pub fn count(&self) -> usize {
        usize::from(self.count)
    }

    /// Arithmetic of the modes.
    pub fn form(&self) -> Form {
        match self.free_kind & FORM {
            0 => Form::Coupled,
            1 => Form::Shifted1,
            _ => Form::Shifted2,
        }
    }

    /// True if any mode has a gain into v.
    pub fn has_phase(&self) -> bool {
        self.driven_kind & PHASE != 0
    }

    /// True if no mode rings.
    pub fn is_at_rest(&self) -> bool {
        self.free_kind & RINGING == 0
    }

    /// Number of bits by which gains are shifted right.
    pub fn gain_shift(&self) -> u32 {
        u32::from(self.gain_shift)
    }

    /// Q32 multiplier of the mix.
    pub fn mix_scale(&self) -> i32 {
        self.mix_scale
    }
}
