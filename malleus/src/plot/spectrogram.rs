//! Level over time and frequency, on the grid of a picture: one value per pixel.
//!
//! It is a short-time Fourier transform with a Hann window. A strike needs a short window and a low
//! mode a long one. So the transform is done with several window lengths, and each frequency takes
//! its level from the lengths that suit it best, blended in dB.

use std::sync::Arc;

use fourier::{Complex, RealToComplex};

/// Lowest frequency of a spectrogram, in Hz.
pub(super) const LOWEST_HZ: f64 = 50.0;
/// Highest frequency of a spectrogram, in Hz.
pub(super) const HIGHEST_HZ: f64 = 20_000.0;
/// Level of silence in dB; lower levels read as this one.
pub(super) const FLOOR_DB: f32 = -100.0;

/// Window lengths in seconds, each with the frequency in Hz that it alone serves.
///
/// Lengths are rounded to powers of two in samples.
const RESOLUTIONS: [(f64, f64); 3] = [(0.170, 120.0), (0.085, 600.0), (0.0425, 2500.0)];
/// Ratio of the transform's length to the window's.
///
/// The frame is filled up with zeros, which brings the bins closer together: a sine between two
/// bins reads 0.4 dB low instead of 1.4 dB.
const PADDING: usize = 2;

/// Levels on a grid of `columns` equal spans of time and `rows` equal ratios of frequency.
///
/// Row 0 begins at [`LOWEST_HZ`], and the last row ends at [`HIGHEST_HZ`].
#[derive(Clone, Debug)]
pub(super) struct Spectrogram {
    columns: usize,
    rows: usize,
    nyquist_hz: f64,
    level_db: Vec<f32>,
}

impl Spectrogram {
    /// Computes the levels of `channels`, each the whole sound at `rate_hz`, in dB relative to a
    /// full-scale sine (amplitude 1).
    ///
    /// The louder channel counts. Where a column spans several frames, the loudest one counts, so
    /// that no strike is lost between them. The memory is that of the grid and a few frames,
    /// however long the sound. The time grows with the sound once that has more than one frame per
    /// column.
    pub(super) fn of(channels: &[&[f32]], rate_hz: f64, columns: usize, rows: usize) -> Self {
        let mut level_db = vec![FLOOR_DB; columns * rows];
        let resolutions: Vec<Resolution> =
            (0..RESOLUTIONS.len()).map(|index| Resolution::new(index, rate_hz, rows)).collect();
        let threads = std::thread::available_parallelism().map_or(1, |count| count.get().min(8));
        let share = columns.div_ceil(threads).max(1);
        std::thread::scope(|scope| {
            for (index, part) in level_db.chunks_mut(share * rows.max(1)).enumerate() {
                let resolutions = &resolutions;
                scope.spawn(move || {
                    let mut scratch = Scratch::default();
                    for (offset, levels) in part.chunks_mut(rows).enumerate() {
                        let column = index * share + offset;
                        fill_column(channels, (column, columns), resolutions, &mut scratch, levels);
                    }
                });
            }
        });
        Self { columns, rows, nyquist_hz: rate_hz / 2.0, level_db }
    }

    /// Number of columns of the grid.
    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows of the grid.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Level at a place on the grid in dB, at least [`FLOOR_DB`].
    ///
    /// Returns `None` above half the sample rate and outside the grid.
    pub(super) fn level_db(&self, column: usize, row: usize) -> Option<f32> {
        let inside = column < self.columns && row < self.rows;
        let known = frequency_hz(row as f64 + 0.5, self.rows) < self.nyquist_hz;
        if inside && known { self.level_db.get(column * self.rows + row).copied() } else { None }
    }
}

/// Frequency in Hz at a place among `rows` rows; a whole number is the lower edge of that row.
fn frequency_hz(row: f64, rows: usize) -> f64 {
    LOWEST_HZ * (HIGHEST_HZ / LOWEST_HZ).powf(row / rows as f64)
}

/// Transform with one window length, and the bins from which the rows take their levels.
struct Resolution {
    window: Vec<f64>,
    fft: Arc<dyn RealToComplex<f64>>,
    /// Factor from the power of a bin to the power relative to a full-scale sine.
    power_scale: f32,
    rows: Vec<RowSource>,
}

/// Bins of one spectrum from which a row takes its level.
struct RowSource {
    row: usize,
    /// Share of this window length in the row's level, 0 to 1.
    weight: f32,
    /// Lower edge of the row, in bins.
    low_bin: f32,
    /// Upper edge of the row, in bins.
    high_bin: f32,
}

