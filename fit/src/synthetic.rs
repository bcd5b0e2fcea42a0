//! Sounds of known modes, to measure estimators with.

use crate::modes::DampedSine;

/// A recording of which everything is known.
#[derive(Clone, Debug)]
pub struct Synthetic {
    /// The sound.
    pub samples: Vec<f64>,
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// The modes in it.
    pub modes: Vec<DampedSine>,
    /// Rms of the white noise in it.
    pub noise_rms: f64,
}

/// 44.1 kHz.
const RATE_HZ: f64 = 44_100.0;
/// 2 s.
const LENGTH: usize = 88_200;
const PEAK: f64 = 0.9;

/// Twenty damped sines that ring from sample 0, and white noise.
///
/// Frequencies log-uniform from 120 Hz to 11 kHz, at least 1 % apart; T60 = clip(3 (f/200)^-0.6 e^{N(0, 0.3)}, 0.08, 4) s; amplitudes 0
/// to -36 dB; random phases; 2 s at 44.1 kHz with a peak of 0.9 (before the noise); noise of `noise_dbfs` dBFS rms.
pub fn struck(seed: u64, noise_dbfs: f64) -> Synthetic {
    let mut random = SplitMix64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03);
    let mut frequencies: Vec<f64> = Vec::new();
    while frequencies.len() < 20 {
        let frequency = 120.0 * (11_000.0f64 / 120.0).powf(random.uniform());
        if frequencies.iter().all(|other| (frequency / other).ln().abs() >= 1.01f64.ln()) {
            frequencies.push(frequency);
        }
    }
    let modes = frequencies.into_iter().map(|frequency_hz| {
        let t60_s = 3.0 * (frequency_hz / 200.0).powf(-0.6) * (0.3 * random.normal()).exp();
        DampedSine {
            frequency_hz,
            decay_per_s: 1000f64.ln() / t60_s.clamp(0.08, 4.0),
            amplitude: 10f64.powf(-36.0 / 20.0 * random.uniform()),
            phase: std::f64::consts::TAU * random.uniform(),
        }
    });
    of_modes(modes.collect(), LENGTH, &mut random, noise_dbfs)
}

/// Given damped sines and white noise: `length` samples at 44.1 kHz with a peak of 0.9 before the noise; noise of `noise_dbfs` dBFS rms.
pub fn of_these(modes: Vec<DampedSine>, length: usize, seed: u64, noise_dbfs: f64) -> Synthetic {
    of_modes(modes, length, &mut SplitMix64(seed), noise_dbfs)
}

fn of_modes(mut modes: Vec<DampedSine>, length: usize, random: &mut SplitMix64, noise_dbfs: f64) -> Synthetic {
    // Sample by sample from the formula, so that nothing is shared with what the estimators do.
    let mut samples: Vec<f64> = (0..length)
        .map(|n| {
            let t = n as f64 / RATE_HZ;
            let sine = |mode: &DampedSine| {
                let turn = std::f64::consts::TAU * mode.frequency_hz * t + mode.phase;
                mode.amplitude * (-mode.decay_per_s * t).exp() * turn.cos()
            };
            modes.iter().map(sine).sum()
        })
        .collect();
    let peak = samples.iter().fold(f64::MIN_POSITIVE, |peak: f64, x| peak.max(x.abs()));
    let noise_rms = 10f64.powf(noise_dbfs / 20.0);
    for sample in &mut samples {
        *sample = *sample * PEAK / peak + noise_rms * random.normal();
    }
    for mode in &mut modes {
        mode.amplitude *= PEAK / peak;
    }
    Synthetic { samples, rate_hz: RATE_HZ, modes, noise_rms }
}

/// Steele, Lea and Flood's SplitMix64.
#[derive(Clone, Debug)]
pub(crate) struct SplitMix64(pub(crate) u64);

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// 0 to 1, 1 excluded.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Mean 0, variance 1 (Box and Muller).
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
