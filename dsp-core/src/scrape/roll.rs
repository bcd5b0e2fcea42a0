//! Force of a ball that rolls (scraping-rolling eq. 15 to 19).
//!
//! The penetration is `ρ = ρ0 - r cos(x/R) + S`, at least 0. The paper's R before it is a constant
//! height; here it is the resting depth ρ0, at which `k ρ0^1.5` carries the ball's weight. What
//! changes below 20 Hz, the weight and its slow shifts from side to side, moves the object as a
//! whole and is left out: a ball at rest is silent.

use super::kernel::roll::{self as kernel, Frames, Pressing, Sinking, Turning};
use super::motion::MAX_SPEED_M_PER_S;
use super::ramp::{Ramp, bits_for, exponent, fixed_from, power_of_two};
use crate::SampleRate;
use crate::exponential;
use crate::fixed;
use crate::table::layout::RollRecord;
use crate::time::TICK_FRAMES;

/// Ball that rolls, in SI units (scraping-rolling §4.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rolling {
    /// Mean radius R in metres.
    pub radius_m: f32,
    /// Distance r of the centre of mass from the middle in metres.
    pub offset_m: f32,
    /// Stiffness k in N/m^1.5.
    pub stiffness: f32,
    /// Dissipation λ in N s/m^2.5.
    pub dissipation: f32,
    /// Share of the normal force that goes up and down with the centre of mass, 0 to 1.
    pub modulation: f32,
}

impl Rolling {
    /// Ball of a kit's record.
    pub fn of(record: &RollRecord) -> Self {
        Self {
            radius_m: record.radius_m.get(),
            offset_m: record.offset_m.get(),
            stiffness: record.stiffness.get(),
            dissipation: record.dissipation.get(),
            modulation: record.modulation.get(),
        }
    }
}

/// State of a ball.
#[derive(Clone, Debug)]
pub(super) struct Roll {
    /// Share of the normal force that goes up and down.
    modulation: f32,
    /// Slope of 1.0.
    slope: f32,
    /// From a speed in m/s to radians a frame, and to turns a frame.
    radians: f32,
    turns: f32,
    /// From the depth's rate in m/s to the factor, and from a speed to the most that a turn adds to
    /// it.
    damping: f32,
    turn_damping: f32,
    /// From a slope's rise in m/s to that of a depth's share in a frame.
    rise: f32,
    /// Turn of the ball, 2^48 = once round.
    turn: i64,
    /// Fraction bits of a depth, as a share of the largest.
    bits: i32,
    /// Resting depth, and offset with 2 bits more.
    rest: i32,
    offset: i32,
    /// Height of the path, with 32 bits more.
    height: i64,
    /// Stiffness: its mantissa, and the bits that the product of full depth and mantissa has too
    /// many.
    stiffness: i32,
    right: i32,
    /// Force below [`LOWEST_HZ`], Q59 of the force bus, and its share of a frame's force, Q32.
    slow: i64,
    share: i32,
}

/// Ratio of the highest speed to that of lower speeds: above, slopes are taken as so many times as
/// large, and saturated. They are nowhere near their limit, which is that of a path that bends one
/// way all along ten of its shortest waves.
const SPEEDS: f32 = 4.0;
const SPEED_BITS: u32 = 2;

/// Lowest frequency of the force in hertz.
const LOWEST_HZ: f32 = 20.0;

/// Values that a roll shares with its scraper.
#[derive(Clone, Copy, Debug)]
pub(super) struct Units {
    /// Slope of 1.0.
    pub(super) slope: f32,
    /// Force of 1.0, in newtons.
    pub(super) force_n: f32,
    /// Largest height of the surface in metres.
    pub(super) height_m: f32,
    pub(super) rate: SampleRate,
}

