//! What the delay lines are kept in: 16 bits with a shared exponent a tick, or 32 bits.

use crate::fixed;

/// A stored sample of a delay line.
///
/// A sample stands for `stored · 2^exponent` in Q4.27. In the network it is a *working value*, `sample · 2^(FRACTION - exponent)`.
pub trait Sample: Copy + sealed::Sealed {
    /// Silence.
    const ZERO: Self;
    /// Bits of a working value behind the stored sample's last one.
    const FRACTION: i32;
    /// Half a stored step as a working value, where storing cuts bits off.
    const HALF_STEP: i32;

    /// The exponent of a tick's samples whose sizes are below `2^bits` in Q4.27, where those that the tick reads have at most `read`.
    fn exponent(bits: i32, read: i32) -> i32;

    /// The gain of a read, for samples whose exponent is higher than the tick's by `rise`.
    fn gain(gain: f64) -> i32;

    /// Adapts a gain to samples whose exponent is higher than the tick's by `rise` (at most 2).
    fn raise(gain: i32, rise: i32) -> i32;

    /// A stored sample times a gain, as a working value.
    fn take(self, gain: i32) -> i32;

    /// A working value as a stored sample, rounded down: whoever mixes adds [`HALF_STEP`](Self::HALF_STEP). The value must be known to fit.
    fn put(working: i32) -> Self;

    /// The same, clipped to ±2 of the bus, whatever the value.
    fn put_clipped(working: i32, exponent: i32) -> Self;

    /// The bits that a sample's size needs, as a number below twice of it.
    fn size(self) -> u32;
}

/// Largest size in a line, ±2.0 in Q4.27: what is louder is clipped there.
pub(super) const CLIP: i32 = 1 << 28;
/// Bits of [`CLIP`].
pub(super) const CLIP_BITS: i32 = 28;

mod sealed {
    pub trait Sealed {}
    impl Sealed for i16 {}
    impl Sealed for i32 {}
}

/// Half the memory. A tick's samples share an exponent, so that a tail stays 70 dB above its own rounding however quiet it is.
impl Sample for i16 {
    const ZERO: Self = 0;
    const FRACTION: i32 = 12;
    const HALF_STEP: i32 = 1 << 11;

    fn exponent(bits: i32, read: i32) -> i32 {
        // Never so low that a read would have to be raised by more than 2, never above what ±2.0 needs.
        (bits - 15).max(read - 2).clamp(0, CLIP_BITS - 15)
    }

    fn gain(gain: f64) -> i32 {
        libm::rint(gain * 268_435_456.0) as i32
    }

    #[inline(always)]
    fn raise(gain: i32, rise: i32) -> i32 {
        // Gains are below 2^28, rises at most 2.
        match rise {
            0.. => gain << rise.min(2),
            _ => fixed::rounding_shift_right(gain, rise.unsigned_abs()),
        }
    }

    #[inline(always)]
    fn take(self, gain: i32) -> i32 {
        // SMULWB: Q28 by an integer, 12 bits of fraction kept.
        ((i64::from(gain) * i64::from(self)) >> 16) as i32
    }

    #[inline(always)]
    fn put(working: i32) -> Self {
        (working >> 12) as i16
    }

    fn put_clipped(working: i32, exponent: i32) -> Self {
        let most = (CLIP >> exponent.clamp(0, CLIP_BITS)).min(i32::from(i16::MAX));
        (working >> 12).clamp(-most, most) as i16
    }

    #[inline(always)]
    fn size(self) -> u32 {
        (self ^ (self >> 15)) as u32
    }
}

/// Twice the memory: rounding at -160 dBFS, for those who have the room.
impl Sample for i32 {
    const ZERO: Self = 0;
    const FRACTION: i32 = 0;
    const HALF_STEP: i32 = 0;

    fn exponent(_: i32, _: i32) -> i32 {
        0
    }

    fn gain(gain: f64) -> i32 {
        libm::rint(gain * 2_147_483_648.0) as i32
    }

    #[inline(always)]
    fn raise(gain: i32, _: i32) -> i32 {
        gain
    }

    #[inline(always)]
    fn take(self, gain: i32) -> i32 {
        // At most ±2^28 by less than 1.
        fixed::smmulr(self << 1, gain)
    }

    #[inline(always)]
    fn put(working: i32) -> Self {
        working
    }

    fn put_clipped(working: i32, _: i32) -> Self {
        working.clamp(-CLIP, CLIP)
    }

    #[inline(always)]
    fn size(self) -> u32 {
        (self ^ (self >> 31)) as u32
    }
}
