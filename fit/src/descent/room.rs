//! Room: noise that decays exponentially, band by band (eq. 19 to 23).

use super::bands::{edges, samples, white};
use super::scale::ExpSigmoid;
use crate::random::SplitMix64;
use fourier::Complex;

/// Scaling of the bands' gains (eq. 20); the bias is that of published evaluations.
const GAIN: ExpSigmoid = ExpSigmoid { upper: 2.0, lower: 1e-7, bias: -4.0 };
/// Bias of the bands' dampings (eq. 22), as in the released notebook.
const DECAY_BIAS: f64 = 4.0;

/// Response of a room with its noise, which is drawn once.
#[derive(Clone, Debug)]
pub(super) struct Room {
    rate_hz: f64,
    /// White noise through each band.
    bands: Vec<Vec<f64>>,
}

impl Room {
    /// A room of `bands` bands whose response lasts `length` samples, an even number.
    pub(super) fn new(bands: usize, length: usize, rate_hz: f64, random: &mut SplitMix64) -> Self {
        let whole = white(length, random);
        let of_band = |band: std::ops::Range<usize>| {
            let mut part = vec![Complex::new(0.0, 0.0); whole.len()];
            part[band.clone()].copy_from_slice(&whole[band]);
            samples(part)
        };
        Self { rate_hz, bands: edges(whole.len(), bands).map(of_band).collect() }
    }

    /// Gain and decay of a sample for each band, with their derivatives (eq. 21 and 23).
    fn scaled(&self, gains: &[f64], decays: &[f64]) -> Vec<[(f64, f64); 2]> {
        let of_band = |(gain, decay): (&f64, &f64)| {
            let grown = (decay + DECAY_BIAS).exp();
            [GAIN.at(*gain), ((2.0 + grown) / self.rate_hz, grown / self.rate_hz)]
        };
        gains.iter().zip(decays).map(of_band).collect()
    }

    /// Samples of the response.
    pub(super) fn response(&self, gains: &[f64], decays: &[f64]) -> Vec<f64> {
        let mut response = vec![0.0; self.bands.first().map_or(0, Vec::len)];
        for (band, [gain, decay]) in self.bands.iter().zip(self.scaled(gains, decays)) {
            let (mut level, ratio) = (gain.0, (-decay.0).exp());
            for (sum, x) in response.iter_mut().zip(band) {
                *sum += level * x;
                level *= ratio;
            }
        }
        response
    }

    /// Gradients by the normalised gains and dampings, from that by the samples of the response.
    pub(super) fn gradient(&self, gains: &[f64], decays: &[f64], by_response: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let of_band = |(band, [gain, decay]): (&Vec<f64>, [(f64, f64); 2])| {
            let (mut level, ratio) = (1.0, (-decay.0).exp());
            let (mut plain, mut timed) = (0.0, 0.0);
            for (n, (slope, x)) in by_response.iter().zip(band).enumerate() {
                let term = slope * level * x;
                plain += term;
                timed += n as f64 * term;
                level *= ratio;
            }
            (plain * gain.1, -gain.0 * timed * decay.1)
        };
        self.bands.iter().zip(self.scaled(gains, decays)).map(of_band).unzip()
    }
}
