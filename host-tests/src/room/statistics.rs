//! Figures that the instrument's room shares with the reference's: energy, decay, balance,
//! correlation.

use super::{BandError, LARGE, Look, Table, answer_to_sides, band_errors, energy};
use dsp_core::SampleRate;
use reference::RoomBand;

/// Answer of a room to an impulse of energy 2 at a constant-power pan, without the impulse.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Left and right side from the impulse on, 1.0 = full scale.
    pub sides: [Vec<f64>; 2],
}

/// Left and right side of an impulse at frame `at`.
///
/// Their heights are `√2 cos` and `√2 sin` of the pan's angle, so that the mean energy of the sides
/// is 1.
fn impulse(pan: f64, at: usize, frames: usize) -> [Vec<f64>; 2] {
    let (right, left) = ((pan + 1.0) * std::f64::consts::FRAC_PI_4).sin_cos();
    [left, right].map(|gain| {
        let mut side = vec![0.0; at + frames];
        side[at] = std::f64::consts::SQRT_2 * gain;
        side
    })
}

impl Answer {
    /// Answer of the instrument, with 48 KB of 16-bit delay lines, to an impulse at frame `at`.
    ///
    /// # Panics
    /// If the table cannot be played.
    pub fn of_instrument(table: &Table, rate: SampleRate, pan: f64, at: usize, frames: usize) -> Self {
        let dry = impulse(pan, at, frames);
        let dry = dry.each_ref().map(Vec::as_slice);
        let sides = answer_to_sides::<i16, LARGE>(table, rate, dry).expect("a table in range");
        Self { sides: sides.map(|side| side[at..].to_vec()) }
    }

    /// Answer of the reference, [`reference::room()`], with the noise of a seed.
    pub fn of_reference(table: &Table, rate: SampleRate, pan: f64, frames: usize, seed: u64) -> Self {
        let bands: Vec<RoomBand> = table
            .bands
            .iter()
            .map(|band| RoomBand { from_hz: band.from_hz, gain: band.gain, decay_per_s: 1000f64.ln() / band.t60_s })
            .collect();
        let (numerator, denominator) = rate.ratio();
        let dry = impulse(pan, 0, frames);
        let dry = dry.each_ref().map(Vec::as_slice);
        Self { sides: reference::room(&bands, dry, reference::SampleRate { numerator, denominator }, seed) }
    }

    /// Energy of both sides together.
    pub fn energy(&self) -> f64 {
        self.sides.iter().map(|side| energy(side)).sum()
    }

    /// Energy of the left side above that of the right, in dB.
    pub fn balance_db(&self) -> f64 {
        let [left, right] = self.sides.each_ref().map(|side| energy(side));
        10.0 * (left / right).log10()
    }

    /// Correlation between the sides, -1 to 1.
    pub fn correlation(&self) -> f64 {
        let [left, right] = &self.sides;
        let product: f64 = left.iter().zip(right).map(|(left, right)| left * right).sum();
        product / (energy(left) * energy(right)).sqrt()
    }

    /// Seconds to the first sample, on either side, within 40 dB of the answer's peak.
    pub fn onset_s(&self, rate_hz: f64) -> f64 {
        let peak = self.sides.iter().flatten().fold(0.0, |peak: f64, x| peak.max(x.abs()));
        let first = |side: &Vec<f64>| side.iter().position(|x| x.abs() >= 0.01 * peak).unwrap_or(side.len());
        self.sides.iter().map(first).fold(usize::MAX, usize::min) as f64 / rate_hz
    }

    /// Errors of decay and energy of all bands against the table.
    pub fn band_errors(&self, table: &Table, rate_hz: f64) -> Vec<BandError> {
        band_errors(table, &self.sides, Look::Inside, 25.0, rate_hz)
    }
}

/// Mean and root mean square of values.
pub fn mean_and_rms(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    (values.iter().sum::<f64>() / count, (values.iter().map(|x| x * x).sum::<f64>() / count).sqrt())
}
