//! Synthetic recordings of many strikes on one object, to measure the joint fit with.
//!
//! The forces are half-sines whose onsets lie between samples. The sound is computed from the
//! closed form of each mode's motion; no code is shared with the fit.

mod places;
mod room;

use std::f64::consts::{PI, TAU};

pub use places::at_places;
pub use room::in_room;

use crate::random::SplitMix64;

/// A recording of many strikes whose modes, forces and noise are known.
#[derive(Clone, Debug)]
pub struct StruckOften {
    /// Samples, full scale 1, as 24 bits hold them.
    pub samples: Vec<f64>,
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// Modes of the object in order of frequency, then those of the strikers.
    pub modes: Vec<TrueMode>,
    /// Strikes in order of time.
    pub strikes: Vec<TrueStrike>,
    /// Rms of the noise in the sound.
    pub noise_rms: f64,
    /// Room, if there is one.
    pub room: Option<TrueRoom>,
}

impl StruckOften {
    /// Samples clipped at both limits: at a share of the peak, at most 1.
    pub fn clipped(&self, share: f64) -> Vec<f64> {
        let limit = share * self.samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        self.samples.iter().map(|x| x.clamp(-limit, limit)).collect()
    }
}

/// Room of a synthetic recording.
#[derive(Clone, Copy, Debug)]
pub struct TrueRoom {
    /// T60 in seconds below 2 kHz.
    pub t60_s: f64,
    /// Energy of the room's response over that of the direct sound, in dB.
    pub gain_db: f64,
}

impl TrueRoom {
    /// T60 in seconds in the octave about a frequency: shorter above 2 kHz.
    pub fn t60_s_at(&self, frequency_hz: f64) -> f64 {
        let octaves = (frequency_hz / SPLIT_HZ).log2().clamp(-0.5, 0.5);
        self.t60_s * SHORTER.powf(octaves + 0.5)
    }
}

/// Frequency in Hz that parts the two bands of a room.
const SPLIT_HZ: f64 = 2_000.0;
/// Ratio of the upper band's T60 to that of the lower one.
const SHORTER: f64 = 0.7;

/// A mode of a synthetic object.
#[derive(Clone, Debug)]
pub struct TrueMode {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Decay rate in 1/s.
    pub decay_per_s: f64,
    /// Gains `[sine, cosine]` in output per newton-second.
    pub gain: [f64; 2],
    /// Numbers a and b of the shape `cos(π (a x + b))` along the object, by which the gains are
    /// multiplied.
    pub shape: [f64; 2],
    /// Striker whose own mode it is; `None` for a mode of the object.
    pub striker: Option<usize>,
}

impl TrueMode {
    /// T60 in seconds.
    pub fn t60_s(&self) -> f64 {
        1000f64.ln() / self.decay_per_s
    }

    /// Factor of the gains at a position from 0 to 1.
    pub fn shape_at(&self, position: f64) -> f64 {
        (PI * (self.shape[0] * position + self.shape[1])).cos()
    }
}

/// A strike of a synthetic recording.
#[derive(Clone, Copy, Debug)]
pub struct TrueStrike {
    /// Onset of the force in seconds.
    pub at_s: f64,
    /// Contact time in seconds.
    pub contact_time_s: f64,
    /// Peak of the force, 1 for the strongest strike.
    pub peak_force: f64,
    /// Position along the object, 0 to 1.
    pub position: f64,
    /// Number of the striker.
    pub striker: usize,
}

impl TrueStrike {
    /// Middle of the contact in seconds.
    pub fn middle_s(&self) -> f64 {
        self.at_s + 0.5 * self.contact_time_s
    }
}

/// Sample rate in Hz.
const RATE_HZ: f64 = 44_100.0;
/// Peak of the sound before the noise.
const PEAK: f64 = 0.8;
/// Least ratio of the frequencies of two modes.
const APART: f64 = 1.015;
/// Least time in seconds from one strike to the next.
const LEAST_GAP_S: f64 = 0.1;
/// Range of the strikes' peaks in dB.
const RANGE_DB: f64 = 30.0;

