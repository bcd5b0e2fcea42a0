//! Output: level and pan of a pad, the stereo sum, and the one step to 24 bits.

use crate::fixed::{self, Scale};

/// Level and constant-power pan of a pad: left `g cos((p+1) π/4)`, right `g sin((p+1) π/4)`, g = 10^(dB/20).
///
/// Exact to half a bus step a pad; about 20 cycles a frame on a Cortex-M4.
#[derive(Clone, Copy, Debug)]
pub struct Panner {
    left: Scale,
    right: Scale,
    loudest: f32,
}

impl Panner {
    /// Lets nothing through.
    pub const SILENT: Self = Self { left: Scale::ZERO, right: Scale::ZERO, loudest: 0.0 };

    /// `level_db` in dB, `pan` from -1 (left) to 1 (right).
    pub fn new(level_db: f32, pan: f32) -> Self {
        let level = libm::pow(10.0, f64::from(level_db) / 20.0);
        let angle = (f64::from(pan) + 1.0) * core::f64::consts::FRAC_PI_4;
        let (left, right) = (level * libm::cos(angle), level * libm::sin(angle));
        Self { left: Scale::new(left), right: Scale::new(right), loudest: left.max(right) as f32 }
    }

    /// The gain of the louder side.
    pub fn loudest(&self) -> f32 {
        self.loudest
    }

    /// Adds a pad's run to the stereo sum, saturating.
    pub fn render(&self, pad: &[i32], out: &mut [[i32; 2]]) {
        for (&sample, [left, right]) in pad.iter().zip(out) {
            *left = fixed::qadd(*left, self.left.apply(sample));
            *right = fixed::qadd(*right, self.right.apply(sample));
        }
    }
}

/// Turns the stereo bus (Q4.27) into signed 24-bit samples, in place.
pub fn to_24_bit(out: &mut [[i32; 2]]) {
    for sample in out.iter_mut().flatten() {
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
