//! The exact sample rate.

use core::fmt;
use core::num::NonZeroU32;

/// A sample rate in Hz as a ratio, because clocks divide: 86 000 000 / 1792 is not 47 991.
///
/// ```
/// let board = dsp_core::SampleRate::new(86_000_000, 1792).unwrap();
/// assert!((board.hz() - 47_991.071_43).abs() < 1e-4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SampleRate {
    numerator: u32,
    denominator: NonZeroU32,
}

impl SampleRate {
    /// Lowest rate of the engine, in Hz.
    pub const MIN_HZ: f64 = 8_000.0;
    /// Highest rate of the engine, in Hz.
    pub const MAX_HZ: f64 = 192_000.0;

    /// Makes a rate of `numerator / denominator` Hz.
    ///
    /// Returns `None` if it is not from [`MIN_HZ`](Self::MIN_HZ) to [`MAX_HZ`](Self::MAX_HZ).
    pub fn new(numerator: u32, denominator: u32) -> Option<Self> {
        let rate = Self { numerator, denominator: NonZeroU32::new(denominator)? };
        (Self::MIN_HZ..=Self::MAX_HZ).contains(&rate.hz()).then_some(rate)
    }

    /// Rate of 48 kHz.
    pub const HZ_48000: Self = Self { numerator: 48_000, denominator: NonZeroU32::MIN };
    /// Rate of 44.1 kHz.
    pub const HZ_44100: Self = Self { numerator: 44_100, denominator: NonZeroU32::MIN };

    /// The rate in Hz.
    pub fn hz(self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator.get())
    }

    /// The rate in Hz within 2^-22, for values derived while sound plays: `f64` is slow software
    /// there.
    pub(crate) fn hz_f32(self) -> f32 {
        self.numerator as f32 / self.denominator.get() as f32
    }

    /// The rate as (numerator, denominator).
    pub const fn ratio(self) -> (u32, u32) {
        (self.numerator, self.denominator.get())
    }
}

impl fmt::Display for SampleRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.denominator.get() {
            1 => write!(f, "{} Hz", self.numerator),
            _ => write!(f, "{}/{} Hz", self.numerator, self.denominator),
        }
    }
}
