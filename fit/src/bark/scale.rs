//! The Bark scale (dynamic-filter eq. 16).

/// Critical-band rate in Bark of a frequency in Hz, 0 or above.
///
/// `13 arctan(0.76 f) + 3.5 arctan((f/7.5)²)`, f in kHz (dynamic-filter eq. 16 after Zwicker and
/// Fastl). The paper prints the square outside the arctangent, which is not their scale.
pub fn bark(frequency_hz: f64) -> f64 {
    let khz = frequency_hz / 1000.0;
    13.0 * (0.76 * khz).atan() + 3.5 * (khz / 7.5).powi(2).atan()
}

/// Frequency in Hz of a critical-band rate in Bark, from 0 to [`HIGHEST_BARK`].
///
/// A rate outside is clamped to the nearest end.
pub fn frequency_hz(bark_rate: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e5);
    // The scale rises steadily: after 60 bisections less than a millionth of a Hz is left.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if bark(middle) < bark_rate { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Highest critical-band rate for which [`frequency_hz`] finds a frequency: that of 100 kHz.
pub const HIGHEST_BARK: f64 = 25.7;

/// Width in Hz of one Bark round a frequency: `df/dB`.
pub fn width_hz(frequency_hz: f64) -> f64 {
    let khz = frequency_hz / 1000.0;
    let per_khz = 13.0 * 0.76 / (1.0 + (0.76 * khz).powi(2)) + 7.0 * khz / 7.5f64.powi(2) / (1.0 + (khz / 7.5).powi(4));
    1000.0 / per_khz
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_critical_bands_are_those_of_zwickers_table() {
        // Upper edges of critical bands in Hz and their rates, from Zwicker and Fastl's table 6.1.
        // Their formula is good to 0.2 Bark.
        for (edge_hz, rate) in
            [(100.0, 1.0), (510.0, 5.0), (1270.0, 10.0), (2700.0, 15.0), (6400.0, 20.0), (15_500.0, 24.0)]
        {
            assert!((bark(edge_hz) - rate).abs() < 0.21, "{edge_hz} Hz: {}", bark(edge_hz));
        }
    }

    #[test]
    fn frequency_hz_inverts_bark_up_to_the_highest_rate() {
        for step in 0..=250 {
            let rate = f64::from(step) * 0.1;
            assert!((bark(frequency_hz(rate)) - rate).abs() < 1e-9);
        }
        assert!(bark(1e5) > HIGHEST_BARK && bark(1e5) < HIGHEST_BARK + 0.1);
    }

    #[test]
    fn width_of_one_bark_is_the_inverse_slope_of_the_scale() {
        for f in [50.0, 440.0, 3000.0, 12_000.0] {
            let slope = (bark(f + 0.5) - bark(f - 0.5)).recip();
            assert!((width_hz(f) / slope - 1.0).abs() < 1e-5);
        }
    }
}
