//! Loudness error: specific loudness in gammatone bands, and the share of it that is in the wrong
//! place.

use super::gammatone::{self, HOP_S, centres_hz, power, threshold_db};

/// Level in dB SPL at which the loudest band and frame of the first second is heard.
const LOUDEST_DB: f64 = 85.0;
/// Time constant of a rise in seconds.
const ATTACK_S: f64 = 0.003;
/// Shortest time constant of a fall in seconds; low bands fall more slowly.
const RELEASE_S: f64 = 0.008;
/// Additional time constant of a fall at 100 Hz, inversely proportional to frequency.
const LOW_RELEASE_S: f64 = 0.022;
/// Least excitation over the background that counts, as a power ratio.
const OVER_BACKGROUND: f64 = 4.0;
/// Share of a sine's power in a band below which the band does not hear it.
const LEAST_RESPONSE: f64 = 1e-3;
/// Length of the early part in seconds.
const EARLY_S: f64 = 0.25;

/// Specific loudness of an excitation over the threshold of hearing.
///
/// It is `(1 + E)^0.23 - 1.17`, and 0 within about 3 dB of the threshold.
pub fn specific_loudness(excitation: f64) -> f64 {
    ((1.0 + excitation).powf(0.23) - 1.17).max(0.0)
}

/// Excitation of a strike in 60 bands every 2 ms, and of its background.
#[derive(Clone, Debug)]
pub struct Loudness {
    rate_hz: f64,
    length: usize,
    centres_hz: Vec<f64>,
    /// Power that is heard at the threshold, by band.
    threshold: Vec<f64>,
    excitation: Vec<Vec<f64>>,
    background: Vec<f64>,
}

/// Loudness in the wrong place, as a share of the recording's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoudnessError {
    /// Error over the whole strike.
    pub whole: f64,
    /// Error over the first 0.25 s.
    pub early: f64,
}

impl Loudness {
    /// Loudness of a strike; `before` are the samples that precede it.
    pub fn new(strike: &[f64], before: &[f64], rate_hz: f64) -> Self {
        let centres_hz = centres_hz(rate_hz);
        let first = power(strike, rate_hz, &centres_hz);
        // The loudest band of the first second alone: a longer sound gives the same powers there.
        let frames = (rate_hz as usize).checked_div((HOP_S * rate_hz) as usize).unwrap_or(0);
        let loudest = first.iter().flat_map(|band| band.iter().take(frames)).copied().fold(f64::MIN_POSITIVE, f64::max);
        let threshold: Vec<f64> =
            centres_hz.iter().map(|&hz| loudest * 10f64.powf((threshold_db(hz) - LOUDEST_DB) / 10.0)).collect();
        let mut this = Self {
            rate_hz,
            length: strike.len(),
            background: vec![0.0; centres_hz.len()],
            threshold,
            centres_hz,
            excitation: Vec::new(),
        };
        this.excitation = this.smeared(first);
        this.background = this.background_of(before);
        this
    }

    /// Number of samples of the strike that are compared.
    pub fn length(&self) -> usize {
        self.length
    }

    /// Excitation that precedes the strike; if little does, that which remains at its end.
    fn background_of(&self, before: &[f64]) -> Vec<f64> {
        let samples = |seconds: f64| (seconds * self.rate_hz) as usize;
        let from = before.len().saturating_sub(samples(0.2));
        let to = before.len().saturating_sub(samples(0.004)).max(from);
        let quiet = &before[from..to];
        if quiet.len() > samples(0.04) {
            let bands = self.excitation_of(quiet);
            return bands.iter().map(|band| median(band.get(10..).unwrap_or(&[]))).collect();
        }
        let frames = self.excitation.first().map_or(0, Vec::len);
        let end = frames - (0.08 * frames as f64) as usize;
        let tail = |band: &Vec<f64>| band.get(end..).unwrap_or(&[]).to_vec();
        let tails: Vec<Vec<f64>> = self.excitation.iter().map(tail).collect();
        let count = tails.iter().map(Vec::len).sum::<usize>().max(1) as f64;
        let mean = tails.iter().flatten().sum::<f64>() / count;
        let peaks = self.excitation.iter().map(|band| band.iter().copied().fold(0.0, f64::max));
        let peak = peaks.sum::<f64>() / self.excitation.len().max(1) as f64;
        if mean < 1e-4 * peak { tails.iter().map(|tail| median(tail)).collect() } else { vec![0.0; tails.len()] }
    }

    /// Excitation of a sound over the threshold of hearing, by band and frame.
    pub fn excitation_of(&self, samples: &[f64]) -> Vec<Vec<f64>> {
        self.smeared(power(samples, self.rate_hz, &self.centres_hz))
    }

