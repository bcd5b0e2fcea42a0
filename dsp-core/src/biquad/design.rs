//! A biquad as poles and zeros, what is refused, and modes as biquads.

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
    /// From magnitude and angle in radians.
    pub fn polar(radius: f64, angle: f64) -> Self {
        Self { real: radius * libm::cos(angle), imaginary: radius * libm::sin(angle) }
    }

    /// `|z|²`.
    pub fn square(self) -> f64 {
        self.real * self.real + self.imaginary * self.imaginary
    }
}

/// A section `(b0 + b1 z⁻¹ + b2 z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)`: diffmodal's eq. 2, with any numerator ([`Biquad::from_roots`] is the paper's).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biquad {
    /// p, within the unit circle.
    pub pole: Root,
    /// b0, b1, b2.
    pub numerator: [f64; 3],
}

/// Why biquads are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BiquadError {
    /// A number that is not finite.
    NotFinite {
        /// The biquad, counted from 0.
        biquad: usize,
    },
    /// A pole on or outside the unit circle (or so near that Q32 cannot tell): it would ring for ever.
    UnstablePole {
        /// The biquad, counted from 0.
        biquad: usize,
        /// `|p|`.
        radius: f64,
    },
    /// A section whose gain, summed over its impulse response, is too large for the arithmetic.
    UnboundedGain {
        /// The biquad, counted from 0.
        biquad: usize,
        /// Bound of the sum of the sizes of its impulse response.
        gain: f64,
    },
    /// A real pole, one at 0, or one that coincides with another of its chain: no mode rings like that.
    NoMode {
        /// The biquad, counted from 0.
        biquad: usize,
    },
    /// A pole that would stand beyond half the rate to which it is carried.
    BeyondNyquist {
        /// The biquad, counted from 0.
        biquad: usize,
        /// Its angle there in half turns: 1 is half the rate.
        angle: f64,
    },
    /// Not 1 to 4 sections a chain, or the sections are no whole chains.
    Depth {
        /// Sections a chain.
        depth: usize,
        /// Sections in all.
        sections: usize,
    },
    /// More sections than the bank has room for.
    Full {
        /// Sections given.
        sections: usize,
        /// Sections that fit.
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
                "biquad {biquad}: a gain of up to {gain}: at most {} is possible; lower k or move the zeros to the poles",
                Biquad::MAX_GAIN
            ),
            Self::NoMode { biquad } => {
                write!(f, "biquad {biquad}: its pole is real, or another's too: play it as a biquad, or move the pole")
            }
            Self::BeyondNyquist { biquad, angle } => write!(
                f,
                "biquad {biquad}: at this rate its pole would stand at {angle} of half the rate: leave it out, or play at the rate of the table"
            ),
            Self::Depth { depth, sections } => {
                write!(f, "{sections} sections in chains of {depth}: give whole chains of 1 to 4 sections")
            }
            Self::Full { sections, room } => write!(f, "{sections} sections where {room} fit: give fewer"),
        }
    }
}

impl core::error::Error for BiquadError {}

impl Biquad {
    /// The largest pole radius: beyond it δ would be less than 43 steps of Q32, and a decay would be off by more than 1 %.
    pub const MAX_POLE_RADIUS: f64 = 1.0 - 5e-9;
    /// The largest sum of an impulse response's sizes, 2^30.
    pub const MAX_GAIN: f64 = 1_073_741_824.0;

    /// `k (1 - 2 Re q z⁻¹ + |q|² z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)`, diffmodal eq. 2.
    pub fn from_roots(pole: Root, zero: Root, gain: f64) -> Self {
        Self { pole, numerator: [gain, -2.0 * gain * zero.real, gain * zero.square()] }
    }

    /// k and the zeros q as a conjugate pair, or as two real ones (larger first). `None` without b0.
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

    /// Whether its numbers are numbers and its poles within the unit circle; `index` is for the message.
    ///
    /// # Errors
    /// [`BiquadError::NotFinite`], [`BiquadError::UnstablePole`].
    pub fn check(&self, index: usize) -> Result<(), BiquadError> {
        let Self { pole, numerator: [b0, b1, b2] } = *self;
        if ![pole.real, pole.imaginary, b0, b1, b2].iter().all(|x| x.is_finite()) {
            return Err(BiquadError::NotFinite { biquad: index });
        }
        let radius = libm::hypot(pole.real, pole.imaginary);
        if radius > Self::MAX_POLE_RADIUS {
            return Err(BiquadError::UnstablePole { biquad: index, radius });
        }
        Ok(())
    }
}
