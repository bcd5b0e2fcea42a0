//! Synthetic sets of recordings of strikers on things, to measure the separation with.
//!
//! The forces are half-sines whose onsets lie between samples. The sound is computed from the
//! closed form of each mode's motion; no code is shared with the separation.

use std::f64::consts::{PI, TAU};

use crate::random::SplitMix64;

/// One recording of a set, with the parts that it is the sum of.
#[derive(Clone, Debug)]
pub struct Blow {
    /// Samples of the recording, full scale 1, as 24 bits hold them.
    pub samples: Vec<f64>,
    /// Index of the thing.
    pub object: usize,
    /// Index of the striker.
    pub striker: usize,
    /// The thing's part of the sound.
    pub of_object: Vec<f64>,
    /// The striker's part of the sound, acceleration sound included.
    pub of_striker: Vec<f64>,
    /// Onset of the blow's force in seconds.
    pub at_s: f64,
    /// True if a weak touch precedes the blow.
    pub has_touch: bool,
}

/// Sample rate of the sets in Hz.
pub const RATE_HZ: f64 = 44_100.0;
/// Length of a recording in seconds.
const LENGTH_S: f64 = 1.2;
/// Rms of the white noise in dBFS.
const NOISE_DBFS: f64 = -65.0;
/// Peak of a recording before the noise.
const PEAK: f64 = 0.7;

/// A mode: frequency in Hz, decay in 1/s, gain, phase in radians.
type Mode = (f64, f64, f64, f64);

/// Recordings of every striker on every thing, with `blows` blows each.
///
/// Things have 8 to 15 modes from 150 Hz to 6 kHz with T60 = T (f/500)^-0.5 e^{N(0, 0.3)}, T from
/// 0.15 to 1.2 s. Strikers have 4 to 8 modes from 400 Hz to 9 kHz, T from 0.06 to 0.4 s. Each blow
/// lies elsewhere: every gain changes by N(0, 4) dB. Contact times are those of the striker, 0.3 to
/// 1.2 ms, with 10 % of scatter. Over a recording the striker's sound has 4 to 14 dB less energy
/// than the thing's. One in two blows follows a touch, 16 to 28 dB weaker and 40 to 150 ms earlier.
/// White noise has -65 dBFS rms, the peak 0.7; the samples are rounded to 24 bits.
pub fn set(seed: u64, strikers: usize, things: usize, blows: usize) -> Vec<Blow> {
    let mut random = SplitMix64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5E9A_7A7E);
    let of_things: Vec<Vec<Mode>> =
        (0..things).map(|_| modes(&mut random, [8, 15], [150.0, 6e3], [0.15, 1.2])).collect();
    let of_strikers: Vec<(Vec<Mode>, f64)> = (0..strikers)
        .map(|_| {
            let modes = modes(&mut random, [4, 8], [400.0, 9e3], [0.06, 0.4]);
            (modes, 3e-4 * 4f64.powf(random.uniform()))
        })
        .collect();
    let mut set = Vec::with_capacity(strikers * things * blows);
    for (object, of_object) in of_things.iter().enumerate() {
        for (striker, (of_striker, contact_s)) in of_strikers.iter().enumerate() {
            for _ in 0..blows {
                set.push(blow(&mut random, (object, of_object), (striker, of_striker), *contact_s));
            }
        }
    }
    set
}

/// Modes that lie at least 1.5 % apart.
fn modes(random: &mut SplitMix64, count: [usize; 2], range_hz: [f64; 2], t60_s: [f64; 2]) -> Vec<Mode> {
    let count = count[0] + (random.uniform() * (count[1] - count[0] + 1) as f64) as usize;
    let base_s = t60_s[0] * (t60_s[1] / t60_s[0]).powf(random.uniform());
    let mut modes: Vec<Mode> = Vec::new();
    while modes.len() < count {
        let frequency_hz = range_hz[0] * (range_hz[1] / range_hz[0]).powf(random.uniform());
        if modes.iter().all(|mode| (mode.0 / frequency_hz).ln().abs() > 0.015) {
            let t60_s = base_s * (frequency_hz / 500.0).powf(-0.5) * (0.3 * random.normal()).exp();
            let gain = 10f64.powf(-random.uniform() * 24.0 / 20.0);
            modes.push((frequency_hz, 1000f64.ln() / t60_s.clamp(0.02, 3.0), gain, TAU * random.uniform()));
        }
    }
    modes
}