    /// Powers over the threshold, smeared in time as an ear does.
    fn smeared(&self, powers: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let attack = (-HOP_S / ATTACK_S).exp();
        let bands = powers.into_iter().zip(&self.threshold).zip(&self.centres_hz);
        bands
            .map(|((mut band, threshold), hz)| {
                let release = (-HOP_S / (RELEASE_S + LOW_RELEASE_S * 100.0 / hz.max(100.0))).exp();
                let mut state = 0.0;
                for power in &mut band {
                    let now = *power / threshold;
                    let keep = if now > state { attack } else { release };
                    state = keep * state + (1.0 - keep) * now;
                    *power = state;
                }
                band
            })
            .collect()
    }

    /// Excitation of the strike, by band and frame of 2 ms.
    pub(crate) fn excitation(&self) -> &[Vec<f64>] {
        &self.excitation
    }

    /// Excitation that precedes the strike, by band.
    pub(crate) fn background(&self) -> &[f64] {
        &self.background
    }

    /// Excitation of a sine of amplitude 1, for each band in which it has more than a thousandth.
    pub(crate) fn of_sine(&self, hz: f64) -> Vec<(usize, f64)> {
        let bands = self.centres_hz.iter().zip(&self.threshold).enumerate();
        bands
            .map(|(band, (&centre, threshold))| (band, gammatone::response(hz, centre), threshold))
            .filter(|(_, response, _)| *response > LEAST_RESPONSE)
            .map(|(band, response, threshold)| (band, response / threshold))
            .collect()
    }

    /// Loudness error of a rendering that begins with the strike.
    pub fn error(&self, rendering: &[f64]) -> LoudnessError {
        let (map, totals) = self.compared(rendering);
        let early = (EARLY_S / HOP_S) as usize;
        let share = |frames: usize| {
            let wrong: f64 = map.iter().flat_map(|band| band.iter().take(frames)).map(|error| error.abs()).sum();
            wrong / totals.iter().take(frames).sum::<f64>().max(f64::MIN_POSITIVE)
        };
        LoudnessError { whole: share(usize::MAX), early: share(early) }
    }

    /// Loudness that a rendering has too much (above 0) or too little, by band and frame, and the
    /// recording's loudness of each frame.
    pub fn compared(&self, rendering: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let given = self.excitation_of(rendering);
        let frames = given.first().map_or(0, Vec::len).min(self.excitation.first().map_or(0, Vec::len));
        let mut totals = vec![0.0; frames];
        let bands = self.excitation.iter().zip(&given).zip(&self.background);
        let map = bands.map(|((wanted, given), &background)| {
            let frames = wanted.iter().zip(given).zip(&mut totals).map(|((&wanted, &given), total)| {
                let limit = OVER_BACKGROUND * background;
                if wanted <= limit && given <= limit {
                    return 0.0;
                }
                let loudness = specific_loudness((wanted - background).max(0.0));
                *total += loudness;
                specific_loudness(given) - loudness
            });
            frames.collect()
        });
        (map.collect(), totals)
    }
}

/// Median of values; 0 without values.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match (sorted.get(middle), sorted.len() % 2) {
        (Some(value), 1) => *value,
        (Some(value), _) => 0.5 * (value + sorted.get(middle.wrapping_sub(1)).unwrap_or(value)),
        (None, _) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn burst(seed: u64, gain: f64) -> Vec<f64> {
        let mut random = SplitMix64(seed);
        (0..22_050).map(|n| gain * random.normal() * (-f64::from(n) / 4_000.0).exp()).collect()
    }

    #[test]
    fn equal_sounds_have_no_loudness_error_and_silence_has_all() {
        let sound = burst(1, 0.1);
        let loudness = Loudness::new(&sound, &[], 44_100.0);
        // The background is subtracted from the recording alone.
        assert!(loudness.error(&sound).whole < 0.01);
        let silence = loudness.error(&vec![0.0; sound.len()]);
        assert!((silence.whole - 1.0).abs() < 1e-9, "{silence:?}");
    }

    #[test]
    fn two_draws_of_one_noise_have_a_loudness_error_of_about_a_tenth() {
        let loudness = Loudness::new(&burst(1, 0.1), &[], 44_100.0);
        let error = loudness.error(&burst(2, 0.1));
        assert!((0.06..0.15).contains(&error.whole), "{error:?}");
        let softer = loudness.error(&burst(2, 0.05));
        assert!(softer.whole > error.whole + 0.05, "{softer:?}");
    }
}
