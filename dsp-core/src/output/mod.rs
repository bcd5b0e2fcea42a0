//! Output: level and pan of a pad, the stereo sum, and the one step to 24 bits.

use crate::fixed;
use crate::{exponential, sine};

/// Level and constant-power pan of a pad: left `g cos((p+1) π/4)`, right `g sin((p+1) π/4)`, g =
/// 10^(dB/20).
///
/// A side is `x 2^k M / 2^32`, one rounded multiply by a Q32 mantissa M. The smallest k is chosen
/// for which the louder side's mantissa fits: 0 below -6 dB. The result is exact to half a bus
/// step, with k above 0 only up to +18 dBFS.
#[derive(Clone, Copy, Debug)]
pub struct Panner {
    left: i32,
    right: i32,
    shift: u32,
}

/// Gains of both sides as Q32 mantissas, for a sample times 2^shift.
#[derive(Clone, Copy, Debug)]
pub struct Gains {
    /// Mantissa of the left side, Q32.
    pub left: i32,
    /// Mantissa of the right side, Q32.
    pub right: i32,
    /// Number of doublings of the sample, 0 or 1.
    pub shift: u32,
}

impl Panner {
    /// A panner whose output is silent.
    pub const SILENT: Self = Self { left: 0, right: 0, shift: 0 };

    /// Makes a panner from a level in dB and a pan from -1 (left) to 1 (right).
    pub fn new(level_db: f32, pan: f32) -> Self {
        let level = exponential::ratio_of_db(f64::from(level_db));
        let angle = (f64::from(pan) + 1.0) * core::f64::consts::FRAC_PI_4;
        let (left, right) = (level * sine::cos(angle), level * sine::sin(angle));
        let loudest = left.max(right);
        // Mantissas stay below 1/2: `as` saturates 1/2 itself to a step less.
        let shift = (0..30).find(|&shift| loudest <= f64::from(1u32 << shift) / 2.0).unwrap_or(30);
        let mantissa = |gain: f64| libm::rint(gain * TWO_POW_32 / f64::from(1u32 << shift)) as i32;
        Self { left: mantissa(left), right: mantissa(right), shift }
    }

    /// Mantissas of both sides and k, or `None` if a bus of that loudness needs clipping.
    #[inline(always)]
    pub fn gains(&self, is_loud: bool) -> Option<Gains> {
        let Self { left, right, shift, .. } = *self;
        (shift <= u32::from(!is_loud)).then_some(Gains { left, right, shift })
    }

    /// Gain of the louder side.
    pub fn loudest(&self) -> f32 {
        let [left, right] = self.factors();
        left.max(right)
    }

    /// Gains of the left and the right side.
    pub fn factors(&self) -> [f32; 2] {
        let unit = (1u32 << self.shift) as f32 / TWO_POW_32 as f32;
        [self.left as f32 * unit, self.right as f32 * unit]
    }

    /// Adds a pad's run to the stereo sum, saturating.
    pub fn render(&self, pad: &[i32], out: &mut [[i32; 2]]) {
        if self.shift == 0 {
            return self.render_halved(pad, out);
        }
        self.render_shifted(pad, out);
    }

    /// Adds a run at gains above a half.
    #[inline(never)] // its code must not weigh on quieter pads
    fn render_shifted(&self, pad: &[i32], out: &mut [[i32; 2]]) {
        let room = i32::MAX >> self.shift;
        for (&sample, [left, right]) in pad.iter().zip(out) {
            let side = |mantissa: i32| match sample.unsigned_abs() <= room.unsigned_abs() {
                true => fixed::smmulr(sample << self.shift, mantissa),
                // Louder than +18 dBFS: the last bits do not matter, clipping does.
                false => fixed::saturating_shift_left(fixed::smmulr(sample, mantissa), self.shift),
            };
            *left = fixed::qadd(*left, side(self.left));
            *right = fixed::qadd(*right, side(self.right));
        }
    }

    /// Adds a run at gains of at most a half. No sample needs clipping before the sum, which saves
    /// 11 cycles a frame (docs/frames.md).
    fn render_halved(&self, pad: &[i32], out: &mut [[i32; 2]]) {
        let add = |sample: i32, [left, right]: &mut [i32; 2]| {
            *left = fixed::qadd(*left, fixed::smmulr(sample, self.left));
            *right = fixed::qadd(*right, fixed::smmulr(sample, self.right));
        };
        let (pairs, last) = pad.as_chunks::<2>();
        let (out_pairs, out_last) = out.split_at_mut(out.len().min(2 * pairs.len()));
        for ([a, b], [out_a, out_b]) in pairs.iter().zip(out_pairs.as_chunks_mut::<2>().0) {
            add(*a, out_a);
            add(*b, out_b);
        }
        for (sample, out) in last.iter().zip(out_last) {
            add(*sample, out);
        }
    }
}

const TWO_POW_32: f64 = 4294967296.0;

/// Turns the stereo bus (Q4.27) into signed 24-bit samples, in place.
pub fn to_24_bit(out: &mut [[i32; 2]]) {
    // Two frames at a time: built for size, the loop around each sample costs as much as the
    // sample.
    let (pairs, last) = out.as_chunks_mut::<2>();
    for [[a, b], [c, d]] in pairs {
        (*a, *b) = (fixed::to_24_bit(*a), fixed::to_24_bit(*b));
        (*c, *d) = (fixed::to_24_bit(*c), fixed::to_24_bit(*d));
    }
    for sample in last.iter_mut().flatten() {
        *sample = fixed::to_24_bit(*sample);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::ONE_Q27;

    #[test]
    fn pan_keeps_the_power_and_level_is_in_db() {
        for pan in [-1.0f32, -0.3, 0.0, 0.5, 1.0] {
            let mut out = [[0, 0]];
            Panner::new(-6.0, pan).render(&[ONE_Q27], &mut out);
            let [left, right] = out[0].map(|x| f64::from(x) / f64::from(ONE_Q27));
            assert!(((left * left + right * right).sqrt() - 10f64.powf(-0.3)).abs() < 1e-8, "{pan}");
        }
    }
}
