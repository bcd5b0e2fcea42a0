//! Energies and powers of bands, by Fourier transforms of whole sounds.

use fourier::Complex;

/// Sample rate in Hz of the measured sounds.
pub const RATE_HZ: f64 = 48_000.0;

/// One-sided energy spectrum of a sound of even length, in full scale squared times seconds.
///
/// A bin is `RATE_HZ/length` wide.
pub fn energy_spectrum(sound: &[f64]) -> Vec<f64> {
    let spectrum = transform(sound);
    let scale = 2.0 / (RATE_HZ * sound.len() as f64);
    spectrum.iter().map(|x| x.norm_sqr() * scale).collect()
}

/// Sum of a spectrum between two frequencies. Bins at the edges count by the share that is inside.
pub fn between(spectrum: &[f64], [low_hz, high_hz]: [f64; 2]) -> f64 {
    let bin_hz = RATE_HZ / 2.0 / (spectrum.len() - 1) as f64;
    let (from, to) = (low_hz / bin_hz, high_hz / bin_hz);
    let share = |bin: usize| (to.min(bin as f64 + 0.5) - from.max(bin as f64 - 0.5)).clamp(0.0, 1.0);
    let last = (to.ceil() as usize + 1).min(spectrum.len() - 1);
    (from.floor() as usize..=last).map(|bin| spectrum[bin] * share(bin)).sum()
}

/// Part of a sound between two frequencies, cut sharply.
pub fn cut(sound: &[f64], [low_hz, high_hz]: [f64; 2]) -> Vec<f64> {
    let mut spectrum = transform(sound);
    let bin_hz = RATE_HZ / sound.len() as f64;
    for (bin, x) in spectrum.iter_mut().enumerate() {
        let hz = bin as f64 * bin_hz;
        if hz < low_hz || hz >= high_hz {
            *x = Complex::new(0.0, 0.0);
        }
    }
    let inverse = fourier::inverse(sound.len());
    let mut out = inverse.make_output_vec();
    inverse.process(&mut spectrum, &mut out).expect("the lengths fit, and the ends are real");
    out.iter_mut().for_each(|x| *x /= sound.len() as f64);
    out
}

fn transform(sound: &[f64]) -> Vec<Complex<f64>> {
    let forward = fourier::forward(sound.len());
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut sound.to_vec(), &mut spectrum).expect("the lengths fit");
    spectrum
}
