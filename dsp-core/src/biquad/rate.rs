//! A biquad at another rate than the one that its poles and zeros are given for.

use super::design::{Biquad, BiquadError, Root};
use crate::SampleRate;

/// How far beyond half the rate a pole may stand and still be put there: the codec's clock is 186 ppm off.
const TOLERANCE: f64 = 1.001;

impl Biquad {
    /// The biquad for `rate` of one given at `rate_hz`: `p' = p^(rate_hz / rate)`, so that frequencies in Hz and decays in 1/s stay, and zeros likewise
    /// (those that would stand beyond half the rate, at half the rate). k is scaled such that |H| at the pole's own angle, the level of
    /// its resonance, stays. At the same rate nothing changes.
    ///
    /// An impulse-invariant mode comes out within 0.1 dB of the mode derived for that rate, near its resonance. `index` is for the message.
    ///
    /// # Errors
    /// [`BiquadError`]: what [`Biquad::check`] refuses, and [`BiquadError::BeyondNyquist`].
    pub fn carried(&self, index: usize, rate_hz: f64, rate: SampleRate) -> Result<Self, BiquadError> {
        self.check(index)?;
        let ratio = rate_hz / rate.hz();
        if ratio == 1.0 {
            return Ok(*self);
        }
        let angle = angle(self.pole) * ratio;
        if !(0.0..=core::f64::consts::PI * TOLERANCE).contains(&angle) {
            return Err(BiquadError::BeyondNyquist { biquad: index, angle: angle / core::f64::consts::PI });
        }
        let pole = carried(self.pole, ratio);
        let numerator = match (self.roots(), self.numerator) {
            (Some((gain, zeros)), _) => {
                let [one, other] = zeros.map(|zero| carried(zero, ratio));
                if one.imaginary != 0.0 {
                    [gain, -2.0 * gain * one.real, gain * one.square()]
                } else {
                    [gain, -gain * (one.real + other.real), gain * one.real * other.real]
                }
            }
            // A delay and one zero, or only a delay.
            (None, [_, b1, b2]) if b1 != 0.0 => {
                [0.0, b1, -b1 * carried(Root { real: -b2 / b1, imaginary: 0.0 }, ratio).real]
            }
            (None, numerator) => numerator,
        };
        let given = magnitude(self.pole, self.numerator);
        let got = magnitude(pole, numerator);
        let gain = if got > 0.0 { given / got } else { 1.0 };
        Ok(Self { pole, numerator: numerator.map(|b| b * gain) })
    }
}

fn angle(root: Root) -> f64 {
    libm::atan2(root.imaginary.abs(), root.real)
}

/// `root^ratio`, its angle at most half a turn; a negative one stays negative.
fn carried(root: Root, ratio: f64) -> Root {
    let radius = libm::sqrt(root.square());
    // Near 1 the gap is what matters, and `ln(1 - gap)` is exact.
    let radius = if radius > 0.0 { libm::exp(ratio * libm::log(radius)) } else { 0.0 };
    let turned = angle(root) * ratio;
    if turned >= core::f64::consts::PI || (root.imaginary == 0.0 && root.real < 0.0) {
        Root { real: -radius, imaginary: 0.0 }
    } else {
        Root::polar(radius, turned)
    }
}

/// |H| on the circle at the pole's angle.
fn magnitude(pole: Root, [b0, b1, b2]: [f64; 3]) -> f64 {
    let theta = angle(pole);
    let at = |[c0, c1, c2]: [f64; 3]| {
        libm::hypot(
            c0 + c1 * libm::cos(theta) + c2 * libm::cos(2.0 * theta),
            c1 * libm::sin(theta) + c2 * libm::sin(2.0 * theta),
        )
    };
    // The denominator from its factors: near the circle the sum of its terms has lost their digits.
    let radius = libm::sqrt(pole.square());
    let other = libm::hypot(libm::cos(theta) - radius * libm::cos(theta), libm::sin(theta) + radius * libm::sin(theta));
    at([b0, b1, b2]) / ((1.0 - radius) * other)
}