impl Roll {
    /// Ball that carries `weight_n` at rest.
    pub(super) fn new(ball: Rolling, weight_n: f32, units: Units) -> Self {
        let depth = |force_n: f32| exponential::power(f64::from(force_n / ball.stiffness), 2.0 / 3.0) as f32;
        let rest_m = if weight_n > 0.0 { depth(weight_n) } else { 0.0 };
        // Largest depth that is rendered, but for the path's height.
        let largest_m = 2.0 * (rest_m + ball.offset_m + units.height_m);
        // A slope of one unit has 28 bits, a height 32 more than a depth: what the path rises in a
        // frame at the highest of lower speeds has 30. An even number, so that its power 1.5 is one
        // of bits.
        let steepest = MAX_SPEED_M_PER_S / SPEEDS * units.slope / (units.rate.hz_f32() * largest_m);
        let bits = 28.min(28 - 2 * ((exponent(steepest) + 4) >> 1)).max(2);
        // Full depth is 2^32 in depth's bits.
        let root = crate::square_root::rounded_root(largest_m);
        let turned = exponent_of_1_5(32 - bits);
        let (stiffness, right) = mantissa(ball.stiffness * largest_m * root / units.force_n, turned + 27);
        let turns = core::f32::consts::TAU * LOWEST_HZ / units.rate.hz_f32();
        let frame_s = 1.0 / units.rate.hz_f32();
        let (radians, damping) = (frame_s / ball.radius_m, ball.dissipation / ball.stiffness);
        let mut roll = Self {
            modulation: ball.modulation,
            slope: units.slope,
            radians,
            turns: radians * (1.0 / core::f32::consts::TAU),
            damping,
            turn_damping: damping * ball.offset_m / ball.radius_m,
            rise: frame_s / largest_m,
            turn: 0,
            bits,
            rest: fixed_from(rest_m / largest_m, bits),
            offset: fixed_from(ball.offset_m / largest_m, bits + 2),
            height: 0,
            stiffness,
            right,
            slow: 0,
            share: fixed_from(turns, 32),
        };
        // What a ball presses at rest is left out from the begin, to the last bit.
        let (mut frames, mut force) = (Frames::NONE, [0; TICK_FRAMES]);
        (frames.depths, frames.factors) = ([roll.rest; TICK_FRAMES], [1 << 29; TICK_FRAMES]);
        let mut pressing = Pressing { slow: 0, stiffness, share: 0, right: roll.right + 29 - 32 };
        kernel::press(&mut pressing, &frames, &mut force);
        roll.slow = i64::from(force[0]) << 32;
        roll
    }

    /// Share of the normal force at the ball's turn, moving at a signed speed: it is largest where
    /// the centre of mass moves down.
    pub(super) fn normal_share(&self, is_backwards: bool) -> f32 {
        let sine = sine_at((self.turn >> 16) as u32) as f32 * power_of_two(-31);
        1.0 + self.modulation * if is_backwards { sine } else { -sine }
    }

    /// Largest and least share of the normal force.
    pub(super) fn normal_shares(&self) -> [f32; 2] {
        [1.0 - self.modulation, 1.0 + self.modulation]
    }

    /// Adds the ball's force over a tick, Q27, to that of the frames, whose slopes are given. The
    /// speeds at the tick's ends are in m/s; `less` is the share of the height, Q32, that is lost
    /// in a frame, with its sign.
    pub(super) fn render(&mut self, speeds: [f32; 2], less: i32, frames: &mut Frames, force: &mut [i32; TICK_FRAMES]) {
        let mut unit = self.slope;
        if speeds.iter().any(|speed| speed.abs() > MAX_SPEED_M_PER_S / SPEEDS) {
            unit *= 1.0 / SPEEDS;
            frames.slopes.iter_mut().for_each(|slope| *slope = fixed::saturating_shift_left(*slope, SPEED_BITS));
        }
        let radians = speeds.map(|speed| speed * self.radians);
        // The high word of a slope of 28 bits and a gain of n bits has n - 4, that of a sine of 30
        // bits n - 2.
        let slope_rate = speeds.map(|speed| self.damping * speed * unit);
        let turn_rate = speeds.map(|speed| self.turn_damping * speed);
        let bits = bits_for(slope_rate, 33).min(bits_for(turn_rate, 31) + 2).max(4);
        let at = (self.turn >> 16) as u32;
        let mut turning = Turning {
            cosine: sine_at(at.wrapping_add(1 << 30)) >> 1,
            sine: sine_at(at) >> 1,
            half: Ramp::new(radians.map(|turn| fixed_from(tangent_of_half(turn), 32))),
            whole: Ramp::new(radians.map(|turn| fixed_from(sine_of(turn), 31))),
            rest: self.rest,
            offset: self.offset,
            rate: Ramp::new(turn_rate.map(|rate| fixed_from(rate, bits - 2))),
        };
        kernel::turn(&mut turning, frames);
        let rise = speeds.map(|speed| speed * unit * self.rise);
        let mut sinking = Sinking {
            height: self.height,
            rise: Ramp::new(rise.map(|rise| fixed_from(rise, self.bits + 4))),
            less,
            rate: Ramp::new(slope_rate.map(|rate| fixed_from(rate, bits))),
            one: 1 << (bits - 4),
        };
        kernel::sink(&mut sinking, frames);
        self.height = sinking.height;
        // The factor's bits less those that its product loses.
        let right = self.right + bits - 4 - 32;
        let mut pressing = Pressing { slow: self.slow, stiffness: self.stiffness, share: self.share, right };
        kernel::press(&mut pressing, frames, force);
        self.slow = pressing.slow;
        let [from, to] = speeds.map(|speed| (speed * self.turns * power_of_two(48)) as i64);
        let (frames, step) = (TICK_FRAMES as i64, (to - from) / TICK_FRAMES as i64);
        self.turn = self.turn.wrapping_add(from * frames + step * (frames * (frames + 1) / 2));
    }
}

