//! Convolution and correlation of long sounds, block by block.

use std::ops::Range;

use fourier::Complex;

/// Samples of a block of the longer sound.
const BLOCK: usize = 1 << 17;

/// Samples of a range of the convolution of two sounds.
pub(crate) fn convolved(long: &[f64], short: &[f64], range: Range<usize>) -> Vec<f64> {
    let mut sound = vec![0.0; range.len()];
    let transforms = Transforms::new(long.len().min(BLOCK) + short.len());
    let factor = transforms.spectrum(short);
    for (index, block) in long.chunks(BLOCK).enumerate() {
        let mut bins = transforms.spectrum(block);
        bins.iter_mut().zip(&factor).for_each(|(a, b)| *a *= b);
        for (n, x) in (index * BLOCK..).zip(transforms.sound(bins)) {
            if range.contains(&n) {
                sound[n - range.start] += x;
            }
        }
    }
    sound
}

/// Sums `Σ_n a[n] b[n + lag]` for all lags up to a number of them.
pub(crate) fn correlated(a: &[f64], b: &[f64], lags: usize) -> Vec<f64> {
    let mut sums = vec![0.0; lags];
    let transforms = Transforms::new(2 * (a.len().min(BLOCK) + lags));
    for (index, block) in a.chunks(BLOCK).enumerate() {
        let start = index * BLOCK;
        let mut bins = transforms.spectrum(&b[start.min(b.len())..(start + block.len() + lags).min(b.len())]);
        bins.iter_mut().zip(transforms.spectrum(block)).for_each(|(b, a)| *b *= a.conj());
        sums.iter_mut().zip(transforms.sound(bins)).for_each(|(sum, x)| *sum += x);
    }
    sums
}

/// Transforms of one length, there and back.
struct Transforms {
    size: usize,
}

impl Transforms {
    fn new(least: usize) -> Self {
        Self { size: least.next_power_of_two() }
    }

    fn spectrum(&self, sound: &[f64]) -> Vec<Complex<f64>> {
        let transform = fourier::forward(self.size);
        let (mut padded, mut bins) = (transform.make_input_vec(), transform.make_output_vec());
        padded[..sound.len()].copy_from_slice(sound);
        assert!(transform.process(&mut padded, &mut bins).is_ok(), "the lengths are those of the plan");
        bins
    }

    fn sound(&self, mut bins: Vec<Complex<f64>>) -> Vec<f64> {
        let transform = fourier::inverse(self.size);
        let mut sound = transform.make_output_vec();
        let last = bins.len() - 1;
        (bins[0].im, bins[last].im) = (0.0, 0.0);
        assert!(transform.process(&mut bins, &mut sound).is_ok(), "the lengths are those of the plan");
        sound.iter_mut().for_each(|x| *x /= self.size as f64);
        sound
    }
}
