//! Settings of a pad's piezos.

/// Second sensor of a pad, such as that of a rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// ADC channel of the sensor.
    pub channel: usize,
    /// Index of the pad's striker that this sensor plays.
    pub striker: usize,
    /// Advantage in dB over the first sensor when the two peaks are compared.
    pub gain_db: f64,
}

/// Settings of one pad with a piezo. Values are trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiezoSettings {
    /// ADC channel of the pad's first sensor.
    pub channel: usize,
    /// Second sensor, if the pad has one.
    pub rim: Option<Rim>,
    /// Softest peak that is a strike, as a share of half the ADC's range.
    pub threshold: f64,
    /// Time from onset to decision, in seconds.
    pub scan_time_s: f64,
    /// Time in seconds from an onset until the next may be found.
    pub mask_time_s: f64,
    /// Decay of the mask in 1/s.
    pub mask_decay_per_s: f64,
    /// Peak of a strike at velocity 1, as a share of half the ADC's range.
    pub full_scale: f64,
    /// Exponent of the velocity curve.
    pub velocity_exponent: f64,
    /// Crosstalk limit in dB, relative to the sum of the other channels' peaks. A lower peak is no
    /// strike.
    pub crosstalk_db: f64,
}
