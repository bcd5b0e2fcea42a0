//! Response of the room between the thing and the microphone, from what its dry sound leaves.
//!
//! The recording is `y = x + h * x + noise`: x is the sound of the model, h the room's response
//! without the direct sound (diffimpact eq. 1). The response is taken for noise that fades,
//! `h[n] ~ N(0, v[n])`, `v[n] = v0 e^{-2rn}`. The most likely one minimises
//!
//! ```text
//! |w * (y - x - h * x)|² / σ² + Σ h[n]² / v[n],
//! ```
//!
//! w the filter that makes the noise white and σ² its power: with R the Toeplitz matrix of the
//! correlation of w * x and c its correlation with w * (y - x), `(R + σ²/v) h = c`. Conjugate
//! gradients solve it in the unit `h[n] / √v[n]`; products with R are transforms of the response's
//! length.

use super::whitening::Whitening;
use crate::convolution::Convolution;
use crate::decay;
use crate::modes::{Pole, project};
use crate::room::{Room, RoomBand, T60_S, octave_of, of_bands};

/// Longest response in shares of the assumed T60: there it has faded by 84 dB.
const LENGTH_T60: f64 = 1.4;
/// Maximum number of steps.
const STEPS: usize = 80;
/// Size of the gradient, as a share of the first one, at which the steps end.
const ENDING: f64 = 1e-4;
/// Share of the recording's frames that are quieter than the noise that is assumed.
const NOISE_SHARE: f64 = 0.1;
/// Length of a frame of the noise in samples.
const NOISE_FRAME: usize = 1024;
/// T60 in seconds that is assumed of a room of which nothing is known.
pub(crate) const UNKNOWN_T60_S: f64 = 0.5;
/// T60 in seconds that is assumed where the T60 is to be measured: the response may fade as it
/// likes within [`LONGEST_S`].
pub(crate) const FLAT_T60_S: f64 = 5.0;
/// Energy that is assumed of a response; that of the direct sound is 1.
const LEVEL: f64 = 0.1;
/// Longest response in seconds.
const LONGEST_S: f64 = 1.0;

/// Standard deviations `√v[n]` that are assumed of a response at a rate in Hz.
fn spreads(t60_s: f64, rate_hz: f64) -> Vec<f64> {
    let fall = 1000f64.ln() / (t60_s * rate_hz);
    let count = ((LENGTH_T60 * t60_s).min(LONGEST_S) * rate_hz) as usize;
    let mut spreads: Vec<f64> = (0..count.max(2)).map(|n| (-fall * n as f64).exp()).collect();
    // Sample 0 is the direct sound.
    spreads[0] = 0.0;
    let energy: f64 = spreads.iter().map(|x| x * x).sum();
    let scale = (LEVEL / energy).sqrt();
    spreads.iter_mut().for_each(|x| *x *= scale);
    spreads
}

/// Most likely response of the room to a dry sound, if `left` is the rest of the recording and a
/// T60 in seconds is assumed.
pub(crate) fn response([dry, left]: [&[f64]; 2], whitening: &Whitening, t60_s: f64, rate_hz: f64) -> Vec<f64> {
    let [dry, left] = [dry, left].map(|sound| whitening.filtered(sound, 0..sound.len()));
    let spreads = spreads(t60_s, rate_hz);
    let count = spreads.len();
    let whole = Convolution::new(dry.len() + count);
    let (dry_spectrum, left_spectrum) = (whole.spectrum(&dry), whole.spectrum(&left));
    let correlation = whole.correlated(&dry_spectrum, &dry_spectrum, count);
    let right = whole.correlated(&left_spectrum, &dry_spectrum, count);
    let short = Convolution::new(2 * count);
    let mut both_ways = vec![0.0; short.size()];
    for (lag, value) in correlation.iter().enumerate() {
        both_ways[lag] = *value;
        both_ways[(short.size() - lag) % short.size()] = *value;
    }
    let correlation = short.spectrum(&both_ways);
    let noise = noise_power(&left);
    let product = |g: &[f64]| -> Vec<f64> {
        let scaled: Vec<f64> = g.iter().zip(&spreads).map(|(g, spread)| g * spread).collect();
        let sums = short.convolved(&short.spectrum(&scaled), &correlation, count);
        g.iter().zip(&sums).zip(&spreads).map(|((g, sum), spread)| noise * g + spread * sum).collect()
    };
    let right: Vec<f64> = right.iter().zip(&spreads).map(|(c, spread)| c * spread).collect();
    solved(product, right).iter().zip(&spreads).map(|(g, spread)| g * spread).collect()
}

/// Sound of a room with a response to a dry sound.
pub(crate) fn reflected(dry: &[f64], response: &[f64]) -> Vec<f64> {
    let both = Convolution::new(dry.len() + response.len());
    both.convolved(&both.spectrum(dry), &both.spectrum(response), dry.len())
}

