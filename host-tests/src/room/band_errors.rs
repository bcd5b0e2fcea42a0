//! Error of a response against its table, band by band.

use super::{Band, Look, Spectrum, Table, energy, t60_s};

/// Error of a band's decay and energy against the table, each the mean of both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandError {
    /// T60 over the table's, less 1.
    pub t60: f64,
    /// Energy over the table's, in dB.
    pub energy_db: f64,
    /// Number of independent samples of the band's noise: its width times its T60. Below 300, noise
    /// itself scatters by more than 3 %.
    pub samples: f64,
}

/// Number of frames of a response that the fits need.
pub fn frames_needed(table: &Table, rate_hz: f64) -> usize {
    let longest = table.bands.iter().fold(0.0, |longest: f64, band| longest.max(band.t60_s));
    ((0.7 * longest + 0.3) * rate_hz) as usize
}

/// Errors of all bands of a response to a unit impulse.
///
/// T60 is that of the line through Schroeder's integral from -5 dB to `to_db` below the beginning.
pub fn band_errors(table: &Table, sides: &[Vec<f64>; 2], look: Look, to_db: f64, rate_hz: f64) -> Vec<BandError> {
    let spectra = sides.each_ref().map(|side| Spectrum::new(side, rate_hz));
    let error = |(index, band): (usize, &super::TableBand)| {
        let whole = Band { from_hz: band.from_hz, to_hz: table.to_hz(index, rate_hz) };
        let seen = if look == Look::Inside { whole.inside(rate_hz) } else { whole };
        let parts = spectra.each_ref().map(|spectrum| spectrum.band(look, whole));
        let t60 = parts.each_ref().map(|part| t60_s(part, 5.0, to_db, rate_hz)).iter().sum::<f64>() / 2.0;
        let width_hz = seen.to_hz - seen.from_hz;
        let reference = band.gain * band.gain * band.t60_s / (2.0 * 1000f64.ln()) * width_hz * 2.0 / rate_hz;
        let energy = parts.iter().map(|part| energy(part)).sum::<f64>() / 2.0;
        BandError {
            t60: t60 / band.t60_s - 1.0,
            energy_db: 10.0 * (energy / reference).log10(),
            samples: width_hz * band.t60_s,
        }
    };
    table.bands.iter().enumerate().map(error).collect()
}
