//! What the delay lines are kept in: 16 bits with a shared exponent a tick, or 32 bits.

use super::kernel;
use super::network::Work;
use crate::fixed;

/// A stored sample of a delay line.
///
/// A sample stands for `stored · 2^exponent` in Q4.27. In the network it is a *working value*, `sample · 2^(FRACTION - exponent)`.
pub trait Sample: Copy + sealed::Sealed {
    /// Silence.
    const ZERO: Self;
    /// Bits of a working value behind the stored sample's last one.
    const FRACTION: i32;
    /// Each line takes the input times 2^-this: as quiet as leaves room for long loud sounds.
    const INPUT_SHIFT: i32;
    /// Half a stored step as a working value, where storing cuts bits off.
    const HALF_STEP: i32;

    /// The exponent of a tick's samples whose sizes are below `2^bits` in Q4.27, where those that the tick reads have at most `read`.
    fn exponent(bits: i32, read: i32) -> i32;

    /// The gain of a read, for samples whose exponent is higher than the tick's by `rise`.
    fn gain(gain: f64) -> i32;

    /// Adapts a gain to samples whose exponent is higher than the tick's by `rise` (at most 2).
    fn raise(gain: i32, rise: i32) -> i32;

    /// Reads a block times a gain, as working values.
    fn take(line: &[Self], gain: i32, work: &mut [i32]);

    /// Mixes the samples of all lines from `start` on, as many as `sound` has, by an angle given as sine and cosine (Q31). `sound` holds each frame's input in its
    /// first element, and afterwards both outputs.
    fn mix(work: &mut Work, start: usize, sound: &mut [[i32; 2]], turn: [i32; 2]);

    /// Stores working values that are known to fit; gives the bits of the largest size.
    fn put(work: &[i32], line: &mut [Self]) -> u32;

    /// The same, clipped to ±2 of the bus, whatever the values.
    fn put_clipped(work: &[i32], line: &mut [Self], exponent: i32) -> u32;
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
    const INPUT_SHIFT: i32 = 2;
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

    fn take(line: &[Self], gain: i32, work: &mut [i32]) {
        kernel::take(line, gain, work);
    }

    fn mix(work: &mut Work, start: usize, sound: &mut [[i32; 2]], turn: [i32; 2]) {
        kernel::mix(work, start, sound, turn);
    }

    fn put(work: &[i32], line: &mut [Self]) -> u32 {
        kernel::put(work, line)
    }

    fn put_clipped(work: &[i32], line: &mut [Self], exponent: i32) -> u32 {
        let most = (CLIP >> exponent.clamp(0, CLIP_BITS)).min(i32::from(i16::MAX));
        let mut sizes = 0;
        for (sample, &value) in line.iter_mut().zip(work) {
            *sample = (value >> 12).clamp(-most, most) as i16;
            sizes |= (*sample ^ (*sample >> 15)) as u32;
        }
        32 - sizes.leading_zeros()
    }
}

/// Twice the memory: rounding at -160 dBFS, for those who have the room.
impl Sample for i32 {
    const ZERO: Self = 0;
    const FRACTION: i32 = 0;
    /// There is no exponent that would keep the last bits of the input.
    const INPUT_SHIFT: i32 = 1;
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

    fn take(line: &[Self], gain: i32, work: &mut [i32]) {
        for (value, &sample) in work.iter_mut().zip(line) {
            // At most ±2^28 by less than 1.
            *value = fixed::smmulr(sample << 1, gain);
        }
    }

    fn mix(work: &mut Work, start: usize, sound: &mut [[i32; 2]], turn: [i32; 2]) {
        kernel::portable::mix(work, start, sound, turn, Self::HALF_STEP);
    }

    fn put(work: &[i32], line: &mut [Self]) -> u32 {
        let mut sizes = 0;
        for (sample, &value) in line.iter_mut().zip(work) {
            *sample = value;
            sizes |= (value ^ (value >> 31)) as u32;
        }
        32 - sizes.leading_zeros()
    }

    fn put_clipped(work: &[i32], line: &mut [Self], _: i32) -> u32 {
        let mut sizes = 0;
        for (sample, &value) in line.iter_mut().zip(work) {
            *sample = value.clamp(-CLIP, CLIP);
            sizes |= (*sample ^ (*sample >> 31)) as u32;
        }
        32 - sizes.leading_zeros()
    }
}
