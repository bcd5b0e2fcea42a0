//! Force of a ball that rolls (scraping-rolling eq. 15 to 19).
//!
//! The penetration is `ρ = ρ0 - r cos(x/R) + S`, at least 0. The paper's R before it is a constant
//! height; here it is the resting depth ρ0, at which `k ρ0^1.5` carries the ball's weight. What
//! changes below 20 Hz, the weight and its slow shifts from side to side, moves the object as a
//! whole and is left out: a ball at rest is silent.

use super::power::Powers;
use super::ramp::{Normal, Ramp, fixed_from, power_of_two};
use super::scale::Gain;
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

/// Largest depth, Q30.
const LARGEST: i32 = (1 << 30) - 1;

/// State of a ball.
#[derive(Clone, Debug)]
pub(super) struct Roll {
    ball: Rolling,
    units: Units,
    /// Turn of the ball, 2^48 = once round.
    turn: i64,
    powers: Powers,
    /// Largest depth that is rendered, in metres.
    largest_m: f32,
    /// Resting depth and offset, Q30 of the largest depth.
    rest: i32,
    offset: i32,
    /// Height of the path, Q62 of the largest depth.
    height: i64,
    force: Gain,
    /// Force below [`LOWEST_HZ`], Q59 of the force bus, and its share of a frame's force, Q32.
    slow: i64,
    share: i32,
}

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

/// Numbers that stay the same, or go in straight lines, over a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rolled {
    /// Turn in a frame and its step from frame to frame, 2^48 = once round.
    turn: [i64; 2],
    /// From the slope to the height's rise, and the shift of the product to the left, or to the
    /// right.
    rise: Ramp,
    rise_left: u32,
    rise_right: u32,
    /// From slope and sine to `λ/k ρ'`, with the shift of their sum.
    slope_rate: Ramp,
    turn_rate: Ramp,
    left: u32,
    right: u32,
    less: i32,
}

impl Roll {
    /// Ball that carries `weight_n` at rest.
    pub(super) fn new(ball: Rolling, weight_n: f32, units: Units) -> Self {
        let depth = |force_n: f32| exponential::power(f64::from(force_n / ball.stiffness), 2.0 / 3.0) as f32;
        let rest_m = if weight_n > 0.0 { depth(weight_n) } else { 0.0 };
        let largest_m = 2.0 * (rest_m + ball.offset_m + units.height_m);
        let root = crate::square_root::rounded_root(largest_m);
        let turns = core::f32::consts::TAU * LOWEST_HZ / units.rate.hz_f32();
        let mut roll = Self {
            ball,
            units,
            turn: 0,
            powers: Powers::new(1.5),
            largest_m,
            rest: fixed_from(rest_m / largest_m, 30),
            offset: fixed_from(ball.offset_m / largest_m, 30),
            height: 0,
            force: Gain::new(ball.stiffness * largest_m * root / units.force_n, 27),
            slow: 0,
            share: fixed_from(turns, 32),
        };
        roll.slow = i64::from(roll.spring(roll.rest)) << 32;
        roll
    }

    /// Share of the normal force at the ball's turn, moving at a signed speed: it is largest where
    /// the centre of mass moves down.
    pub(super) fn normal_share(&self, is_backwards: bool) -> f32 {
        let sine = sine_at((self.turn >> 16) as u32) as f32 * power_of_two(-31);
        1.0 + self.ball.modulation * if is_backwards { sine } else { -sine }
    }

    /// Largest and least share of the normal force.
    pub(super) fn normal_shares(&self) -> [f32; 2] {
        [1.0 - self.ball.modulation, 1.0 + self.ball.modulation]
    }

    /// Prepares a tick with the speeds at its ends in m/s, and the share of the height, Q32, that
    /// is lost in a frame, with its sign.
    pub(super) fn prepared(&self, speeds: [f32; 2], less: i32) -> Rolled {
        let frame_s = 1.0 / self.units.rate.hz_f32();
        let turn_a_frame = frame_s / (core::f32::consts::TAU * self.ball.radius_m);
        let [from, to] = speeds.map(|speed| (speed * turn_a_frame * power_of_two(48)) as i64);
        // The high word of a slope of 28 bits and a gain of n bits has n - 4, that of a sine n - 1.
        let rise = Normal::new(speeds.map(|speed| speed * self.units.slope * frame_s / self.largest_m), 60);
        let damping = self.ball.dissipation / self.ball.stiffness;
        let slope_rate = speeds.map(|speed| damping * speed * self.units.slope);
        let turn_rate = speeds.map(|speed| damping * speed * self.ball.offset_m / self.ball.radius_m);
        let bits = Normal::new(slope_rate, 60).bits.min(Normal::new(turn_rate, 60).bits + 3).max(0);
        let left = 27 - (bits - 4);
        Rolled {
            turn: [from, (to - from) / TICK_FRAMES as i64],
            rise: Ramp::new(rise.values),
            rise_left: (34 - rise.bits).clamp(0, 31) as u32,
            rise_right: (rise.bits - 34).clamp(0, 31) as u32,
            slope_rate: Ramp::new(slope_rate.map(|rate| fixed_from(rate, bits))),
            turn_rate: Ramp::new(turn_rate.map(|rate| fixed_from(rate, bits - 3))),
            left: left.clamp(0, 31) as u32,
            right: (-left).clamp(0, 31) as u32,
            less,
        }
    }

    /// Force of the next frame, Q27, for the path's slope, Q28 of its unit.
    #[inline(always)]
    pub(super) fn next(&mut self, tick: &mut Rolled, slope: i32) -> i32 {
        tick.turn[0] += tick.turn[1];
        self.turn = self.turn.wrapping_add(tick.turn[0]);
        let turn = (self.turn >> 16) as u32;
        let product = i64::from(slope) * i64::from(tick.rise.next());
        let rise = match tick.rise_left {
            0 => product >> tick.rise_right,
            left => {
                i64::from(fixed::saturating_shift_left((product >> 32) as i32, left).clamp(-LARGEST, LARGEST)) << 32
            }
        };
        // Each is below 2^62.
        let height = self.height + i64::from((self.height >> 32) as i32) * i64::from(tick.less) + rise;
        let high = ((height >> 32) as i32).clamp(-LARGEST - 1, LARGEST);
        self.height = (i64::from(high) << 32) | (height & i64::from(u32::MAX));
        let depth = self.rest - fixed::times_q31(self.offset, sine_at(turn.wrapping_add(1 << 30))) + high;
        let spring = self.spring(depth.clamp(0, LARGEST));
        let rate = fixed::smmul(slope, tick.slope_rate.next()) + fixed::smmul(sine_at(turn), tick.turn_rate.next());
        // The ball does not pull: the factor 1 + λ/k ρ' is 0 at least.
        let factor = fixed::qadd(fixed::saturating_shift_left(rate >> tick.right, tick.left), 1 << 27).max(0);
        let force = fixed::saturate((i64::from(spring) * i64::from(factor)) >> 27);
        let fast = fixed::qsub(force, (self.slow >> 32) as i32);
        self.slow += i64::from(fast) * i64::from(self.share);
        fast
    }

    /// Force of a depth, Q27.
    #[inline(always)]
    fn spring(&self, depth: i32) -> i32 {
        self.force.apply_to(self.powers.of((depth as u64) << 33))
    }
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
