//! The loops in Rust, with the bits of `cortex_m4.s`.

use super::{Frames, PIECES, POWERS, Pressing, Sinking, Turning};
use crate::fixed;
use crate::time::TICK_FRAMES;

/// Turns the ball frame by frame: gives its depth on a flat path, and the turn's share of the
/// factor.
///
/// Three shears make a rotation, so that cosine and sine keep their length but for rounding.
pub(in super::super::super) fn turn(turning: &mut Turning, frames: &mut Frames) {
    for (depth, factor) in frames.depths.iter_mut().zip(&mut frames.factors) {
        let (half, whole) = (turning.half.next(), turning.whole.next());
        turning.cosine = fixed::smmlsr(turning.cosine, turning.sine, half);
        turning.sine = fixed::smmlar(turning.sine, turning.cosine, whole);
        turning.cosine = fixed::smmlsr(turning.cosine, turning.sine, half);
        *depth = fixed::smmlsr(turning.rest, turning.cosine, turning.offset);
        *factor = fixed::smmul(turning.sine, turning.rate.next());
    }
}

/// Adds what the path's height and slope do to depths and factors; both are at least 0.
pub(in super::super::super) fn sink(sinking: &mut Sinking, frames: &mut Frames) {
    let high = |height: i64| (height >> 32) as i32;
    let Frames { depths, factors, slopes } = frames;
    for ((depth, factor), &slope) in depths.iter_mut().zip(factors).zip(&*slopes) {
        // A height below 2^62, at most half of it, and 2^30 times 2^30.
        let height = sinking.height
            + i64::from(high(sinking.height)) * i64::from(sinking.less)
            + i64::from(slope) * i64::from(sinking.rise.next());
        let clamped = high(height).clamp(-(1 << 30), (1 << 30) - 1);
        sinking.height = (i64::from(clamped) << 32) | (height & i64::from(u32::MAX));
        *depth = (*depth + clamped).max(0);
        *factor = fixed::qadd(fixed::smmla(*factor, slope, sinking.rate.next()), sinking.one).max(0);
    }
}

/// Adds the force of depths and factors, without what changes slowly, to that of the frames.
pub(in super::super::super) fn press(pressing: &mut Pressing, frames: &Frames, force: &mut [i32; TICK_FRAMES]) {
    for ((force, &depth), &factor) in force.iter_mut().zip(&frames.depths).zip(&frames.factors) {
        // An even number of zeros: the power 1.5 of their shift is one of whole bits.
        let zeros = depth.leading_zeros() & !1;
        let mantissa = (depth as u32).checked_shl(zeros).unwrap_or(0);
        let [constant, slope, growth, _] = POWERS[(mantissa >> 26) as usize % PIECES];
        let within = (mantissa << 6 ^ (1 << 31)) as i32;
        let power = fixed::smmlar(constant, fixed::smmlar(slope, growth, within), within);
        let product = fixed::smmulr(fixed::smmulr(power, pressing.stiffness), factor);
        let right = (zeros + (zeros >> 1)) as i32 + pressing.right;
        let whole = match right {
            0.. => product >> right.min(31),
            _ => fixed::saturating_shift_left(product, right.unsigned_abs()),
        };
        let fast = fixed::qsub(whole, (pressing.slow >> 32) as i32);
        pressing.slow += i64::from(fast) * i64::from(pressing.share);
        *force = fixed::qadd(*force, fast);
    }
}
