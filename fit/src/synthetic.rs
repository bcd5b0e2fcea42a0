//! Synthetic sounds of known modes, to measure estimators with.

use crate::audio::Recording;
use crate::contact;
use crate::modes::DampedSine;
use crate::random::SplitMix64;

/// A sound whose modes and noise are known.
#[derive(Clone, Debug)]
pub struct Synthetic {
    /// Samples, full scale 1.
    pub samples: Vec<f64>,
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// Modes of the sound.
    pub modes: Vec<DampedSine>,
    /// Rms of the white noise in the sound.
    pub noise_rms: f64,
}

/// Sample rate in Hz.
const RATE_HZ: f64 = 44_100.0;
/// Number of samples: 2 s.
const LENGTH: usize = 88_200;
const PEAK: f64 = 0.9;

/// Twenty damped sines that ring from sample 0, and white noise of `noise_dbfs` dBFS rms.
///
/// Frequencies are log-uniform from 120 Hz to 11 kHz, at least 1 % apart. T60 = clip(3 (f/200)^-0.6
/// e^{N(0, 0.3)}, 0.08, 4) s. Amplitudes are 0 to -36 dB, phases random. The sound is 2 s long at
/// 44.1 kHz, with a peak of 0.9 before the noise.
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

/// Given damped sines, and white noise of `noise_dbfs` dBFS rms.
///
/// `length` samples at 44.1 kHz, with a peak of 0.9 before the noise.
pub fn of_these(modes: Vec<DampedSine>, length: usize, seed: u64, noise_dbfs: f64) -> Synthetic {
    of_modes(modes, length, &mut SplitMix64(seed), noise_dbfs)
}

fn of_modes(mut modes: Vec<DampedSine>, length: usize, random: &mut SplitMix64, noise_dbfs: f64) -> Synthetic {
    // Computed sample by sample from the formula, so that no code is shared with the estimators.
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

/// Strikes of an impact hammer on an object of known modes, recorded by an instrumented hammer and
/// a microphone.
#[derive(Clone, Debug)]
pub struct Hammered {
    /// Microphone and force at 44.1 kHz, full scale 1.
    pub recording: Recording,
    /// Contact time of each strike's force in seconds.
    pub contact_times_s: Vec<f64>,
}

/// Number of strikes of [`hammered`].
pub const HAMMER_STRIKES: usize = 8;
/// Time in seconds from one strike of [`hammered`] to the next.
const HAMMER_SPACING_S: f64 = 0.5;
/// Delay in samples of the microphone of [`hammered`] behind the force: 15 cm.
const HAMMER_DELAY: usize = 20;
/// Rms of the white noise of microphone and force, in dBFS.
const HAMMER_NOISE_DBFS: [f64; 2] = [-62.0, -66.0];

/// Eight strikes on an object of 20 modes like a mug's, rendered by the reference under each
/// strike's force.
///
/// Frequencies are from 500 Hz to 11 kHz; T60 is 0.4 s at 500 Hz and falls. Contact times are 0.3
/// to 0.6 ms, peaks of the force 0.15 to 0.9 of full scale. Strikes hit places along a line, each
/// with gains of its own. Microphone and force have white noise of -62 and -66 dBFS rms.
pub fn hammered(seed: u64) -> Hammered {
    let mut random = SplitMix64(seed);
    let place = |index: usize| index as f64 * 0.618_034 % 1.0;
    let modes: Vec<(f64, f64, f64, f64)> = (0..20)
        .map(|index| {
            let frequency_hz = 500.0 * 22f64.powf((f64::from(index) + 0.6 * random.uniform()) / 20.0);
            let t60_s = 0.4 * (frequency_hz / 500.0).powf(-0.6) * (0.2 * random.normal()).exp();
            let level = 10f64.powf(-24.0 / 20.0 * random.uniform());
            (frequency_hz, 1000f64.ln() / t60_s, level, std::f64::consts::TAU * random.uniform())
        })
        .collect();
    let spacing = (HAMMER_SPACING_S * RATE_HZ) as usize;
    let length = spacing * HAMMER_STRIKES + spacing / 4;
    let (mut samples, mut force) = (vec![0.0; length], vec![0.0; length]);
    let mut contact_times_s = Vec::new();
    for index in 0..HAMMER_STRIKES {
        let peak = 0.15 * 6f64.powf(random.uniform());
        let contact_time_s = 0.35e-3 * peak.powf(-0.2) * (0.1 * random.normal()).exp();
        let pulse: Vec<f64> = contact::force(contact_time_s, RATE_HZ).iter().map(|x| peak * x).collect();
        // Each mode has nodes of its own along the line.
        let at = |(frequency_hz, decay_per_s, level, phase): (f64, f64, f64, f64)| reference::Mode {
            frequency_hz,
            decay_per_s,
            gains: vec![reference::Gain {
                sine: 3000.0 * level * (phase + 2.0 * place(index)).cos(),
                cosine: 600.0 * level * (phase + 2.0 * place(index)).sin(),
            }],
        };
        let sound = under_force(modes.iter().copied().map(at).collect(), &pulse, spacing);
        let from = spacing / 4 + index * spacing;
        force[from..from + pulse.len()].copy_from_slice(&pulse);
        samples[from + HAMMER_DELAY..].iter_mut().zip(sound).for_each(|(sum, x)| *sum += x);
        contact_times_s.push(contact_time_s);
    }
    for (channel, noise_dbfs) in [&mut samples, &mut force].into_iter().zip(HAMMER_NOISE_DBFS) {
        let noise_rms = 10f64.powf(noise_dbfs / 20.0);
        channel.iter_mut().for_each(|x| *x += noise_rms * random.normal());
    }
    let recording = Recording {
        samples,
        offset: 0.0,
        force: Some(force),
        flat_tops: Vec::new(),
        rate_hz: RATE_HZ,
        notes: Vec::new(),
    };
    Hammered { recording, contact_times_s }
}

/// Sound of `modes` under a force at 44.1 kHz, rendered by the reference.
fn under_force(modes: Vec<reference::Mode>, force: &[f64], length: usize) -> Vec<f64> {
    let pad = reference::Pad {
        object: reference::Object {
            modes,
            acceleration: reference::Acceleration::NONE,
            biquads: Vec::new(),
            dynamic_filter: None,
        },
        strikers: Vec::new(),
        striker_weight: 0.0,
        level_db: 0.0,
        pan: -1.0,
        choke_t60_s: 0.0,
        is_in_frames: false,
    };
    let rate = reference::SampleRate { numerator: RATE_HZ as u32, denominator: 1 };
    let direct = reference::Direct { pad: 0, force };
    reference::render(&[pad], &[], Some(direct), rate, length)
        .map(|frames| frames.iter().map(|frame| frame[0]).collect())
        .unwrap_or_default()
}
