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
