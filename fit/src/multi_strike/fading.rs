//! Fading of a room, measured by its response at the frequencies of the modes.
//!
//! The response is noise that fades, and an estimate of it holds at the modes' frequencies alone.
//! There the power of a window has an exponential distribution with the mean `a e^{-rt} + b_k`.
//! An octave has one power a and one rate r; b_k is the power of the estimate's error at mode k.
//! The rates of a grid are tried one by one. For each the expectation-maximisation algorithm finds
//! the most likely a and b_k. The rates of all octaves are then chosen together, since neighbouring
//! octaves fade alike.

use crate::modes::{Pole, project};
use crate::room::{Room, RoomBand, T60_S, octave_of, of_bands};

/// Length in seconds of the windows in which a response's power is computed.
const WINDOW_S: f64 = 0.03;
/// Number of first windows that do not count: gains and poles of the modes take up most of the
/// room's sound there.
const LEFT_OUT: usize = 2;
/// Number of T60s that are tried.
const TRIED: usize = 128;
/// Number of rounds of expectation and maximisation.
const ROUNDS: usize = 60;
/// Least logarithm of the likelihood ratio by which a fading response explains an octave better
/// than one of constant power.
const EVIDENCE: f64 = 20.0;
/// Standard deviation of the logarithm of the ratio of two T60s an octave apart.
const ALIKE: f64 = 0.25;
/// Least level in dB, over the direct sound, that no room has: fits to few windows can give it.
const LOUDEST_DB: f64 = 0.0;
/// Level in dB below that of the octave with most evidence from which an octave has errors alone.
const FAINTER_DB: f64 = 15.0;
/// Least power of an error, relative to the direct sound.
const LEAST_ERROR: f64 = 1e-14;

/// Measures a room by an estimate of its response. `modes` are those of the dry sound in order of
/// frequency.
///
/// The estimate took the response for noise that fades with `assumed_t60_s`, so that its errors
/// fade so, too. `None` if no octave fades as a room does. Measured in the sets *room* by
/// `cargo bench -p fit --bench strikes`.
pub(super) fn measured(response: &[f64], modes: &[Pole], rate_hz: f64, assumed_t60_s: f64) -> Option<Room> {
    let window = (WINDOW_S * rate_hz) as usize;
    let assumed = fall(assumed_t60_s);
    let mut octaves: Vec<([f64; 2], Vec<Vec<f64>>)> = Vec::new();
    for pole in modes {
        let edges_hz = octave_of(pole.frequency_hz(rate_hz));
        if octaves.last().is_none_or(|last| last.0 != edges_hz) {
            octaves.push((edges_hz, Vec::new()));
        }
        let lasting = Pole { decay: 0.0, ..*pole };
        let windows = response.chunks_exact(window).enumerate().skip(LEFT_OUT);
        let powers = windows.map(|(at, samples)| project(lasting, samples)[0].norm_sqr() * (assumed * at as f64).exp());
        if let Some(last) = octaves.last_mut() {
            last.1.push(powers.collect());
        }
    }
    let octaves = octaves.into_iter().filter_map(|(edges_hz, powers)| Octave::of(edges_hz, &powers, assumed));
    let mut octaves: Vec<Octave> = octaves.filter(|octave| octave.evidence > EVIDENCE).collect();
    let clearest = octaves.iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))?.alone().gain_db;
    octaves.retain(|octave| {
        let gain_db = octave.alone().gain_db;
        gain_db < LOUDEST_DB && gain_db > clearest - FAINTER_DB
    });
    of_bands(octaves.iter().zip(alike(&octaves)).map(|(octave, place)| octave.band(place)).collect())
}

/// T60 in seconds of a place of the grid.
fn t60_s(place: usize) -> f64 {
    T60_S.0 * (T60_S.1 / T60_S.0).powf(place as f64 / (TRIED - 1) as f64)
}

/// Fall of the logarithm of the power in a window.
fn fall(t60_s: f64) -> f64 {
    // The power falls by 60 dB in the T60.
    6.0 * 10f64.ln() / t60_s * WINDOW_S
}

/// An octave in which modes ring, with a response for each T60 of the grid.
struct Octave {
    edges_hz: [f64; 2],
    tried: Vec<Fading>,
    /// Logarithm of the likelihood ratio of the best of them to a response of constant power.
    evidence: f64,
}

impl Octave {
    /// Octave with powers of each mode, raised as the errors fade. `None` without windows.
    fn of(edges_hz: [f64; 2], powers: &[Vec<f64>], assumed: f64) -> Option<Self> {
        let count = powers.iter().map(Vec::len).min().filter(|count| *count > 0)?;
        let tried: Vec<Fading> =
            (0..TRIED).map(|place| Fading::of(powers, count, fall(t60_s(place)) - assumed)).collect();
        let constant = |powers: &Vec<f64>| {
            let mean = (powers.iter().sum::<f64>() / powers.len() as f64).max(LEAST_ERROR);
            powers.len() as f64 * (mean.ln() + 1.0)
        };
        let least = tried.iter().map(|fading| fading.misfit).fold(f64::INFINITY, f64::min);
        Some(Self { edges_hz, evidence: powers.iter().map(constant).sum::<f64>() - least, tried })
    }

    /// The most likely band by this octave alone.
    fn alone(&self) -> RoomBand {
        let misfit = |place: &usize| self.tried[*place].misfit;
        self.band((0..TRIED).min_by(|a, b| misfit(a).total_cmp(&misfit(b))).unwrap_or(0))
    }

    fn band(&self, place: usize) -> RoomBand {
        let energy = self.tried[place].power / (1.0 - (-fall(t60_s(place))).exp());
        RoomBand { edges_hz: self.edges_hz, gain_db: 10.0 * energy.log10(), t60_s: t60_s(place) }
    }
}

