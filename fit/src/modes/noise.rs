//! Noise floor of a recording as a function of frequency.

use std::f64::consts::{LN_2, TAU};

/// Noise power in bands, as the variance of white noise of equal density.
#[derive(Clone, Debug)]
pub(crate) struct NoiseFloor {
    /// Upper edge of each band in rad/sample, and its variance.
    bands: Vec<(f64, f64)>,
}

/// Minimum number of bins in a band: their median is then within 15 %.
const LEAST_BINS: usize = 64;
/// Minimum length of a frame in samples.
const LEAST_FRAME: usize = 4096;

impl NoiseFloor {
    /// Estimates the noise floor from the residual of a model.
    ///
    /// In each band it is the median over bins, which a few remaining modes do not move. Of up to
    /// four successive frames the quietest counts, because a recording ends in its noise.
    pub(crate) fn of_residual(residual: &[f64]) -> Self {
        let frames = (residual.len() / LEAST_FRAME).clamp(1, 4);
        let length = residual.len() / frames;
        let transform = fourier::forward(length);
        let mut output = transform.make_output_vec();
        let mut quietest: Vec<(f64, f64)> = Vec::new();
        for frame in residual.chunks_exact(length.max(1)).take(frames) {
            let mut windowed: Vec<f64> = frame
                .iter()
                .enumerate()
                .map(|(n, x)| x * (1.0 - (TAU * (n as f64 + 0.5) / length as f64).cos()))
                .collect();
            if transform.process(&mut windowed, &mut output).is_err() {
                break;
            }
            // The mean square of the window is 3/2.
            let power: Vec<f64> = output.iter().map(|bin| bin.norm_sqr() / (1.5 * length as f64)).collect();
            let bands = bands(&power);
            if quietest.is_empty() {
                quietest = bands;
            } else {
                for (least, new) in quietest.iter_mut().zip(bands) {
                    least.1 = least.1.min(new.1);
                }
            }
        }
        Self { bands: quietest }
    }

    /// Noise variance at a frequency in rad/sample.
    pub(crate) fn variance(&self, angular: f64) -> f64 {
        let at = self.bands.partition_point(|(edge, _)| *edge < angular).min(self.bands.len().saturating_sub(1));
        self.bands.get(at).map_or(f64::MIN_POSITIVE, |band| band.1.max(f64::MIN_POSITIVE))
    }
}

/// Upper edge and median-based variance of bands as wide as a fifth of their frequency, at least 64
/// bins.
fn bands(power: &[f64]) -> Vec<(f64, f64)> {
    let mut bands = Vec::new();
    let mut start = 1;
    while start < power.len() {
        let width = LEAST_BINS.max(start / 5);
        let mut end = start + width;
        if end + width > power.len() {
            end = power.len();
        }
        let mut bins = power[start..end].to_vec();
        let middle = bins.len() / 2;
        let (_, median, _) = bins.select_nth_unstable_by(middle, f64::total_cmp);
        bands.push((std::f64::consts::PI * end as f64 / (power.len() - 1) as f64, *median / LN_2));
        start = end;
    }
    bands
}
