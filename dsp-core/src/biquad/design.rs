//! A biquad as poles and zeros, and the reasons to refuse one.

use crate::sine;
use crate::square_root::length;
use core::fmt;

/// One of a pair of conjugate roots in the z-plane, `real ± i·imaginary`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Root {
    /// Real part.
    pub real: f64,
    /// Imaginary part; its sign does not matter.
    pub imaginary: f64,
}

impl Root {
    /// Makes a root from magnitude and angle in radians.
    pub fn polar(radius: f64, angle: f64) -> Self {
        Self { real: radius * sine::cos(angle), imaginary: radius * sine::sin(angle) }
    }

    /// Square of the magnitude, `|z|²`.
    pub fn square(self) -> f64 {
        self.real * self.real + self.imaginary * self.imaginary
    }
}

/// A section `(b0 + b1 z⁻¹ + b2 z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)`.
///
/// It is diffmodal's eq. 2 with any numerator; [`Biquad::from_roots`] gives the paper's numerator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biquad {
    /// Pole p, within the unit circle.
    pub pole: Root,
    /// Coefficients b0, b1 and b2.
    pub numerator: [f64; 3],
}

/// Reason to refuse biquads.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BiquadError {
    /// A pole, zero or gain that is not finite.
    NotFinite {
        /// The biquad, counted from 0.
        biquad: usize,
    },
    /// A pole that would ring for ever: on or outside the unit circle, or too near to it for Q32.
    UnstablePole {
        /// The biquad, counted from 0.
        biquad: usize,
        /// Radius of the pole, `|p|`.
        radius: f64,
    },
    /// A section whose gain, summed over its impulse response, is too large for the arithmetic.
    UnboundedGain {
        /// The biquad, counted from 0.
        biquad: usize,
        /// Bound of the sum of the sizes of its impulse response.
        gain: f64,
    },
    /// A real pole, one at 0, or one that coincides with another of its chain: no mode rings like
    /// that.
    NoMode {
        /// The biquad, counted from 0.
        biquad: usize,
    },
    /// A pole that would stand beyond half the rate to which it is carried.
    BeyondNyquist {
        /// The biquad, counted from 0.
        biquad: usize,
        /// Angle of the pole at the new rate in half turns: 1 is half the rate.
        angle: f64,
    },
    /// Chains that are not of 1 to 4 sections, or a last chain that is not complete.
    Depth {
        /// Number of sections in a chain.
        depth: usize,
        /// Number of sections in all.
        sections: usize,
    },
    /// More sections than the bank has room for.
    Full {
        /// Number of sections given.
        sections: usize,
        /// Number of sections that fit.
        room: usize,
    },
}

impl fmt::Display for BiquadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite { biquad } => {
                write!(f, "biquad {biquad}: a pole, zero or gain is not finite: give numbers")
            }
            Self::UnstablePole { biquad, radius } => write!(
                f,
                "biquad {biquad}: a pole of radius {radius} does not decay: give one below {}",
                Biquad::MAX_POLE_RADIUS
            ),
            Self::UnboundedGain { biquad, gain } => write!(
                f,
                "biquad {biquad}: its gain may reach {gain}, but at most {} is possible: lower k or move the zeros to the poles",
                Biquad::MAX_GAIN
            ),
            Self::NoMode { biquad } => {
                write!(
                    f,
                    "biquad {biquad}: its pole is real or coincides with another: play it as a biquad or move the pole"
                )
            }
            Self::BeyondNyquist { biquad, angle } => write!(
                f,
                "biquad {biquad}: its pole would stand at {angle} of half this rate: leave it out or play at the table's rate"
            ),
            Self::Depth { depth, sections } => {
                write!(f, "{sections} sections in chains of {depth}: give whole chains of 1 to 4 sections")
            }
            Self::Full { sections, room } => write!(f, "{sections} sections are given, but {room} fit: give fewer"),
        }
    }
}

impl core::error::Error for BiquadError {}

impl Biquad {
    /// Largest pole radius.
    ///
    /// With a larger one δ would be less than 43 steps of Q32, and a decay off by more than 1 %.
    pub const MAX_POLE_RADIUS: f64 = 1.0 - 5e-9;
    /// Largest sum of the sizes of an impulse response, 2^30.
    pub const MAX_GAIN: f64 = 1_073_741_824.0;

    /// Makes the section of diffmodal's eq. 2 from pole p, zero q and gain k.
    ///
    /// `H(z) = k (1 - 2 Re q z⁻¹ + |q|² z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)`.
    pub fn from_roots(pole: Root, zero: Root, gain: f64) -> Self {
        Self { pole, numerator: [gain, -2.0 * gain * zero.real, gain * zero.square()] }
    }

    /// Gain k and both zeros, a conjugate pair or two real ones (larger first). `None` if b0 is 0.
    pub fn roots(&self) -> Option<(f64, [Root; 2])> {
        let [b0, b1, b2] = self.numerator;
        let (half, square) = (-b1 / b0 / 2.0, b2 / b0);
        let rest = square - half * half;
        let root = libm::sqrt(rest.abs());
        let pair = if rest >= 0.0 {
            [root, -root].map(|imaginary| Root { real: half, imaginary })
        } else {
            [half + root, half - root].map(|real| Root { real, imaginary: 0.0 })
        };
        (b0 != 0.0).then_some((b0, pair))
    }

    /// Checks that all numbers are finite and the poles within the unit circle.
    ///
    /// `index` is the number of the biquad, for the message.
    ///
    /// # Errors
    /// [`BiquadError::NotFinite`], [`BiquadError::UnstablePole`].
    pub fn check(&self, index: usize) -> Result<(), BiquadError> {
        let Self { pole, numerator: [b0, b1, b2] } = *self;
        if ![pole.real, pole.imaginary, b0, b1, b2].iter().all(|x| x.is_finite()) {
            return Err(BiquadError::NotFinite { biquad: index });
        }
        let radius = length(pole.real, pole.imaginary);
        if radius > Self::MAX_POLE_RADIUS {
            return Err(BiquadError::UnstablePole { biquad: index, radius });
        }
        Ok(())
    }
}
