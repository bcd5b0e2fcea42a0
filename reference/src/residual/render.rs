//! One realisation of the residual: white noise, cut into bands, each under its own envelope.

use super::band::{Band, Hold};
use super::expectation::envelope;
use super::fourier::transform;
use crate::rate::SampleRate;
use crate::resonator::Complex;

/// Sound of one strike at the reference force, `length` samples from the strike on.
///
/// Each seed gives another noise. The bands are cut from the spectrum of one Gaussian noise, so
/// that their edges are sharp. A band's rms is right on average over seeds.
pub fn render(bands: &[Band], length: usize, rate: SampleRate, seed: u64) -> Vec<f64> {
    render_held(bands, &[], length, rate, seed)
}

/// Sound of [`render`] while hands lie on the object.
pub fn render_held(bands: &[Band], holds: &[Hold], length: usize, rate: SampleRate, seed: u64) -> Vec<f64> {
    let size = length.next_power_of_two().max(2);
    let mut random = Random(seed);
    let noise: Vec<Complex> = (0..size).map(|_| Complex { re: random.normal(), im: 0.0 }).collect();
    let spectrum = transform(&noise, -1.0);
    let mut sound = vec![0.0; length];
    for band in bands.iter().filter(|band| band.weight != 0.0) {
        let [low, high] = band.edges_hz;
        let hertz = |bin: usize| bin.min(size - bin) as f64 * rate.hz() / size as f64;
        let inside = |bin: usize| hertz(bin) >= low && hertz(bin) < high;
        let cut = spectrum.iter().enumerate().map(|(bin, x)| if inside(bin) { *x } else { Complex::ZERO });
        let wave = transform(&cut.collect::<Vec<_>>(), 1.0);
        // White noise of variance 1 has the power 2 (f2 - f1)/fs in a band. The transform there and
        // back multiplies by its size.
        let gain = band.weight / (2.0 * (high - low) / rate.hz()).sqrt() / size as f64;
        for (n, (sound, wave)) in sound.iter_mut().zip(&wave).enumerate() {
            *sound += gain * wave.re * envelope(band, holds, n as f64 / rate.hz());
        }
    }
    sound
}

/// Generator SplitMix64 (Steele, Lea, Flood 2014), with normal numbers by the Box-Muller transform.
struct Random(u64);

impl Random {
    /// Draws the next uniform number, 0 to 1.
    fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.even()).ln()).sqrt();
        radius * (2.0 * std::f64::consts::PI * self.even()).cos()
    }
}
