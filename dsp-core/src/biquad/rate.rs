//! A biquad at another rate than the one that its poles and zeros are given for.

use super::design::{Biquad, BiquadError, Root};
use crate::SampleRate;
use crate::square_root::length;
use crate::{exponential, sine};
use core::f64::consts::PI;

/// Largest ratio of a pole's frequency to half the rate at which the pole is moved to half the
/// rate.
///
/// A pole at half the nominal rate must stay playable: the codec's clock is 186 ppm off.
const TOLERANCE: f64 = 1.001;

/// Product of two zeros' distances from a point of the circle, below which |H| there is not kept.
const VANISHING: f64 = 1e-6;

impl Biquad {
    /// Makes the biquad for `rate` from a table's pole pair, zero pair and gain for `rate_hz`.
    ///
    /// Frequencies in Hz and decays in 1/s stay, and so does the level of the resonance. The law,
    /// with ρ = `rate_hz` / rate and `arg` from 0 to π:
    ///
    /// ```text
    /// p' = |p|^ρ at the angle min(ρ arg p, π),   q' = |q|^ρ at the angle min(ρ arg q, π)
    /// k' = k |H(e^iθ)| / |H'(e^iθ')|,   θ = arg p,  θ' = arg p'
    /// ```
    ///
    /// k' = k if the product of the zeros' distances from `e^iθ` or from `e^iθ'` is below 1e-6: a
    /// level that nearly vanishes cannot be kept.
    ///
    /// The law holds for every root. A real root below 0 is a pair at half the table's rate, and
    /// keeps that frequency at any other rate. At the table's own rate nothing changes.
    ///
    /// `index` is the number of the biquad, for the message.
    ///
    /// # Errors
    /// [`BiquadError`]: those of [`Biquad::check`], and [`BiquadError::BeyondNyquist`].
    pub fn from_roots_at(
        index: usize,
        (pole, zero, gain): (Root, Root, f64),
        rate_hz: f64,
        rate: SampleRate,
    ) -> Result<Self, BiquadError> {
        let given = Self::from_roots(pole, zero, gain);
        given.check(index)?;
        let ratio = rate_hz / rate.hz();
        if ratio == 1.0 {
            return Ok(given);
        }
        check_angle(index, pole, ratio)?;
        let [new_pole, new_zero] = [pole, zero].map(|root| raised(root, ratio));
        let (before, after) = (distances(zero, angle(pole)), distances(new_zero, angle(new_pole)));
        let of_poles = distances(new_pole, angle(new_pole)) / distances(pole, angle(pole));
        let same = if before < VANISHING || after < VANISHING { 1.0 } else { before / after * of_poles };
        Ok(Self::from_roots(new_pole, new_zero, gain * same))
    }

    /// Converts a biquad for `rate_hz`, with any numerator, to `rate`.
    ///
    /// Poles and pairs of zeros follow the law of [`from_roots_at`](Self::from_roots_at). Real
    /// zeros that differ keep their signs; a mode may have such zeros, a table has none.
    ///
    /// Near its resonance, a converted impulse-invariant mode is within 0.1 dB of the mode derived
    /// for that rate. `index` is the number of the biquad, for the message.
    ///
    /// # Errors
    /// [`BiquadError`]: those of [`Biquad::check`], and [`BiquadError::BeyondNyquist`].
    pub fn carried(&self, index: usize, rate_hz: f64, rate: SampleRate) -> Result<Self, BiquadError> {
        self.check(index)?;
        let ratio = rate_hz / rate.hz();
        if ratio == 1.0 {
            return Ok(*self);
        }
        check_angle(index, self.pole, ratio)?;
        let pole = raised(self.pole, ratio);
        let numerator = match (self.roots(), self.numerator) {
            (Some((gain, [one, other])), _) if one.imaginary == 0.0 && one.real != other.real => {
                let [one, other] = [one.real, other.real].map(|real| raised_real(real, ratio));
                [gain, -gain * (one + other), gain * one * other]
            }
            (Some((gain, [zero, _])), _) => Self::from_roots(pole, raised(zero, ratio), gain).numerator,
            // A delay and one zero, or only a delay.
            (None, [_, b1, b2]) if b1 != 0.0 => [0.0, b1, -b1 * raised_real(-b2 / b1, ratio)],
            (None, numerator) => numerator,
        };
        let level = |pole: Root, numerator| size(numerator, angle(pole)) / distances(pole, angle(pole));
        let (before, after) = (level(self.pole, self.numerator), level(pole, numerator));
        let gain = if after > 0.0 { before / after } else { 1.0 };
        Ok(Self { pole, numerator: numerator.map(|b| b * gain) })
    }
}

/// Refuses a pole that would stand beyond half the rate.
fn check_angle(biquad: usize, pole: Root, ratio: f64) -> Result<(), BiquadError> {
    let half_turns = angle(pole) * ratio / PI;
    if half_turns > TOLERANCE { Err(BiquadError::BeyondNyquist { biquad, angle: half_turns }) } else { Ok(()) }
}

/// Angle of a root, from 0 to π.
fn angle(root: Root) -> f64 {
    libm::atan2(root.imaginary.abs(), root.real)
}

/// Raises a root to the power `ratio`; its angle becomes at most half a turn.
fn raised(root: Root, ratio: f64) -> Root {
    let turned = angle(root) * ratio;
    let radius = exponential::power(libm::sqrt(root.square()), ratio);
    if turned >= PI { Root { real: -radius, imaginary: 0.0 } } else { Root::polar(radius, turned) }
}

/// Raises the size of a real number to the power `ratio`, and keeps its sign.
fn raised_real(real: f64, ratio: f64) -> f64 {
    libm::copysign(exponential::power(real.abs(), ratio), real)
}

/// Product `|1 - r e^{i(α-θ)}| |1 - r e^{i(α+θ)}|` of the distances of roots `r e^{±iα}` from
/// `e^{iθ}`.
///
/// It uses the distances themselves: near the circle a polynomial's sum loses the digits of its
/// terms.
fn distances(root: Root, theta: f64) -> f64 {
    let (radius, alpha) = (libm::sqrt(root.square()), angle(root));
    let distance = |between: f64| {
        // |1 - r e^{iβ}|² = (1 - r)² + 4 r sin²(β/2).
        let sine = sine::sin(between / 2.0);
        libm::sqrt((1.0 - radius) * (1.0 - radius) + 4.0 * radius * sine * sine)
    };
    distance(alpha - theta) * distance(alpha + theta)
}

/// Size `|b0 + b1 z⁻¹ + b2 z⁻²|` on the circle at the angle θ.
fn size([b0, b1, b2]: [f64; 3], theta: f64) -> f64 {
    length(
        b0 + b1 * sine::cos(theta) + b2 * sine::cos(2.0 * theta),
        b1 * sine::sin(theta) + b2 * sine::sin(2.0 * theta),
    )
}
