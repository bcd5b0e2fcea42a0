//! Short-time power spectra.

use std::f64::consts::TAU;
use std::sync::Arc;

use fourier::{Complex, RealToComplex};

/// Short-time spectra with a periodic Hann window and a hop of a quarter of it.
///
/// Frames lie wholly in the sound. A sound shorter than one window is padded with zeros to one
/// frame.
#[derive(Clone)]
pub struct Spectrogram {
    window: Vec<f64>,
    transform: Arc<dyn RealToComplex<f64>>,
}

impl Spectrogram {
    /// Spectra for windows of `size` samples, at least 4.
    pub fn new(size: usize) -> Self {
        let size = size.max(4);
        let window = (0..size).map(|n| 0.5 - 0.5 * (TAU * n as f64 / size as f64).cos()).collect();
        Self { window, transform: fourier::forward(size) }
    }

    /// Number of samples between two frames.
    pub fn hop(&self) -> usize {
        self.window.len() / 4
    }

    /// Number of bins in a frame.
    pub fn bin_count(&self) -> usize {
        self.window.len() / 2 + 1
    }

    /// Number of frames in `length` samples.
    pub fn frame_count(&self, length: usize) -> usize {
        1 + length.saturating_sub(self.window.len()) / self.hop()
    }

    /// Complex spectra, frame after frame.
    pub fn complex(&self, samples: &[f64]) -> Vec<Complex<f64>> {
        let frames = self.frame_count(samples.len());
        let mut spectra = Vec::with_capacity(frames * self.bin_count());
        let (mut input, mut output) = (self.transform.make_input_vec(), self.transform.make_output_vec());
        let mut scratch = self.transform.make_scratch_vec();
        for frame in 0..frames {
            let from = samples.get(frame * self.hop()..).unwrap_or(&[]);
            for (n, (slot, window)) in input.iter_mut().zip(&self.window).enumerate() {
                *slot = window * from.get(n).copied().unwrap_or(0.0);
            }
            if self.transform.process_with_scratch(&mut input, &mut output, &mut scratch).is_ok() {
                spectra.extend_from_slice(&output);
            }
        }
        spectra
    }

    /// Power spectra `|X|²`, frame after frame.
    pub fn power(&self, samples: &[f64]) -> Vec<f64> {
        self.complex(samples).iter().map(Complex::norm_sqr).collect()
    }

    /// Power spectrum `|X|²` of all samples as they are, without a window.
    pub(crate) fn rectangular_power(samples: &[f64]) -> Vec<f64> {
        let transform = fourier::forward(samples.len());
        let mut output = transform.make_output_vec();
        let _refused = transform.process(&mut samples.to_vec(), &mut output);
        output.iter().map(Complex::norm_sqr).collect()
    }

    /// Samples of the window.
    pub(crate) fn window(&self) -> &[f64] {
        &self.window
    }
}
