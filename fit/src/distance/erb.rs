//! ERB distance: levels in bands as wide as an ear's, compared in dB.

use super::lsd::FLOOR;
use super::spectrogram::Spectrogram;

/// Number of bands of the ERB distance.
pub const ERB_BANDS: usize = 40;
/// Lowest and highest edge in Hz.
const RANGE_HZ: [f64; 2] = [50.0, 16_000.0];
/// Number of samples in a frame; the hop is a quarter of it.
pub(super) const WINDOW: usize = 1024;

/// ERB rate of a frequency in Hz, up to a factor (Glasberg and Moore).
fn erb_rate(hz: f64) -> f64 {
    (1.0 + 0.004_37 * hz).ln()
}

/// Edges in Hz of the ERB distance's bands, and of further ones as wide on that scale, up to
/// `highest_hz`.
///
/// A lower `highest_hz` leaves bands out.
pub(crate) fn erb_edges_up_to_hz(highest_hz: f64) -> Vec<f64> {
    let [low, high] = RANGE_HZ.map(erb_rate);
    let width = (high - low) / ERB_BANDS as f64;
    let count = ((erb_rate(highest_hz) - low) / width + 1e-9).floor().max(0.0);
    (0..=count as usize).map(|edge| ((low + width * edge as f64).exp() - 1.0) / 0.004_37).collect()
}

/// Edges in Hz of `count` bands between two frequencies, equally wide on the ERB scale.
pub(crate) fn erb_edges_hz([lowest_hz, highest_hz]: [f64; 2], count: usize) -> Vec<f64> {
    let [low, high] = [lowest_hz, highest_hz].map(erb_rate);
    let inner = (1..count).map(|edge| low + (high - low) * edge as f64 / count as f64);
    let inner = inner.map(|rate| (rate.exp() - 1.0) / 0.004_37);
    // The outer edges are given, not computed: rounding could put the last one beyond its limit.
    std::iter::once(lowest_hz).chain(inner).chain([highest_hz]).collect()
}

/// Energies of 40 bands (ERB-spaced, 50 Hz to 16 kHz) in Hann frames of 1024 samples every 256.
///
/// The ERB distance compares them.
#[derive(Clone, Debug)]
pub struct ErbLevels {
    /// Energies of each frame; a band beyond half the rate is 0.
    pub frames: Vec<[f64; ERB_BANDS]>,
}

impl ErbLevels {
    /// Band energies of a sound.
    pub fn new(samples: &[f64], rate_hz: f64) -> Self {
        let spectrogram = Spectrogram::new(WINDOW);
        let edges: Vec<f64> = Self::edges_hz().iter().map(|edge| edge / rate_hz * WINDOW as f64).collect();
        let power = spectrogram.power(samples);
        let frames = power.chunks_exact(spectrogram.bin_count()).map(|frame| {
            let mut levels = [0.0; ERB_BANDS];
            for (level, edge) in levels.iter_mut().zip(edges.windows(2)) {
                *level = band_power(frame, edge[0], edge[1]);
            }
            levels
        });
        Self { frames: frames.collect() }
    }

    /// Edges of the bands in Hz.
    pub fn edges_hz() -> Vec<f64> {
        erb_edges_up_to_hz(RANGE_HZ[1])
    }

    /// Energy 60 dB below the loudest band of any frame.
    pub fn floor(&self) -> f64 {
        self.frames.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max) * FLOOR
    }

    /// ERB distance in dB of a rendering from this recording.
    ///
    /// It is the mean over frames of the rms over bands of the difference in dB, both floored 60 dB
    /// below the recording's maximum. Frames beyond the end of the shorter sound do not count.
    pub fn distance_db(&self, rendering: &Self) -> f64 {
        let floor = self.floor();
        let frames = self.frames.iter().zip(&rendering.frames).map(|(wanted, given)| {
            let squares = wanted
                .iter()
                .zip(given)
                .map(|(wanted, given)| (10.0 * (given.max(floor) / wanted.max(floor)).log10()).powi(2));
            (squares.sum::<f64>() / ERB_BANDS as f64).sqrt()
        });
        let count = self.frames.len().min(rendering.frames.len()).max(1) as f64;
        frames.sum::<f64>() / count
    }
}

/// Power between two positions of a spectrum, in bins with fractions.
pub(crate) fn band_power(frame: &[f64], from: f64, to: f64) -> f64 {
    let share = |bin: usize| (to.min(bin as f64 + 0.5) - from.max(bin as f64 - 0.5)).clamp(0.0, 1.0);
    let first = (from - 0.5).floor().max(0.0) as usize;
    let last = ((to + 0.5).ceil() as usize).min(frame.len().saturating_sub(1));
    (first..=last).filter_map(|bin| Some(frame.get(bin)? * share(bin))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn noise(seed: u64, gain: f64) -> Vec<f64> {
        let mut random = SplitMix64(seed);
        (0..24_000).map(|_| gain * random.normal()).collect()
    }

    #[test]
    fn a_change_of_level_is_a_distance_of_as_many_decibels() {
        let (sound, louder) = (noise(1, 0.1), noise(1, 0.2));
        let levels = ErbLevels::new(&sound, 48_000.0);
        assert!((levels.distance_db(&ErbLevels::new(&louder, 48_000.0)) - 6.0206).abs() < 1e-3);
        assert_eq!(levels.distance_db(&levels), 0.0);
        let silence = levels.distance_db(&ErbLevels::new(&vec![0.0; sound.len()], 48_000.0));
        assert!((30.0..60.0).contains(&silence), "{silence}");
    }

    #[test]
    fn noises_of_equal_level_are_within_6_db() {
        let levels = ErbLevels::new(&noise(1, 0.1), 48_000.0);
        let distance = levels.distance_db(&ErbLevels::new(&noise(2, 0.1), 48_000.0));
        // Narrow bands hold few independent values in a frame.
        assert!((1.0..6.0).contains(&distance), "{distance}");
    }

    #[test]
    fn bands_hold_all_power_between_their_edges() {
        let frame = [1.0; 100];
        assert!((band_power(&frame, 3.25, 7.75) - 4.5).abs() < 1e-12);
        assert_eq!(band_power(&frame, 200.0, 300.0), 0.0);
    }
}