/// Tangent of half a turn, and the turn's sine, to 1e-6 for turns of up to 0.42 radians: 10 m/s of
/// the smallest ball.
fn tangent_of_half(turn: f32) -> f32 {
    let square = turn * turn;
    0.5 * turn * (1.0 + square * (1.0 / 12.0 + square * (1.0 / 120.0)))
}

fn sine_of(turn: f32) -> f32 {
    let square = turn * turn;
    turn * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)))
}

/// Exponent of 2^(1.5 n) for an even n.
const fn exponent_of_1_5(even: i32) -> i32 {
    even + even / 2
}

/// Gain times 2^bits as the product of a number of 31 bits and a mantissa, 2^29 to 2^30, whose high
/// word has so many bits too many.
fn mantissa(gain: f32, bits: i32) -> (i32, i32) {
    let size = exponent(gain);
    // A gain of 0 is a mantissa of 0.
    let mantissa = fixed_from(gain, 29 - size);
    (mantissa, 29 - size - bits - 1)
}

/// Sine of a turn, 2^32 = once round, as Q31. The error is at most 6e-8.
#[inline(always)]
fn sine_at(turn: u32) -> i32 {
    /// Terms of `sin(π/2 x)/x` in powers of x², as Q30, beginning at the highest.
    const TERMS: [i32; 6] = {
        let half_pi = core::f64::consts::FRAC_PI_2;
        let mut terms = [0; 6];
        let (mut term, mut n) = (half_pi, 0);
        while n < 6 {
            terms[5 - n] = (term * 1_073_741_824.0) as i32;
            term *= -half_pi * half_pi / ((2 * n + 2) * (2 * n + 3)) as f64;
            n += 1;
        }
        terms
    };
    // Folded to -1 to 1 quarter turns, Q30: beyond a quarter the sine goes back.
    let quarters = turn as i32;
    let folded = if quarters.wrapping_add(1 << 30) < 0 { i32::MIN.wrapping_sub(quarters) } else { quarters };
    let x = fixed::saturating_shift_left(folded, 1).max(-i32::MAX);
    let square = fixed::times_q31(x, x);
    let sum = TERMS.iter().fold(0, |sum, &term| term.wrapping_add(fixed::times_q31(sum, square)));
    let value = (i64::from(sum) * i64::from(x)) >> 30;
    fixed::saturate(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_is_exact_to_1e_7_all_round() {
        let worst = (0..100_000u32).map(|step| step * 42_949).fold(0.0_f64, |worst, turn| {
            let exact = (f64::from(turn) / 4_294_967_296.0 * core::f64::consts::TAU).sin();
            worst.max((f64::from(sine_at(turn)) / 2_147_483_648.0 - exact).abs())
        });
        assert!(worst < 1e-7, "{worst:e}");
    }
}
