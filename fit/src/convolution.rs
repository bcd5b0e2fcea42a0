//! Convolution of sounds by Fourier transforms, and its adjoint.

use std::sync::Arc;

use fourier::{Complex, ComplexToReal, RealToComplex};

/// Transforms long enough for the convolution of two sounds.
#[derive(Clone)]
pub(crate) struct Convolution {
    size: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

/// Smallest even number that is not below `length`.
pub(crate) fn even(length: usize) -> usize {
    length.next_multiple_of(2)
}

/// Smallest even number from `length` on whose prime factors are 2, 3 and 5, for which transforms
/// are fast.
pub(crate) fn fast_length(length: usize) -> usize {
    let is_smooth = |length: &usize| {
        let mut rest = *length;
        for factor in [2, 3, 5] {
            while rest.is_multiple_of(factor) {
                rest /= factor;
            }
        }
        rest == 1
    };
    (even(length.max(2))..).step_by(2).find(is_smooth).unwrap_or(length)
}

impl Convolution {
    /// Transforms for sounds that are at most `length` samples long together.
    pub(crate) fn new(length: usize) -> Self {
        let size = fast_length(length);
        Self { size, forward: fourier::forward(size), inverse: fourier::inverse(size) }
    }

    /// Length of the transforms, at least that of both sounds.
    pub(crate) fn size(&self) -> usize {
        self.size
    }

    /// Spectrum of a sound, scaled so that products of two spectra transform back without a scale.
    pub(crate) fn spectrum(&self, sound: &[f64]) -> Vec<Complex<f64>> {
        let scale = (self.size as f64).sqrt().recip();
        let (mut input, mut output) = (self.forward.make_input_vec(), self.forward.make_output_vec());
        input.iter_mut().zip(sound).for_each(|(slot, x)| *slot = scale * x);
        let _transformed = self.forward.process(&mut input, &mut output);
        output
    }

    fn sound(&self, mut spectrum: Vec<Complex<f64>>, length: usize) -> Vec<f64> {
        let mut sound = self.inverse.make_output_vec();
        let _transformed = self.inverse.process(&mut spectrum, &mut sound);
        sound.truncate(length);
        sound
    }

    /// First `length` samples of the convolution of two sounds, from their spectra.
    pub(crate) fn convolved(&self, a: &[Complex<f64>], b: &[Complex<f64>], length: usize) -> Vec<f64> {
        self.sound(a.iter().zip(b).map(|(a, b)| a * b).collect(), length)
    }

    /// Sums `Σ a[n + m] b[n]` for m below `length`, from the spectra of a and b: the adjoint of the
    /// convolution with b.
    pub(crate) fn correlated(&self, a: &[Complex<f64>], b: &[Complex<f64>], length: usize) -> Vec<f64> {
        self.sound(a.iter().zip(b).map(|(a, b)| a * b.conj()).collect(), length)
    }
}

/// A long sound, for its correlation with others over lags that are far shorter than it.
///
/// Its parts are transformed one by one: transforms of a few times the lags are faster than those
/// of the whole sound, and one inverse does for all of them.
pub(crate) struct Correlation {
    transforms: Convolution,
    lags: usize,
    /// Spectra of the sound's parts.
    parts: Vec<Vec<Complex<f64>>>,
}

/// Length of the transforms of a [`Correlation`], in lags.
const LAGS_IN_PART: usize = 4;

impl Correlation {
    /// Correlation with a sound over a number of lags from 0 on.
    pub(crate) fn new(sound: &[f64], lags: usize) -> Self {
        let lags = lags.max(1);
        let transforms = Convolution::new(LAGS_IN_PART * lags);
        let parts = sound.chunks(transforms.size() - lags).map(|part| transforms.spectrum(part)).collect();
        Self { transforms, lags, parts }
    }

    /// Sums `Σ a[n + m] b[n]` over n for each lag m, b the sound of this correlation.
    pub(crate) fn with(&self, a: &[f64]) -> Vec<f64> {
        let size = self.transforms.size();
        let mut sums = self.transforms.forward.make_output_vec();
        for (index, part) in self.parts.iter().enumerate() {
            // A part meets the samples up to the largest lag behind it.
            let from = (index * (size - self.lags)).min(a.len());
            let met = self.transforms.spectrum(&a[from..a.len().min(from + size)]);
            sums.iter_mut().zip(&met).zip(part).for_each(|((sum, a), b)| *sum += a * b.conj());
        }
        self.transforms.sound(sums, self.lags)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn correlation_part_by_part_is_the_plain_sum() {
        let mut random = SplitMix64(3);
        for (length, other, lags) in [(1_000, 1_000, 40), (997, 1_200, 64), (10, 300, 30), (0, 5, 4)] {
            let mut noise = |length: usize| (0..length).map(|_| random.normal()).collect::<Vec<f64>>();
            let (b, a) = (noise(length), noise(other));
            let found = Correlation::new(&b, lags).with(&a);
            assert_eq!(found.len(), lags);
            for (lag, found) in found.iter().enumerate() {
                let sum: f64 = a.get(lag..).unwrap_or(&[]).iter().zip(&b).map(|(a, b)| a * b).sum();
                assert!((found - sum).abs() < 1e-9, "{length} {lag}: {found} {sum}");
            }
        }
    }
}
