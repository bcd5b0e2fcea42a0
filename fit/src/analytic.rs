//! Complex signals from a part of a spectrum.

use fourier::Complex;

/// Samples `Σ X[k] e^(2πj(k+1)n/count)`, n from 0 to `count - 1`, of at most `count` bins.
///
/// The bins stand one place higher than in the slice, where bin 0 would have no phase. Real and
/// imaginary part are one real transform each: of the spectrum's Hermitian part, and of the rest.
pub(crate) fn samples(bins: &[Complex<f64>], count: usize) -> Vec<Complex<f64>> {
    let count = count.max(1);
    let inverse = fourier::inverse(count);
    let zero = Complex::new(0.0, 0.0);
    let at = |place: usize| match place {
        0 => bins.get(count - 1).copied().unwrap_or(zero),
        place => bins.get(place - 1).copied().unwrap_or(zero),
    };
    let (mut re, mut im) = (inverse.make_input_vec(), inverse.make_input_vec());
    for (place, (re, im)) in re.iter_mut().zip(&mut im).enumerate() {
        let (bin, mirrored) = (at(place), at((count - place) % count).conj());
        let rest = 0.5 * (bin - mirrored);
        (*re, *im) = (0.5 * (bin + mirrored), Complex::new(rest.im, -rest.re));
    }
    let wave = |spectrum: &mut [Complex<f64>]| {
        let mut wave = inverse.make_output_vec();
        let _unscaled = inverse.process(spectrum, &mut wave);
        wave
    };
    let (re, im) = (wave(&mut re), wave(&mut im));
    re.into_iter().zip(im).map(|(re, im)| Complex::new(re, im)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_the_plain_sum() {
        let bins = [Complex::new(1.0, 0.5), Complex::new(-0.3, 0.2), Complex::new(0.0, 2.0)];
        for count in [3, 4, 7, 8] {
            for (n, sample) in samples(&bins, count).into_iter().enumerate() {
                let turn =
                    |k: usize| Complex::from_polar(1.0, std::f64::consts::TAU * ((k + 1) * n) as f64 / count as f64);
                let plain: Complex<f64> = bins.iter().enumerate().map(|(k, bin)| bin * turn(k)).sum();
                assert!((sample - plain).norm() < 1e-12, "{n} of {count}: {sample} {plain}");
            }
        }
    }
}
