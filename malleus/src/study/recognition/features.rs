//! Loudness and brightness of a sound over pieces of time.

use fourier::Complex;

use crate::study::scene::RATE;

/// Number of pieces into which a sound is cut.
pub const PIECES: usize = 32;
/// Number of values: a loudness and a brightness for each piece.
pub const FEATURES: usize = 2 * PIECES;

/// Window in which the sound's begin and end are looked for, in frames.
const WINDOW: usize = 480;
/// Level of the first and the last window that count, below the loudest one, as a ratio of powers.
const AUDIBLE: f64 = 1e-4;
/// Lowest frequency that counts for the brightness.
const LOWEST_HZ: f64 = 100.0;

/// Loudness in dB and brightness in octaves of each piece, less their means over all pieces.
///
/// Silence around the sound is cut off, and the rest cut into equal pieces, so that a sound's
/// length, level and place in time do not matter. Brightness is the mean of log2 of the frequency,
/// weighted by power.
pub fn features(sound: &[f64]) -> [f64; FEATURES] {
    let sound = audible(sound);
    let mut values = [0.0; FEATURES];
    for piece in 0..PIECES {
        let [from, to] = [piece, piece + 1].map(|edge| edge * sound.len() / PIECES);
        [values[piece], values[PIECES + piece]] = heard(&sound[from..to]);
    }
    for half in values.chunks_mut(PIECES) {
        let mean = half.iter().sum::<f64>() / PIECES as f64;
        half.iter_mut().for_each(|value| *value -= mean);
    }
    values
}

/// Part of a sound from the first to the last window that is not much softer than the loudest.
fn audible(sound: &[f64]) -> &[f64] {
    let power: Vec<f64> = sound.chunks(WINDOW).map(|window| window.iter().map(|x| x * x).sum()).collect();
    let least = AUDIBLE * power.iter().copied().fold(0.0, f64::max);
    let first = power.iter().position(|&power| power > least).unwrap_or(0);
    let last = power.iter().rposition(|&power| power > least).unwrap_or(0);
    &sound[(first * WINDOW).min(sound.len())..((last + 1) * WINDOW).min(sound.len())]
}

/// Loudness in dB and brightness in octaves above 1 Hz of a piece.
fn heard(piece: &[f64]) -> [f64; 2] {
    // Lengths of small prime factors are transformed fast.
    let length = piece.len().next_multiple_of(64).max(64);
    let turn = std::f64::consts::TAU / length as f64;
    let mut windowed = vec![0.0; length];
    for (n, (out, x)) in windowed.iter_mut().zip(piece).enumerate() {
        *out = x * (0.5 - 0.5 * (turn * n as f64).cos());
    }
    let transform = fourier::forward(length);
    let mut bins = transform.make_output_vec();
    if transform.process(&mut windowed, &mut bins).is_err() {
        return [0.0; 2];
    }
    let bin_hz = RATE.hz() / length as f64;
    let power = bins.iter().map(Complex::norm_sqr).enumerate();
    let (mut sum, mut weighted) = (1e-20, 0.0);
    for (bin, power) in power.skip((LOWEST_HZ / bin_hz).ceil() as usize) {
        sum += power;
        weighted += power * (bin as f64 * bin_hz).log2();
    }
    [10.0 * (sum / length as f64).log10(), weighted / sum]
}
