//! The sample rate as an exact ratio, as a clock tree makes it.

/// Sample rate in hertz, `numerator / denominator`.
///
/// It is a ratio because hardware divides clocks: 86 000 000 / 1792 Hz is 47 991.071... A rate
/// rounded to whole hertz would detune every mode. Both parts must be above zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleRate {
    /// Clock frequency in hertz.
    pub numerator: u32,
    /// Divider of the clock.
    pub denominator: u32,
}

impl SampleRate {
    /// The rate `fs` in hertz.
    pub fn hz(self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }
}