impl Resolution {
    fn new(index: usize, rate_hz: f64, rows: usize) -> Self {
        let (length_s, _) = RESOLUTIONS[index];
        let length = 1_usize << (length_s * rate_hz).log2().round().clamp(4.0, 20.0) as u32;
        let step = std::f64::consts::TAU / length as f64;
        let window: Vec<f64> = (0..length).map(|n| 0.5 - 0.5 * (step * (n as f64 + 0.5)).cos()).collect();
        let fft_length = length * PADDING;
        let bin_hz = rate_hz / fft_length as f64;
        let rows = (0..rows)
            .filter_map(|row| {
                let weight = weight(index, frequency_hz(row as f64 + 0.5, rows));
                let bin = |edge: usize| (frequency_hz(edge as f64, rows) / bin_hz) as f32;
                (weight > 0.0).then(|| RowSource {
                    row,
                    weight: weight as f32,
                    low_bin: bin(row),
                    high_bin: bin(row + 1),
                })
            })
            .collect();
        Self {
            // A Hann window of N samples passes N/2 of a constant, and a sine's amplitude is split
            // between two lines of the spectrum.
            power_scale: (4.0 / length as f32).powi(2),
            window,
            fft: fourier::forward(fft_length),
            rows,
        }
    }

    /// Raises each bin of the scratch's power to that of the frame centred on sample `centre`.
    ///
    /// Powers are relative to a full-scale sine; the louder channel counts.
    fn hold_power(&self, channels: &[&[f32]], centre: usize, scratch: &mut Scratch) {
        scratch.frame.resize(self.fft.len(), 0.0);
        scratch.spectrum.resize(self.fft.len() / 2 + 1, Complex::default());
        scratch.workspace.resize(self.fft.get_scratch_len(), Complex::default());
        let first = centre as i64 - (self.window.len() / 2) as i64;
        for channel in channels {
            scratch.frame.fill(0.0);
            let ahead = (-first).max(0) as usize;
            let from = first.max(0) as usize;
            let present = channel.get(from..).unwrap_or_default();
            let pairs = present.iter().zip(self.window.iter().skip(ahead));
            for (slot, (sample, weight)) in scratch.frame.iter_mut().skip(ahead).zip(pairs) {
                *slot = f64::from(*sample) * weight;
            }
            let done = self.fft.process_with_scratch(&mut scratch.frame, &mut scratch.spectrum, &mut scratch.workspace);
            // The transform fails only for slices of a wrong length; these were resized above.
            debug_assert!(done.is_ok());
            for (power, bin) in scratch.power.iter_mut().zip(&scratch.spectrum) {
                *power = power.max(bin.norm_sqr() as f32 * self.power_scale);
            }
        }
    }
}

/// Share of window length `index` in the level at `frequency_hz`, 0 to 1.
///
/// It is 1 at the frequency that this length alone serves, and falls to 0 at those of its
/// neighbours, linearly in the logarithm of the frequency. Below the first and above the last
/// frequency it stays 1. The shares of all lengths add up to 1.
fn weight(index: usize, frequency_hz: f64) -> f64 {
    let own_hz = RESOLUTIONS[index].1;
    let neighbour = if frequency_hz < own_hz { index.checked_sub(1) } else { Some(index + 1) };
    neighbour.and_then(|neighbour| RESOLUTIONS.get(neighbour)).map_or(1.0, |(_, other_hz)| {
        let away = (frequency_hz / own_hz).ln() / (other_hz / own_hz).ln();
        (1.0 - away).max(0.0)
    })
}

/// Buffers of one thread, used again for each frame.
#[derive(Default)]
struct Scratch {
    frame: Vec<f64>,
    spectrum: Vec<Complex<f64>>,
    workspace: Vec<Complex<f64>>,
    power: Vec<f32>,
}

fn fill_column(
    channels: &[&[f32]],
    (column, columns): (usize, usize),
    resolutions: &[Resolution],
    scratch: &mut Scratch,
    levels: &mut [f32],
) {
    let length = channels.iter().map(|channel| channel.len()).max();
    let span = length.unwrap_or(0) as f64 / columns as f64;
    levels.fill(0.0);
    for resolution in resolutions {
        scratch.power.clear();
        scratch.power.resize(resolution.fft.len() / 2 + 1, 0.0);
        let hop = resolution.window.len() as f64 / 2.0;
        let frames = (span / hop).ceil().max(1.0) as usize;
        for frame in 0..frames {
            let part = (frame as f64 + 0.5) / frames as f64;
            let centre = ((column as f64 + part) * span) as usize;
            resolution.hold_power(channels, centre, scratch);
        }
        for source in &resolution.rows {
            let power = row_power(&scratch.power, source.low_bin, source.high_bin);
            let level_db = 10.0 * power.max(1e-20).log10();
            levels[source.row] += source.weight * level_db.max(FLOOR_DB);
        }
    }
}

