//! Log-spectral distance.

use super::spectrogram::Spectrogram;

/// Window sizes in samples.
pub(crate) const SIZES: [usize; 2] = [512, LONGEST_WINDOW];
/// Longest window in samples.
pub(crate) const LONGEST_WINDOW: usize = 2048;
/// Power relative to the recording's maximum below which nothing counts: 60 dB.
pub(crate) const FLOOR: f64 = 1e-6;
/// Length of the part that is compared, in seconds.
pub const LSD_SECONDS: f64 = 0.25;
/// Number of samples before the recording's peak at which that part begins.
const BEFORE_PEAK: usize = 20;

/// Part of a recording that is compared: 0.25 s from 20 samples before the peak, as far as there is
/// sound.
pub fn lsd_window(recording: &[f64], rate_hz: f64) -> std::ops::Range<usize> {
    let peak = recording.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |(at, _)| at);
    let start = peak.saturating_sub(BEFORE_PEAK);
    start..recording.len().min(start + (LSD_SECONDS * rate_hz).round() as usize)
}

/// Log-spectral distance in dB between two aligned sounds of equal length.
///
/// It is the mean over Hann windows of 512 and 2048 samples (hop a quarter) of the mean over frames
/// of the rms over bins of the difference of the two dB spectra. Both spectra are floored 60 dB
/// below the recording's maximum, and both sounds have unit rms.
///
/// Silence against a sound gives the distance to the floor, silence against silence 0.
pub(crate) fn log_spectral_distance_db(recording: &[f64], rendering: &[f64]) -> f64 {
    let (recording, rendering) = (of_unit_rms(recording), of_unit_rms(rendering));
    let distances = SIZES.map(|size| {
        let frames = frame_distances_db(&recording, &rendering, size);
        frames.iter().sum::<f64>() / frames.len().max(1) as f64
    });
    distances.iter().sum::<f64>() / distances.len() as f64
}

/// Log-spectral distance in dB of each frame, for Hann windows of `size` samples with a hop of a
/// quarter.
///
/// It is the rms over bins of the difference of two dB spectra, both floored 60 dB below the
/// recording's maximum. Levels are not normalised.
pub fn frame_distances_db(recording: &[f64], rendering: &[f64], size: usize) -> Vec<f64> {
    let spectrogram = Spectrogram::new(size);
    let (wanted, given) = (spectrogram.power(recording), spectrogram.power(rendering));
    let floor = wanted.iter().copied().fold(f64::MIN_POSITIVE, f64::max) * FLOOR;
    let bins = spectrogram.bin_count();
    let frames = wanted.chunks_exact(bins).zip(given.chunks_exact(bins)).map(|(wanted, given)| {
        let squares = wanted
            .iter()
            .zip(given)
            .map(|(wanted, given)| (10.0 * (wanted.max(floor) / given.max(floor)).log10()).powi(2));
        (squares.sum::<f64>() / bins as f64).sqrt()
    });
    frames.collect()
}

/// The sound scaled to unit rms; silence stays silence.
pub(crate) fn of_unit_rms(samples: &[f64]) -> Vec<f64> {
    let scale = to_unit_rms(samples);
    samples.iter().map(|x| x * scale).collect()
}

/// Factor that scales a sound to unit rms; 0 for silence.
pub(super) fn to_unit_rms(samples: &[f64]) -> f64 {
    let power = samples.iter().map(|x| x * x).sum::<f64>() / samples.len().max(1) as f64;
    if power > 0.0 { power.sqrt().recip() } else { 0.0 }
}
