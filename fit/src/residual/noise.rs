//! Rendering of residual bands.

use fourier::Complex;

use crate::band::Band;
use crate::random::SplitMix64;

/// Renders bands from the strike on; equal seeds give equal noise.
pub fn render(bands: &[Band], length: usize, rate_hz: f64, seed: u64) -> Vec<f64> {
    let size = (length + 1).next_power_of_two().max(64);
    let mut random = SplitMix64(seed);
    let (forward, inverse) = (fourier::forward(size), fourier::inverse(size));
    let mut noise: Vec<f64> = (0..size).map(|_| random.normal()).collect();
    let mut spectrum = forward.make_output_vec();
    let mut sound = vec![0.0; length];
    if forward.process(&mut noise, &mut spectrum).is_err() {
        return sound;
    }
    let bin_hz = rate_hz / size as f64;
    for band in bands.iter().filter(|band| band.weight > 0.0) {
        let inside = |bin: usize| (band.edges_hz[0]..band.edges_hz[1]).contains(&(bin as f64 * bin_hz));
        let mut part: Vec<Complex<f64>> = spectrum
            .iter()
            .enumerate()
            .map(|(bin, value)| if inside(bin) { *value } else { Complex::new(0.0, 0.0) })
            .collect();
        let mut wave = inverse.make_output_vec();
        if inverse.process(&mut part, &mut wave).is_err() {
            continue;
        }
        let rms = (wave.iter().map(|x| x * x).sum::<f64>() / size as f64).sqrt();
        if rms <= 0.0 {
            continue;
        }
        let fade = 10f64.powf(-band.decay_db_per_s / (20.0 * rate_hz));
        let mut gain = band.weight / rms;
        for (sound, wave) in sound.iter_mut().zip(&wave) {
            *sound += gain * wave;
            gain *= fade;
        }
    }
    sound
}