/// Measures a room by its response, as it was estimated with [`FLAT_T60_S`]. `modes` are those of
/// the dry sound, each with its energy.
///
/// In windows of [`WINDOW_S`] the response's power at the modes' frequencies falls by `e^{-2rt}`,
/// and its sum is the response's energy. `None` if no octave fades as a room does. Measured in the
/// sets *room* by `cargo bench -p fit --bench strikes`.
pub(crate) fn measured(response: &[f64], modes: &[(Pole, f64)], rate_hz: f64) -> Option<Room> {
    let window = (WINDOW_S * rate_hz) as usize;
    let mut octaves: Vec<Octave> = Vec::new();
    for (pole, energy) in modes {
        let edges_hz = octave_of(pole.frequency_hz(rate_hz));
        if octaves.last().is_none_or(|last| last.edges_hz != edges_hz) {
            octaves.push(Octave { edges_hz, energy: 0.0, powers: vec![0.0; response.len() / window] });
        }
        let Some(octave) = octaves.last_mut() else { continue };
        octave.energy += energy;
        let lasting = Pole { decay: 0.0, ..*pole };
        for (power, samples) in octave.powers.iter_mut().zip(response.chunks_exact(window)) {
            *power += energy * project(lasting, samples)[0].norm_sqr();
        }
    }
    let bands = octaves.into_iter().filter_map(|Octave { edges_hz, energy, powers }| {
        let powers: Vec<f64> = powers.iter().map(|power| power / energy).collect();
        let blocks = decay::blocks(&powers, 1.0 / WINDOW_S, FROM_S, f64::INFINITY);
        let band = |parts: usize| {
            let (first, rate) = *decay::fit(&blocks, parts)?.parts.first()?;
            // The power decays at twice the amplitude's rate: 60 dB are 6 ln 10.
            let t60_s = 6.0 * 10f64.ln() / rate;
            let gain_db = 10.0 * (first / (rate * WINDOW_S)).log10();
            let is_room = (T60_S.0..=T60_S.1).contains(&t60_s) && gain_db < LOUDEST_DB;
            is_room.then_some(RoomBand { edges_hz, gain_db, t60_s })
        };
        // Errors of the modes' decays add a second part, which fades slower than the room.
        band(2).or_else(|| band(1))
    });
    of_bands(bands.collect())
}

/// An octave in which modes ring.
struct Octave {
    edges_hz: [f64; 2],
    /// Energy of its modes.
    energy: f64,
    /// Powers of the response in windows at the modes' frequencies, times the modes' energies.
    powers: Vec<f64>,
}

/// Least level in dB, over the direct sound, that no room has: fits to few windows can give it.
const LOUDEST_DB: f64 = 0.0;
/// Length in seconds of the windows in which a response's power is computed.
const WINDOW_S: f64 = 0.03;
/// Time in seconds from which the response's power counts. Earlier, gains and poles of the modes
/// take up most of the room's sound.
const FROM_S: f64 = 0.06;

/// Power of the noise: that of the quieter frames.
fn noise_power(left: &[f64]) -> f64 {
    let power = |frame: &[f64]| frame.iter().map(|x| x * x).sum::<f64>() / frame.len() as f64;
    let mut powers: Vec<f64> = left.chunks(NOISE_FRAME).map(power).collect();
    powers.sort_by(f64::total_cmp);
    powers.get((NOISE_SHARE * powers.len() as f64) as usize).map_or(LEAST_NOISE, |power| power.max(LEAST_NOISE))
}

/// Least power of the noise: that of 24 bits.
const LEAST_NOISE: f64 = 1e-15;

/// Solution of equations with a positive definite matrix, given as products, by conjugate
/// gradients.
fn solved(product: impl Fn(&[f64]) -> Vec<f64>, right: Vec<f64>) -> Vec<f64> {
    let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
    let mut found = vec![0.0; right.len()];
    let (mut left, mut along) = (right.clone(), right);
    let mut size = square(&left);
    let least = ENDING * ENDING * size;
    for _ in 0..STEPS {
        if size <= least {
            break;
        }
        let turned = product(&along);
        let far = size / along.iter().zip(&turned).map(|(a, b)| a * b).sum::<f64>();
        found.iter_mut().zip(&along).for_each(|(x, a)| *x += far * a);
        left.iter_mut().zip(&turned).for_each(|(x, b)| *x -= far * b);
        let next = square(&left);
        along.iter_mut().zip(&left).for_each(|(a, x)| *a = x + next / size * *a);
        size = next;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn response_of_a_room_is_told_by_noise_through_it() {
        let mut random = SplitMix64(7);
        let rate_hz = 8_000.0;
        let t60_s = 0.2;
        let truth: Vec<f64> = spreads(t60_s, rate_hz).iter().map(|spread| spread * random.normal()).collect();
        // Silence behind the sound tells the noise.
        let mut dry: Vec<f64> = (0..40_000).map(|_| random.normal()).collect();
        dry.resize(60_000, 0.0);
        let left: Vec<f64> = reflected(&dry, &truth).iter().map(|x| x + 1e-3 * random.normal()).collect();
        let found = response([&dry, &left], &Whitening::none(), t60_s, rate_hz);
        let error: f64 = found.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
        let energy: f64 = truth.iter().map(|x| x * x).sum();
        assert!(error < 1e-3 * energy, "{:.1} dB", 10.0 * (error / energy).log10());
    }
}