fn blow(random: &mut SplitMix64, object: (usize, &[Mode]), striker: (usize, &[Mode]), contact_s: f64) -> Blow {
    let at_s = 0.22 + 0.05 * random.uniform();
    let has_touch = random.uniform() < 0.5;
    let mut forces = vec![(at_s, contact_s * (0.1 * random.normal()).exp(), 1.0)];
    if has_touch {
        let earlier_s = 0.04 + 0.11 * random.uniform();
        let peak = 10f64.powf(-(16.0 + 12.0 * random.uniform()) / 20.0);
        forces.push((at_s - earlier_s, contact_s * (0.1 * random.normal()).exp() * 1.3, peak));
    }
    let mut elsewhere = |modes: &[Mode]| -> Vec<Mode> {
        modes.iter().map(|&(f, d, gain, phase)| (f, d, gain * 10f64.powf(0.2 * random.normal()), phase)).collect()
    };
    let (of_object, of_striker) = (elsewhere(object.1), elsewhere(striker.1));
    let mut thing = vec![0.0; (LENGTH_S * RATE_HZ) as usize];
    let mut tool = thing.clone();
    let mut push = thing.clone();
    for &force in &forces {
        of_object.iter().for_each(|&mode| ring(&mut thing, mode, force));
        of_striker.iter().for_each(|&mode| ring(&mut tool, mode, force));
        press(&mut push, force);
    }
    // The acceleration sound has 10 to 20 dB less energy than the striker's ringing.
    let accelerated = (energy(&tool) / energy(&push)).sqrt() * 10f64.powf(-(10.0 + 10.0 * random.uniform()) / 20.0);
    tool.iter_mut().zip(&push).for_each(|(x, push)| *x += accelerated * push);
    let weaker = (energy(&thing) / energy(&tool)).sqrt() * 10f64.powf(-(4.0 + 10.0 * random.uniform()) / 20.0);
    tool.iter_mut().for_each(|x| *x *= weaker);
    let peak = thing.iter().zip(&tool).map(|(a, b)| (a + b).abs()).fold(0.0, f64::max);
    thing.iter_mut().chain(&mut tool).for_each(|x| *x *= PEAK / peak);
    let noise = 10f64.powf(NOISE_DBFS / 20.0);
    let step = 2f64.powi(-23);
    let samples = thing.iter().zip(&tool).map(|(a, b)| ((a + b + noise * random.normal()) / step).round() * step);
    Blow {
        samples: samples.collect(),
        object: object.0,
        striker: striker.0,
        of_object: thing,
        of_striker: tool,
        at_s,
        has_touch,
    }
}

fn energy(samples: &[f64]) -> f64 {
    samples.iter().map(|x| x * x).sum::<f64>().max(f64::MIN_POSITIVE)
}

/// Adds a half-sine force `(onset in seconds, contact time in seconds, peak)`.
fn press(samples: &mut [f64], (at_s, contact_s, peak): (f64, f64, f64)) {
    for (n, x) in samples.iter_mut().enumerate() {
        let t = n as f64 / RATE_HZ - at_s;
        if (0.0..contact_s).contains(&t) {
            *x += peak * (PI * t / contact_s).sin();
        }
    }
}

/// Adds a mode's motion `peak ∫ sin(πu/τ) e^{-d(t-u)} cos(ω(t-u) + φ) du` under a half-sine force.
///
/// The cosine is the mean of two exponentials `e^{s(t-u)}`, `s = -d ± jω`, and each integral is
/// elementary: with `p = π/τ`, `∫₀ᵀ sin(pu) e^{s(t-u)} du = e^{st} [p - e^{-sT}(s sin pT + p cos
/// pT)] / (s² + p²)`, where T is the lesser of t and τ. Real arithmetic, so that no code is shared.
fn ring(samples: &mut [f64], (frequency_hz, d, gain, phase): Mode, (at_s, contact_s, peak): (f64, f64, f64)) {
    let (w, p) = (TAU * frequency_hz, PI / contact_s);
    // 1/(s² + p²) for s = -d + jw.
    let (below_re, below_im) = (d * d - w * w + p * p, -2.0 * d * w);
    let below = below_re * below_re + below_im * below_im;
    let scale = peak * gain * w;
    let first = (at_s * RATE_HZ).ceil() as usize;
    for (n, x) in samples.iter_mut().enumerate().skip(first) {
        let t = n as f64 / RATE_HZ - at_s;
        let until = t.min(contact_s);
        let (sine, cosine) = (p * until).sin_cos();
        let (start_re, start_im) = turned(-d * t, w * t);
        let (end_re, end_im) = turned(-d * (t - until), w * (t - until));
        // p e^{st} - e^{s(t-T)} (s sin pT + p cos pT).
        let (a, b) = (-d * sine + p * cosine, w * sine);
        let (re, im) = (p * start_re - (end_re * a - end_im * b), p * start_im - (end_re * b + end_im * a));
        let (value_re, value_im) = ((re * below_re + im * below_im) / below, (im * below_re - re * below_im) / below);
        *x += scale * (value_re * phase.cos() - value_im * phase.sin());
    }
}

/// Real and imaginary part of `e^{growth + j angle}`.
fn turned(growth: f64, angle: f64) -> (f64, f64) {
    let size = growth.exp();
    (size * angle.cos(), size * angle.sin())
}