/// Many strikes at one place of an object: the set *plain*.
///
/// The object has 12 to 21 modes from 180 Hz to 7 kHz, 1.5 % apart or more, with T60 = clip(1.2
/// (f/500)^-0.6 e^{N(0, 0.3)}, 0.06, 3) s and levels over 24 dB. Peaks of the force are uniform
/// over 30 dB, contact times `τ1 m^(-1/6)` with 5 % of scatter and τ1 from 0.4 to 0.9 ms. Gaps are
/// 0.1 s plus an exponential. White noise has `noise_dbfs` dBFS rms; the samples are rounded to 24
/// bits.
pub fn plain(seed: u64, seconds: f64, count: usize, noise_dbfs: f64) -> StruckOften {
    let mut random = SplitMix64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5712_1CE5);
    let modes = modes(&mut random);
    let strikes = strikes(&mut random, seconds, count);
    render(modes, strikes, seconds, noise_dbfs, |length| (0..length).map(|_| random.normal()).collect())
}

fn modes(random: &mut SplitMix64) -> Vec<TrueMode> {
    let count = 12 + (10.0 * random.uniform()) as usize;
    let mut frequencies: Vec<f64> = Vec::new();
    while frequencies.len() < count {
        let frequency = 180.0 * (7_000.0f64 / 180.0).powf(random.uniform());
        if frequencies.iter().all(|other| (frequency / other).ln().abs() >= APART.ln()) {
            frequencies.push(frequency);
        }
    }
    frequencies.sort_by(f64::total_cmp);
    let of_frequency = |frequency_hz: f64| {
        let t60_s = 1.2 * (frequency_hz / 500.0).powf(-0.6) * (0.3 * random.normal()).exp();
        let level = 10f64.powf(-24.0 / 20.0 * random.uniform());
        let phase = TAU * random.uniform();
        TrueMode {
            frequency_hz,
            decay_per_s: 1000f64.ln() / t60_s.clamp(0.06, 3.0),
            gain: [level * phase.cos(), level * phase.sin()],
            shape: [0.0; 2],
            striker: None,
        }
    };
    frequencies.into_iter().map(of_frequency).collect()
}

fn strikes(random: &mut SplitMix64, seconds: f64, count: usize) -> Vec<TrueStrike> {
    let free_s = (seconds - 0.3 - LEAST_GAP_S * count as f64).max(0.0);
    // Sorted uniform numbers have exponential gaps.
    let mut places: Vec<f64> = (0..count).map(|_| random.uniform()).collect();
    places.sort_by(f64::total_cmp);
    let hardest_s = 0.4e-3 + 0.5e-3 * random.uniform();
    let mut strikes: Vec<TrueStrike> = places
        .iter()
        .enumerate()
        .map(|(index, place)| {
            let peak_force = 10f64.powf(-RANGE_DB / 20.0 * random.uniform());
            TrueStrike {
                at_s: 0.05 + place * free_s + LEAST_GAP_S * index as f64,
                contact_time_s: hardest_s * peak_force.powf(-1.0 / 6.0) * (0.05 * random.normal()).exp(),
                peak_force,
                position: 0.0,
                striker: 0,
            }
        })
        .collect();
    let most = strikes.iter().map(|strike| strike.peak_force).fold(f64::MIN_POSITIVE, f64::max);
    strikes.iter_mut().for_each(|strike| strike.peak_force /= most);
    strikes
}

pub(super) fn render(
    mut modes: Vec<TrueMode>,
    strikes: Vec<TrueStrike>,
    seconds: f64,
    noise_dbfs: f64,
    noise: impl FnOnce(usize) -> Vec<f64>,
) -> StruckOften {
    let mut samples = vec![0.0; (seconds * RATE_HZ) as usize];
    for strike in &strikes {
        for mode in modes.iter().filter(|mode| mode.striker.is_none_or(|striker| striker == strike.striker)) {
            add_response(mode, strike, &mut samples);
        }
    }
    let peak = samples.iter().fold(f64::MIN_POSITIVE, |peak: f64, x| peak.max(x.abs()));
    let noise_rms = 10f64.powf(noise_dbfs / 20.0);
    let step = 2f64.powi(-23);
    let noise = noise(samples.len());
    for (sample, noise) in samples.iter_mut().zip(noise) {
        *sample = ((*sample * PEAK / peak + noise_rms * noise) / step).round() * step;
    }
    for mode in &mut modes {
        mode.gain = mode.gain.map(|gain| gain * PEAK / peak);
    }
    StruckOften { samples, rate_hz: RATE_HZ, modes, strikes, noise_rms, room: None }
}

