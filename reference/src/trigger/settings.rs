//! How a pad is triggered.

/// A second sensor of a pad, such as a rim's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// Its ADC channel.
    pub channel: usize,
    /// Which of the pad's strikers it plays.
    pub striker: usize,
    /// How much it counts more than the first sensor when the two are compared, in dB.
    pub gain_db: f64,
}

/// Settings of one pad with a piezo; values are trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiezoSettings {
    /// Its ADC channel.
    pub channel: usize,
    /// The second sensor.
    pub rim: Option<Rim>,
    /// The softest peak that is a strike, of half the ADC's range.
    pub threshold: f64,
    /// From onset to decision, in seconds.
    pub scan_time_s: f64,
    /// From onset until the next may be found, in seconds.
    pub mask_time_s: f64,
    /// Decay of the mask in 1/s.
    pub mask_decay_per_s: f64,
    /// The peak of velocity 1, of half the ADC's range.
    pub full_scale: f64,
    /// Exponent of the velocity curve.
    pub velocity_exponent: f64,
    /// What is taken for crosstalk, in dB below the sum of the others.
    pub crosstalk_db: f64,
}
