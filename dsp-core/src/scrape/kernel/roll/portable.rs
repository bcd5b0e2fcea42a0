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
        turning.sine += fixed::smmulr(turning.cosine, whole) << 1;
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

#[cfg(test)]
mod tests {
    use super::super::super::super::ramp::Ramp;
    use super::*;

    #[test]
    fn turn_keeps_cosine_and_sine_on_the_circle() {
        // A frame's turn grows from 0.38 to 0.4 radians.
        let ramp = |of: fn(f64) -> f64| Ramp::new([0.38, 0.4].map(|turn| (of(turn) * 4_294_967_296.0) as i32));
        let mut turning = Turning {
            cosine: 1 << 30,
            sine: 0,
            half: ramp(|turn| (0.5 * turn).tan()),
            whole: ramp(|turn| 0.5 * turn.sin()),
            rest: 0,
            offset: 0,
            rate: Ramp::default(),
        };
        let mut frames = Frames::NONE;
        turn(&mut turning, &mut frames);
        let [cosine, sine] = [turning.cosine, turning.sine].map(|part| f64::from(part) / f64::from(1 << 30));
        let angle: f64 = (1..=32).map(|frame| 0.38 + 0.02 * f64::from(frame) / 32.0).sum();
        // Half and whole do not belong to one angle in between, but nearly.
        assert!((cosine - angle.cos()).abs() < 2e-4 && (sine - angle.sin()).abs() < 2e-4, "{cosine}, {sine}");
        assert!((cosine.hypot(sine) - 1.0).abs() < 2e-5);
    }

    #[test]
    fn press_gives_the_power_1_5_of_any_depth() {
        for depth in (0..31).flat_map(|bit| [1 << bit, (1 << bit) * 5 / 4, (1_i64 << bit) * 7 / 4]) {
            let depth = depth as i32;
            let mut frames = Frames::NONE;
            (frames.depths, frames.factors) = ([depth; TICK_FRAMES], [1 << 29; TICK_FRAMES]);
            let mut pressing = Pressing { slow: 0, stiffness: 1 << 29, share: 0, right: -4 };
            let mut force = [0; TICK_FRAMES];
            press(&mut pressing, &frames, &mut force);
            // 2^31 (depth/2^32)^1.5, times 2^29/2^32 twice, times 2^4.
            let exact = 2f64.powi(29) * (f64::from(depth) / 2f64.powi(32)).powf(1.5);
            assert!((f64::from(force[0]) - exact).abs() < 2.0 + 6e-7 * exact, "{depth}: {} {exact}", force[0]);
        }
    }

    #[test]
    fn loops_are_bounded_for_any_ball() {
        for sign in [1, -1] {
            let ramp = Ramp::new([sign << 29, -sign << 29]);
            let mut frames = Frames::NONE;
            frames.slopes = [-sign << 30; TICK_FRAMES];
            let mut turning = Turning {
                cosine: 1 << 30,
                sine: 0,
                half: ramp,
                whole: ramp,
                rest: 1 << 28,
                offset: 1 << 30,
                rate: ramp,
            };
            let mut sinking = Sinking { height: 0, rise: ramp, less: i32::MIN, rate: ramp, one: 1 << 29 };
            let mut pressing = Pressing { slow: 0, stiffness: 1 << 30, share: 1 << 24, right: -60 };
            for _ in 0..20 {
                turning.cosine = 1 << 30;
                turning.sine = 0;
                turn(&mut turning, &mut frames);
                sink(&mut sinking, &mut frames);
                assert!(frames.depths.iter().chain(&frames.factors).all(|&x| x >= 0));
                press(&mut pressing, &frames, &mut [i32::MAX; TICK_FRAMES]);
            }
        }
    }
}