/// Adds the motion of a mode under the half-sine force of a strike.
///
/// With `p = π/τ` the motion under `sin pt` is the steady response to it plus a free decay:
/// `Im[H (e^{jpt} - e^{st})]` for each of the two parts of the sine.
pub(super) fn add_response(mode: &TrueMode, strike: &TrueStrike, samples: &mut [f64]) {
    let (decay, angular) = (mode.decay_per_s, TAU * mode.frequency_hz);
    let p = PI / strike.contact_time_s;
    // ∫ sin(pu) e^{-d(t-u)} e^{jω(t-u)} du from 0 to `to`, by the antiderivatives of both parts.
    let antiderivative = |turn: f64, u: f64| {
        // e^{(d + j(turn))u} / (d + j turn)
        let grown = (decay * u).exp();
        let (sine, cosine) = (turn * u).sin_cos();
        let size = decay * decay + turn * turn;
        [grown * (cosine * decay + sine * turn) / size, grown * (sine * decay - cosine * turn) / size]
    };
    let integral = |to: f64| {
        // sin(pu) e^{-jωu} = (e^{j(p-ω)u} - e^{-j(p+ω)u}) / 2j
        let difference = |turn: f64| {
            let (upper, lower) = (antiderivative(turn, to), antiderivative(turn, 0.0));
            [upper[0] - lower[0], upper[1] - lower[1]]
        };
        let (first, second) = (difference(p - angular), difference(-p - angular));
        [0.5 * (first[1] - second[1]), -0.5 * (first[0] - second[0])]
    };
    let whole = integral(strike.contact_time_s);
    let gain = mode.gain.map(|gain| gain * mode.shape_at(strike.position));
    let first = (strike.at_s * RATE_HZ).ceil().max(0.0) as usize;
    // Until the mode has decayed by 160 dB.
    let last = first + ((18.4 / decay + strike.contact_time_s) * RATE_HZ) as usize;
    let end = last.min(samples.len());
    for (n, sample) in (first..end).zip(&mut samples[first.min(end)..end]) {
        let t = n as f64 / RATE_HZ - strike.at_s;
        let [re, im] = if t < strike.contact_time_s { integral(t) } else { whole };
        let (sine, cosine) = (angular * t).sin_cos();
        let motion = [re * cosine - im * sine, re * sine + im * cosine];
        let [sine_gain, cosine_gain] = gain;
        *sample += strike.peak_force * (-decay * t).exp() * (sine_gain * motion[1] + cosine_gain * motion[0]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_under_a_half_sine_is_the_convolution_with_it() {
        let mode =
            TrueMode { frequency_hz: 1_700.0, decay_per_s: 40.0, gain: [0.8, -0.3], shape: [0.3, 0.1], striker: None };
        let strike =
            TrueStrike { at_s: 10.3 / RATE_HZ, contact_time_s: 0.7e-3, peak_force: 0.5, position: 0.4, striker: 0 };
        let mut samples = vec![0.0; 200];
        add_response(&mode, &strike, &mut samples);
        for (n, given) in samples.iter().enumerate() {
            let t = n as f64 / RATE_HZ - strike.at_s;
            let steps = 20_000;
            let width = strike.contact_time_s / f64::from(steps);
            let sum: f64 = (0..steps)
                .map(|step| (f64::from(step) + 0.5) * width)
                .take_while(|u| *u < t)
                .map(|u| {
                    let (sine, cosine) = (TAU * mode.frequency_hz * (t - u)).sin_cos();
                    let force = strike.peak_force * (PI * u / strike.contact_time_s).sin();
                    let force = force * (PI * 0.22).cos();
                    force * (-mode.decay_per_s * (t - u)).exp() * (mode.gain[0] * sine + mode.gain[1] * cosine) * width
                })
                .sum();
            assert!((given - sum).abs() < 1e-8, "{n}: {given} {sum}");
        }
    }

    #[test]
    fn strikes_keep_their_least_gap_and_their_range() {
        let sound = plain(4, 6.0, 10, -60.0);
        assert_eq!((sound.strikes.len(), sound.samples.len()), (10, 264_600));
        assert!(sound.strikes.windows(2).all(|pair| pair[1].at_s - pair[0].at_s >= LEAST_GAP_S));
        assert!(sound.modes.windows(2).all(|pair| pair[1].frequency_hz > 1.0149 * pair[0].frequency_hz));
    }
}
