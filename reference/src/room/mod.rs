//! Room reverberation, `y + y ⊗ IR_e` (diffimpact eq. 19): noise that decays, band by band.
//!
//! A band reaches from its `from_hz` to that of the next one. In it, a unit impulse on one side
//! makes Gaussian noise on each side, of power `g²/2 · e^{-2 d t}` and cut out of the spectrum
//! exactly. The noises of the four paths (left and right to left and right) are independent. So
//! both sides are uncorrelated, and for every constant-power pan they get equal energy,
//! `(L² + R²)/2` of the input.
//!
//! The reverberation begins with the sound. The instrument's begins 9 to 28 ms later
//! (docs/room.md).
//!
//! Each seed makes another room of one table, and the instrument's network is one more.
//! Reference and network are compared by their statistics: energy, T60, balance and correlation.
//! The network's arithmetic, sample by sample, is checked by [`network_twin()`].

mod band;
mod network_twin;
mod transform;

pub use band::RoomBand;
pub use network_twin::network_twin;

use crate::rate::SampleRate;
use transform::{Complex, forward, inverse};

/// Decay in nepers after which a band's noise is left out: 100 dB.
const LAST_NEPERS: f64 = 11.512_925_464_970_229;

/// Reverberation of a stereo sound (left, right), without the sound itself.
///
/// `seed` chooses among the rooms with this table. Bands are trusted to rise from 0, with decays
/// above 0.
pub fn room(bands: &[RoomBand], dry: [&[f64]; 2], rate: SampleRate, seed: u64) -> [Vec<f64>; 2] {
    let frames = dry[0].len();
    let longest_s = bands.iter().map(|band| LAST_NEPERS / band.decay_per_s).fold(0.0, f64::max);
    let taps = ((longest_s * rate.hz()).ceil() as usize).clamp(1, frames.max(1));
    // Overlap and add: a step is so short that its response fits without wrapping round.
    let length = (2 * taps).next_power_of_two();
    let responses = [0, 1].map(|to| [0, 1].map(|from| response(bands, rate, taps, length, [seed, to, from])));
    let mut wet = [vec![0.0; frames], vec![0.0; frames]];
    let step = length - taps;
    for start in (0..frames).step_by(step) {
        let end = (start + step).min(frames);
        let parts = dry.map(|side| spectrum(&side[start..end], length));
        for (wet, [from_left, from_right]) in wet.iter_mut().zip(&responses) {
            let product = |bin: usize| parts[0][bin] * from_left[bin] + parts[1][bin] * from_right[bin];
            let mut sum: Vec<Complex> = (0..length).map(product).collect();
            inverse(&mut sum);
            wet[start..].iter_mut().zip(&sum).for_each(|(wet, value)| *wet += value.re);
        }
    }
    wet
}

/// Spectrum of the impulse response of one path, `taps` long.
fn response(bands: &[RoomBand], rate: SampleRate, taps: usize, length: usize, way: [u64; 3]) -> Vec<Complex> {
    let hz = rate.hz();
    let mut sum = vec![Complex::ZERO; length];
    for (index, band) in bands.iter().enumerate() {
        let to_hz = bands.get(index + 1).map_or(f64::MAX, |next| next.from_hz);
        let rms = band.gain / (2.0 * hz).sqrt();
        let mut normal = normal(way, index as u64);
        let noise: Vec<f64> =
            (0..taps).map(|tap| rms * (-band.decay_per_s * tap as f64 / hz).exp() * normal()).collect();
        for (bin, value) in spectrum(&noise, length).into_iter().enumerate() {
            let bin_hz = bin.min(length - bin) as f64 * hz / length as f64;
            if (band.from_hz..to_hz).contains(&bin_hz) {
                sum[bin] = sum[bin] + value;
            }
        }
    }
    // The band cuts smear noise to before the beginning and behind the end; it is removed.
    inverse(&mut sum);
    let taps: Vec<f64> = sum.iter().take(taps).map(|value| value.re).collect();
    spectrum(&taps, length)
}

fn spectrum(signal: &[f64], length: usize) -> Vec<Complex> {
    let mut values: Vec<Complex> = signal.iter().map(|&re| Complex { re, im: 0.0 }).collect();
    values.resize(length, Complex::ZERO);
    forward(&mut values);
    values
}

/// Gaussian noise of rms 1 (SplitMix64, Box and Muller), independent for each path and band.
fn normal(way: [u64; 3], band: u64) -> impl FnMut() -> f64 {
    let mix = |state: u64| {
        let x = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    };
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15;
    let [seed, to, from] = way;
    let mut state = [to, from, band].iter().fold(seed, |state, part| mix(state.wrapping_add(STEP) ^ (part + 1)));
    move || {
        let mut uniform = || {
            state = state.wrapping_add(STEP);
            ((mix(state) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
        };
        let (radius, turn) = (uniform(), uniform());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
    }
}