/// The most likely places of all octaves' T60s on the grid, if neighbours fade alike.
fn alike(octaves: &[Octave]) -> Vec<usize> {
    let Some((first, others)) = octaves.split_first() else { return Vec::new() };
    let step = (T60_S.1 / T60_S.0).ln() / (TRIED - 1) as f64;
    let mut misfits: Vec<f64> = first.tried.iter().map(|fading| fading.misfit).collect();
    // For each octave but the first: the best place of the octave below for each place.
    let mut below: Vec<Vec<usize>> = Vec::new();
    let mut last = first;
    for octave in others {
        let apart = (octave.edges_hz[0] / last.edges_hz[0]).log2();
        let cost =
            |from: usize, to: usize| misfits[from] + 0.5 * (step * (to as f64 - from as f64) / ALIKE).powi(2) / apart;
        let best: Vec<usize> = (0..TRIED)
            .map(|to| (0..TRIED).min_by(|a, b| cost(*a, to).total_cmp(&cost(*b, to))).unwrap_or(to))
            .collect();
        misfits = (0..TRIED).map(|to| cost(best[to], to) + octave.tried[to].misfit).collect();
        below.push(best);
        last = octave;
    }
    let mut places = vec![(0..TRIED).min_by(|a, b| misfits[*a].total_cmp(&misfits[*b])).unwrap_or(0)];
    for best in below.iter().rev() {
        places.extend(places.last().map(|place| best[*place]));
    }
    places.reverse();
    places
}

/// The most likely power of a fading response.
struct Fading {
    /// Power of the first window of the response, before those that are left out.
    power: f64,
    /// Negative logarithm of the likelihood.
    misfit: f64,
}

impl Fading {
    /// Response that falls by `fall` in each of `count` windows.
    fn of(powers: &[Vec<f64>], count: usize, fall: f64) -> Self {
        let shape: Vec<f64> = (0..count).map(|at| (-fall * (LEFT_OUT + at) as f64).exp()).collect();
        let quarter = |powers: &Vec<f64>| {
            let mut sorted = powers.clone();
            sorted.sort_by(f64::total_cmp);
            sorted[sorted.len() / 4].max(LEAST_ERROR)
        };
        let mut errors: Vec<f64> = powers.iter().map(quarter).collect();
        let mut power = powers.iter().map(|powers| powers[0] / shape[0]).sum::<f64>() / powers.len() as f64;
        for _ in 0..ROUNDS {
            let mut sum = 0.0;
            for (powers, error) in powers.iter().zip(&mut errors) {
                let mut sum_of_errors = 0.0;
                for (seen, shape) in powers.iter().zip(&shape) {
                    let (room, total) = (power * shape, power * shape + *error);
                    // Expected powers of the two parts, by their shares of the mean.
                    let [room_share, error_share] = [room / total, *error / total];
                    sum += (room_share * room_share * seen + room * error_share) / shape;
                    sum_of_errors += error_share * error_share * seen + *error * room_share;
                }
                *error = (sum_of_errors / powers.len() as f64).max(LEAST_ERROR);
            }
            power = sum / (count * powers.len()) as f64;
        }
        let of_mode = |(powers, error): (&Vec<f64>, &f64)| {
            let of_window = |(seen, shape): (&f64, &f64)| {
                let mean = power * shape + error;
                mean.ln() + seen / mean
            };
            powers.iter().zip(&shape).map(of_window).sum::<f64>()
        };
        Self { power, misfit: powers.iter().zip(&errors).map(of_mode).sum() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    const RATE_HZ: f64 = 16_000.0;

    /// Modes in two octaves.
    fn modes() -> Vec<Pole> {
        [400.0, 440.0, 500.0, 560.0, 850.0, 1_000.0, 1_200.0].map(|hz| Pole::new(hz, 2.0, RATE_HZ)).to_vec()
    }

    /// Noise that fades with a T60 and has an energy in dB, and a constant noise of a level in dB.
    fn response(seed: u64, t60_s: f64, gain_db: f64, error_db: f64) -> Vec<f64> {
        let mut random = SplitMix64(seed);
        let fall = 1000f64.ln() / (t60_s * RATE_HZ);
        let energy = 10f64.powf(gain_db / 10.0);
        let start = (energy * 2.0 * fall).sqrt();
        let error = 10f64.powf(error_db / 20.0);
        let faded = |n: i32| start * (-fall * f64::from(n)).exp();
        (0..16_000).map(|n| faded(n) * random.normal() + error * random.normal()).collect()
    }

    #[test]
    fn fading_and_level_of_a_response_with_errors_are_told() {
        for (seed, t60_s) in [(1, 0.3), (2, 0.6), (3, 1.2)] {
            let room = measured(&response(seed, t60_s, -10.0, -75.0), &modes(), RATE_HZ, 1e6).expect("a room");
            assert_eq!(room.bands.len(), 2, "{room:?}");
            assert!((room.t60_s / t60_s - 1.0).abs() < 0.12, "{room:?} {t60_s}");
            assert!((room.gain_db + 10.0).abs() < 2.0, "{room:?}");
        }
    }

    #[test]
    fn errors_that_fade_as_was_assumed_are_no_room() {
        assert!(measured(&response(4, 0.6, -400.0, -60.0), &modes(), RATE_HZ, 1e6).is_none());
        assert!(measured(&response(5, 0.9, -30.0, -400.0), &modes(), RATE_HZ, 0.9).is_none());
        assert!(
            measured(&[], &modes(), RATE_HZ, 1.0).is_none() && measured(&[0.0; 16_000], &[], RATE_HZ, 1.0).is_none()
        );
    }
}
