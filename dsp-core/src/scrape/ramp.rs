//! Values that change linearly from one end of a tick to the other.

use crate::time::TICK_FRAMES;

/// Linear ramp over a tick, in fixed point.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(super) struct Ramp {
    value: i32,
    step: i32,
}

impl Ramp {
    /// Creates the ramp between the values at a tick's ends. Both must be within ±2^30. At the end
    /// it is up to 31 steps off, which is nothing for values of [`bits_for`].
    pub(super) const fn new([from, to]: [i32; 2]) -> Self {
        Self { value: from, step: (to - from) / TICK_FRAMES as i32 }
    }

    /// Goes on by a number of frames.
    pub(super) const fn go_on(&mut self, frames: usize) {
        self.value = self.value.wrapping_add(self.step.wrapping_mul(frames as i32));
    }

    /// Value at the end of the last frame.
    pub(super) const fn now(self) -> i32 {
        self.value
    }

    /// Gives the value at the end of the next frame.
    #[inline(always)]
    pub(super) const fn next(&mut self) -> i32 {
        self.value = self.value.wrapping_add(self.step);
        self.value
    }
}

/// Number of fraction bits, at most `most`, with which the larger one of two numbers is 2^28 to
/// 2^29 in size.
pub(super) fn bits_for([a, b]: [f32; 2], most: i32) -> i32 {
    // Numbers from 0 on have the order of their bits.
    let larger = a.abs().to_bits().max(b.abs().to_bits());
    (28 - ((larger >> 23) as i32 - 127)).min(most)
}

/// Exponent of a number above 0: the number is `2^exponent` to below twice as much.
pub(super) fn exponent(number: f32) -> i32 {
    (number.to_bits() >> 23 & 255) as i32 - 127
}

/// Number as fixed point with `bits` fraction bits, -126 to 127, within ±2^30.
///
/// `as` saturates, and makes 0 of a number that is none.
pub(super) fn fixed_from(value: f32, bits: i32) -> i32 {
    let scale = f32::from_bits(((bits + 127) as u32) << 23);
    // Written so that it becomes one SSAT.
    ((value * scale) as i32).clamp(-(1 << 30), (1 << 30) - 1)
}

/// Power of two, exact, for exponents from -126 to 127.
pub(super) fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent.clamp(-126, 127) + 127) as u32) << 23)
}
