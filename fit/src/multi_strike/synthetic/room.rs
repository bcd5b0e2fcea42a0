//! The sets with pink noise and with a room.

use std::f64::consts::TAU;

use super::{RATE_HZ, SHORTER, SPLIT_HZ, StruckOften, TrueRoom, plain};
use crate::random::SplitMix64;

/// Many strikes at one place of an object in a room: the set *room*.
///
/// Object and strikes are those of [`plain`]. The room answers with noise that decays with a T60 of
/// 0.35 to 0.8 s, shorter at high frequencies, and has 9 to 14 dB less energy than the direct
/// sound. Pink noise has -56 dBFS rms.
pub fn in_room(seed: u64, seconds: f64, count: usize) -> StruckOften {
    let mut sound = plain(seed, seconds, count, -200.0);
    let mut random = SplitMix64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x0005_0077);
    let t60_s = 0.35 + 0.45 * random.uniform();
    let gain_db = -(9.0 + 5.0 * random.uniform());
    let response = room_response(&mut random, t60_s, 10f64.powf(gain_db / 20.0));
    let reflected = convolved(&sound.samples, &response);
    sound.room = Some(TrueRoom { t60_s, gain_db });
    sound.noise_rms = 10f64.powf(PINK_DBFS / 20.0);
    let pink = pink_noise(&mut random, sound.samples.len());
    let step = 2f64.powi(-23);
    for ((sample, reflected), pink) in sound.samples.iter_mut().zip(&reflected).zip(&pink) {
        *sample = ((*sample + reflected + sound.noise_rms * pink) / step).round() * step;
    }
    sound
}

/// Level of the pink noise of [`in_room`] in dBFS rms.
const PINK_DBFS: f64 = -56.0;

/// Noise in two bands, split at 2 kHz, that decays; its energy is `level²`.
fn room_response(random: &mut SplitMix64, t60_s: f64, level: f64) -> Vec<f64> {
    let length = (1.2 * t60_s * RATE_HZ) as usize;
    let smoothing = (-TAU * SPLIT_HZ / RATE_HZ).exp();
    let mut low = 0.0;
    let mut response: Vec<f64> = (0..length)
        .map(|n| {
            let white = random.normal();
            low = smoothing * low + (1.0 - smoothing) * white;
            let t = n as f64 / RATE_HZ;
            let fall = |t60_s: f64| (-1000f64.ln() * t / t60_s).exp();
            low * fall(t60_s) + (white - low) * fall(SHORTER * t60_s)
        })
        .collect();
    let energy: f64 = response.iter().map(|x| x * x).sum();
    response.iter_mut().for_each(|x| *x *= level / energy.sqrt());
    response
}

/// Pink noise of rms 1: white noise through `1/sqrt(f)` above 10 Hz.
pub(super) fn pink_noise(random: &mut SplitMix64, length: usize) -> Vec<f64> {
    let size = length.next_power_of_two();
    let (forward, inverse) = (fourier::forward(size), fourier::inverse(size));
    let mut noise: Vec<f64> = (0..size).map(|_| random.normal()).collect();
    let mut bins = forward.make_output_vec();
    let is_made = forward.process(&mut noise, &mut bins).is_ok();
    for (index, bin) in bins.iter_mut().enumerate() {
        *bin /= (index as f64 * RATE_HZ / size as f64).max(10.0).sqrt();
    }
    bins[0] = fourier::Complex::new(0.0, 0.0);
    if let Some(last) = bins.last_mut() {
        last.im = 0.0;
    }
    let is_made = is_made && inverse.process(&mut bins, &mut noise).is_ok();
    assert!(is_made, "the lengths are those of the plans");
    noise.truncate(length);
    let rms = (noise.iter().map(|x| x * x).sum::<f64>() / length as f64).sqrt();
    noise.iter_mut().for_each(|x| *x /= rms);
    noise
}

/// Convolution of two sounds, as long as the first.
fn convolved(samples: &[f64], response: &[f64]) -> Vec<f64> {
    let size = (samples.len() + response.len()).next_power_of_two();
    let (forward, inverse) = (fourier::forward(size), fourier::inverse(size));
    let spectrum = |sound: &[f64]| {
        let mut padded = sound.to_vec();
        padded.resize(size, 0.0);
        let mut bins = forward.make_output_vec();
        assert!(forward.process(&mut padded, &mut bins).is_ok(), "the lengths are those of the plan");
        bins
    };
    let (mut product, other) = (spectrum(samples), spectrum(response));
    product.iter_mut().zip(&other).for_each(|(a, b)| *a *= b);
    let last = product.len() - 1;
    (product[0].im, product[last].im) = (0.0, 0.0);
    let mut sound = inverse.make_output_vec();
    assert!(inverse.process(&mut product, &mut sound).is_ok(), "the lengths are those of the plan");
    sound.truncate(samples.len());
    sound.iter_mut().for_each(|x| *x /= size as f64);
    sound
}