/// Highest power between two places on a spectrum, which are given in bins.
///
/// Between two bins the power is interpolated linearly.
fn row_power(power: &[f32], low_bin: f32, high_bin: f32) -> f32 {
    let at = |bin: f32| {
        let below = power.get(bin as usize).copied().unwrap_or(0.0);
        let above = power.get(bin as usize + 1).copied().unwrap_or(below);
        below + (above - below) * bin.fract()
    };
    let inside = (low_bin.ceil() as usize)..(high_bin.floor() as usize + 1);
    power
        .get(inside.start..inside.end.min(power.len()))
        .unwrap_or_default()
        .iter()
        .copied()
        .fold(at(low_bin).max(at(high_bin)), f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 48_000.0;
    const ROWS: usize = 400;

    fn sine(frequency_hz: f64, amplitude: f64, seconds: f64) -> Vec<f32> {
        let step = std::f64::consts::TAU * frequency_hz / RATE_HZ;
        (0..(seconds * RATE_HZ) as usize).map(|n| (amplitude * (step * n as f64).sin()) as f32).collect()
    }

    fn loudest(spectrogram: &Spectrogram, column: usize) -> (usize, f32) {
        (0..ROWS)
            .filter_map(|row| Some((row, spectrogram.level_db(column, row)?)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .expect("rows")
    }

    #[test]
    fn full_scale_sine_reads_0_db_in_its_own_row() {
        for frequency_hz_in in [60.0, 110.0, 441.3, 1000.0, 5013.7, 15_000.0] {
            let sound = sine(frequency_hz_in, 1.0, 1.0);
            let spectrogram = Spectrogram::of(&[&sound], RATE_HZ, 10, ROWS);
            let (row, level_db) = loudest(&spectrogram, 5);
            let expected = (frequency_hz_in / LOWEST_HZ).ln() / (HIGHEST_HZ / LOWEST_HZ).ln() * ROWS as f64;
            // A bin of the longest window is 6 rows wide at 60 Hz, so that the peak may lie a few
            // rows off.
            assert!(
                (row as f64 + 0.5 - expected).abs() < 4.0,
                "{frequency_hz_in} Hz in row {row}, expected {expected}"
            );
            assert!(level_db.abs() < 0.5, "{frequency_hz_in} Hz reads {level_db} dB");
        }
    }

    #[test]
    fn sine_of_a_tenth_of_full_scale_reads_minus_20_db() {
        let sound = sine(1000.0, 0.1, 1.0);
        let spectrogram = Spectrogram::of(&[&sound], RATE_HZ, 10, ROWS);
        assert!((loudest(&spectrogram, 5).1 + 20.0).abs() < 0.5);
    }

    #[test]
    fn sine_leaves_far_frequencies_at_the_floor() {
        let sound = sine(1000.0, 0.5, 1.0);
        let spectrogram = Spectrogram::of(&[&sound], RATE_HZ, 10, ROWS);
        for row in [0, ROWS - 1] {
            assert!(spectrogram.level_db(5, row).is_some_and(|level| (level - FLOOR_DB).abs() < 1e-3));
        }
    }

    #[test]
    fn louder_channel_counts() {
        let quiet = sine(1000.0, 0.01, 1.0);
        let loud = sine(1000.0, 1.0, 1.0);
        let spectrogram = Spectrogram::of(&[&quiet, &loud], RATE_HZ, 10, ROWS);
        assert!(loudest(&spectrogram, 5).1.abs() < 0.5);
    }

    #[test]
    fn click_in_a_minute_of_silence_is_seen() {
        let mut sound = vec![0.0; (60.0 * RATE_HZ) as usize];
        let at = (40.03 * RATE_HZ) as usize;
        sound[at..at + 24].fill(1.0);
        let spectrogram = Spectrogram::of(&[&sound], RATE_HZ, 100, ROWS);
        assert!(loudest(&spectrogram, 66).1 > -45.0);
        // Even the floor is rounded when two window lengths are blended.
        assert!((loudest(&spectrogram, 30).1 - FLOOR_DB).abs() < 1e-3);
    }

    #[test]
    fn frequencies_above_half_the_rate_have_no_level() {
        let sound = vec![0.0; 4000];
        let spectrogram = Spectrogram::of(&[&sound], 16_000.0, 10, ROWS);
        assert_eq!(spectrogram.level_db(3, ROWS - 1), None);
        assert_eq!(spectrogram.level_db(3, 10), Some(FLOOR_DB));
    }

    #[test]
    fn sound_shorter_than_every_window_is_shown() {
        let sound = sine(3000.0, 1.0, 0.01);
        let spectrogram = Spectrogram::of(&[&sound], RATE_HZ, 50, ROWS);
        assert!(loudest(&spectrogram, 25).1 > -15.0);
    }

    #[test]
    fn shares_of_the_window_lengths_add_up_to_one() {
        for row in 0..=100 {
            let frequency = frequency_hz(f64::from(row), 100);
            let sum: f64 = (0..RESOLUTIONS.len()).map(|index| weight(index, frequency)).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{frequency} Hz: {sum}");
        }
    }
}
