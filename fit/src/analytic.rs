//! Complex signals from a part of a spectrum.

use fourier::Complex;

/// Samples `Σ X[k] e^(2πj(k+1)n/count)`, n from 0 to `count - 1`, of at most `count` bins.
///
/// The bins stand one place higher than in the slice, where bin 0 would have no phase. Two real
/// transforms of twice the length make the real and the imaginary part.
pub(crate) fn samples(bins: &[Complex<f64>], count: usize) -> Vec<Complex<f64>> {
    let inverse = fourier::inverse(2 * count.max(1));
    let part = |turn: Complex<f64>| {
        let mut spectrum = inverse.make_input_vec();
        for (slot, bin) in spectrum.iter_mut().skip(1).zip(bins) {
            *slot = bin * turn * 0.5;
        }
        if let Some(last) = spectrum.last_mut() {
            last.im = 0.0;
        }
        let mut wave = inverse.make_output_vec();
        let _unscaled = inverse.process(&mut spectrum, &mut wave);
        wave
    };
    let (re, im) = (part(Complex::new(1.0, 0.0)), part(Complex::new(0.0, -1.0)));
    re.into_iter().zip(im).step_by(2).map(|(re, im)| Complex::new(re, im)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_the_plain_sum() {
        let bins = [Complex::new(1.0, 0.5), Complex::new(-0.3, 0.2), Complex::new(0.0, 2.0)];
        for (n, sample) in samples(&bins, 7).into_iter().enumerate() {
            let turn = |k: usize| Complex::from_polar(1.0, std::f64::consts::TAU * ((k + 1) * n) as f64 / 7.0);
            let plain: Complex<f64> = bins.iter().enumerate().map(|(k, bin)| bin * turn(k)).sum();
            assert!((sample - plain).norm() < 1e-12, "{n}: {sample} {plain}");
        }
    }
}
