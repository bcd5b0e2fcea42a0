//! Multi-scale spectrogram loss (§3.5), with its gradient by the samples.

use std::f64::consts::TAU;
use std::sync::Arc;

use fourier::{Complex, ComplexToReal, RealToComplex};

/// Window sizes s_w in samples, as §3.5 and the released notebook have them.
///
/// Appendix C.2 counts 128 among the sizes that are left out.
const WINDOWS: [usize; 5] = [128, 256, 512, 1024, 2048];
/// Number of frames that overlap: an overlap ratio β of 3/4, as in DDSP.
const OVERLAP: usize = 4;
/// Weight λ_1 of the spectrograms' distance.
const LINEAR_WEIGHT: f64 = 1.0;
/// Weight λ_2 of the log spectrograms' distance, as in the released notebook.
const LOG_WEIGHT: f64 = 0.1;
/// Least magnitude of which a logarithm is taken.
const LEAST: f64 = 1e-5;

/// Distance of a sound from a recording.
#[derive(Clone)]
pub(super) struct Loss {
    scales: Vec<Scale>,
}

/// Spectrogram of the recording at one window size.
#[derive(Clone)]
struct Scale {
    window: Vec<f64>,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// Magnitude of each bin and its logarithm, frame after frame.
    target: Vec<(f64, f64)>,
}

fn logarithm(magnitude: f64) -> f64 {
    magnitude.max(LEAST).ln()
}

impl Loss {
    /// Loss against a recording.
    pub(super) fn new(recording: &[f64]) -> Self {
        Self { scales: WINDOWS.iter().map(|size| Scale::new(*size, recording)).collect() }
    }

    /// Loss of a sound as long as the recording; adds its gradient by the samples to `gradient`.
    pub(super) fn at(&self, sound: &[f64], gradient: &mut [f64]) -> f64 {
        self.scales.iter().map(|scale| scale.at(sound, gradient)).sum()
    }
}

impl Scale {
    fn new(size: usize, recording: &[f64]) -> Self {
        let window = (0..size).map(|n| 0.5 - 0.5 * (TAU * n as f64 / size as f64).cos()).collect();
        let mut scale =
            Self { window, forward: fourier::forward(size), inverse: fourier::inverse(size), target: Vec::new() };
        let mut target = Vec::new();
        scale.frames(recording, |_, bins| {
            target.extend(bins.iter().map(|bin| {
                let magnitude = bin.norm_sqr().sqrt();
                (magnitude, logarithm(magnitude))
            }));
        });
        scale.target = target;
        scale
    }

    fn hop(&self) -> usize {
        self.window.len() / OVERLAP
    }

    /// Visits the spectrum of each frame with the frame's first sample. The last frames reach
    /// beyond the sound, into silence.
    fn frames(&self, sound: &[f64], mut visit: impl FnMut(usize, &mut [Complex<f64>])) {
        let (mut input, mut bins) = (self.forward.make_input_vec(), self.forward.make_output_vec());
        let mut scratch = self.forward.make_scratch_vec();
        for first in (0..sound.len()).step_by(self.hop()) {
            input.fill(0.0);
            for ((slot, window), x) in input.iter_mut().zip(&self.window).zip(&sound[first..]) {
                *slot = window * x;
            }
            let _transformed = self.forward.process_with_scratch(&mut input, &mut bins, &mut scratch);
            visit(first, &mut bins);
        }
    }

    fn at(&self, sound: &[f64], gradient: &mut [f64]) -> f64 {
        let share = 1.0 / self.target.len().max(1) as f64;
        let mut scratch = self.inverse.make_scratch_vec();
        let mut frame = self.inverse.make_output_vec();
        let mut targets = self.target.chunks(self.window.len() / 2 + 1);
        let (mut linear, mut logarithmic) = (0.0, 0.0);
        self.frames(sound, |first, bins| {
            let target = targets.next().unwrap_or(&[]);
            for (bin, (target, target_log)) in bins.iter_mut().zip(target) {
                let magnitude = bin.norm_sqr().sqrt();
                let (apart, apart_log) = (magnitude - target, logarithm(magnitude) - target_log);
                linear += apart.abs();
                logarithmic += apart_log.abs();
                let mut slope = LINEAR_WEIGHT * apart.signum();
                if magnitude > LEAST {
                    slope += LOG_WEIGHT * apart_log.signum() / magnitude;
                }
                // The inverse transform counts each bin but the first and the last twice.
                *bin *= if magnitude > 0.0 { 0.5 * share * slope / magnitude } else { 0.0 };
            }
            let last = bins.len() - 1;
            for bin in [0, last] {
                bins[bin] = Complex::new(2.0 * bins[bin].re, 0.0);
            }
            let _transformed = self.inverse.process_with_scratch(bins, &mut frame, &mut scratch);
            for ((slot, window), x) in gradient[first..].iter_mut().zip(&self.window).zip(&frame) {
                *slot += window * x;
            }
        });
        share * (LINEAR_WEIGHT * linear + LOG_WEIGHT * logarithmic)
    }
}
