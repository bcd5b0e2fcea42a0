//! The exciter's band-pass: a fourth-order Butterworth filter whose band follows the strike's
//! strength (dynamic-filter §III-C, D).

use core::fmt;

use super::design::{Biquad, Root};
use crate::SampleRate;
use crate::square_root::length;
use crate::{exponential, sine};

/// A band whose edges follow the strike's level, its peak force over the reference force.
///
/// Both edges are multiplied by `level^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exciter {
    /// Lower edge (-3 dB) in Hz at level 1.
    pub low_hz: f64,
    /// Upper edge (-3 dB) in Hz at level 1.
    pub high_hz: f64,
    /// Exponent of the level, 0 for a constant band.
    pub exponent: f64,
}

/// Invalid band edges: `0 < low`, `1.05 low < high` and `high < fs/2` do not all hold.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BandError {
    /// Lower edge in Hz.
    pub low_hz: f64,
    /// Upper edge in Hz.
    pub high_hz: f64,
    /// Half the sample rate in Hz.
    pub nyquist_hz: f64,
}

impl fmt::Display for BandError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { low_hz, high_hz, nyquist_hz } = self;
        write!(
            f,
            "a band from {low_hz} Hz to {high_hz} Hz: give a lower edge of {} Hz or more, \
             and an upper edge of at least {} times that, below {nyquist_hz} Hz",
            2.0 * nyquist_hz * Exciter::LEAST_EDGE,
            Exciter::LEAST_RATIO
        )
    }
}

impl core::error::Error for BandError {}

impl Exciter {
    /// Lowest edge of a band, over fs.
    pub const LEAST_EDGE: f64 = 1e-4;
    /// Highest edge to which a strike moves the band, over fs.
    pub const LARGEST_EDGE: f64 = 0.49;
    /// Least ratio of the upper edge to the lower one.
    pub const LEAST_RATIO: f64 = 1.05;
    /// Largest size of the exponent.
    pub const LARGEST_EXPONENT: f64 = 4.0;

    /// Checks that the edges are valid at a rate.
    ///
    /// # Errors
    /// [`BandError`].
    pub fn check(&self, rate: SampleRate) -> Result<(), BandError> {
        let Self { low_hz, high_hz, .. } = *self;
        let nyquist_hz = rate.hz() / 2.0;
        let good =
            low_hz >= Self::LEAST_EDGE * rate.hz() && high_hz >= Self::LEAST_RATIO * low_hz && high_hz < nyquist_hz;
        if good { Ok(()) } else { Err(BandError { low_hz, high_hz, nyquist_hz }) }
    }

    /// Edges in Hz for a strike of a level (0 to 1): moved together, at most to 0.49 fs.
    pub fn edges_hz(&self, level: f64, rate: SampleRate) -> [f64; 2] {
        let factor = exponential::power(level.clamp(exponential::power_of_two(-31.0), 1.0), self.exponent) / rate.hz();
        let high = (self.high_hz * factor).clamp(2.0 * Self::LEAST_EDGE, Self::LARGEST_EDGE);
        let low = (self.low_hz * factor).clamp(Self::LEAST_EDGE, high / Self::LEAST_RATIO);
        [low, high].map(|edge| edge * rate.hz())
    }

    /// Derives the two sections for a strike of a level (0 to 1).
    ///
    /// # Errors
    /// [`BandError`].
    pub fn sections(&self, level: f64, rate: SampleRate) -> Result<[Biquad; 2], BandError> {
        self.check(rate)?;
        let [low, high] = self.edges_hz(level, rate);
        band_pass(low, high, rate)
    }
}

/// Derives a fourth-order Butterworth band-pass by the bilinear transform.
///
/// Its gain is 0 dB at the geometric middle of its warped edges, and -3.01 dB at the edges.
///
/// # Errors
/// [`BandError`].
pub fn band_pass(low_hz: f64, high_hz: f64, rate: SampleRate) -> Result<[Biquad; 2], BandError> {
    let nyquist_hz = rate.hz() / 2.0;
    if !(0.0 < low_hz && low_hz < high_hz && high_hz < nyquist_hz) {
        return Err(BandError { low_hz, high_hz, nyquist_hz });
    }
    let warp = |hz: f64| sine::tan(core::f64::consts::PI * hz / rate.hz());
    let (low, high) = (warp(low_hz), warp(high_hz));
    let (width, middle_squared) = (high - low, low * high);
    // The prototype's pole (-1 + i)/√2, low-pass to band-pass: s² - p B s + ω0² = 0.
    let half = width / 2.0 * core::f64::consts::FRAC_1_SQRT_2;
    let p = Root { real: -half, imaginary: half };
    // (pB/2)² - ω0², with (pB/2)² = -2i half².
    let root = square_root(Root { real: -middle_squared, imaginary: -2.0 * half * half });
    let middle = libm::sqrt(middle_squared);
    // z⁻¹ on the circle at the middle, where tan(θ/2) = ω0.
    let (cosine, sine) = ((1.0 - middle_squared) / (1.0 + middle_squared), 2.0 * middle / (1.0 + middle_squared));
    Ok([1.0, -1.0].map(|sign| {
        let s = Root { real: p.real + sign * root.real, imaginary: p.imaginary + sign * root.imaginary };
        // z = (1 + s) / (1 - s).
        let below = (1.0 - s.real) * (1.0 - s.real) + s.imaginary * s.imaginary;
        let pole = Root { real: (1.0 - s.square()) / below, imaginary: 2.0 * s.imaginary / below };
        // |1 - z⁻²| / |1 - 2 Re p z⁻¹ + |p|² z⁻²| at the middle.
        let (double_cosine, double_sine) = (cosine * cosine - sine * sine, 2.0 * sine * cosine);
        let above = length(1.0 - double_cosine, double_sine);
        let real = 1.0 - 2.0 * pole.real * cosine + pole.square() * double_cosine;
        let imaginary = 2.0 * pole.real * sine - pole.square() * double_sine;
        let gain = length(real, imaginary) / above;
        Biquad { pole, numerator: [gain, 0.0, -gain] }
    }))
}

fn square_root(z: Root) -> Root {
    let size = libm::sqrt(z.square());
    let real = libm::sqrt(((size + z.real) / 2.0).max(0.0));
    let imaginary = libm::sqrt(((size - z.real) / 2.0).max(0.0));
    Root { real, imaginary: if z.imaginary < 0.0 { -imaginary } else { imaginary } }
}
