//! Estimation of a recording's room: a tail of noise that decays more slowly than the struck
//! object.
//!
//! The room's response is `δ + IR_e`, with noise IR_e that decays in each band at a rate d_e
//! (diffimpact eq. 1, §3.4). To a sound whose power in a band falls as `A e^{-2dt}` the room adds a
//! tail that falls as `e^{-2 d_e t}`: two slopes. Two modes of one object make two slopes as well.
//! But a room's tail has many components where an object has a few modes, and it decays alike in
//! neighbouring bands.
//!
//! An object that rings longer than its room hides it. So does a hall that is louder than the
//! direct sound from the start, because there is only one slope then. An object whose modes are as
//! dense as a room's can be taken for a room.

use serde::Serialize;

use crate::bark::{Spectrum, Subband, gaussian};
use crate::decay::{self, Decay};

/// One frequency band of an estimated room.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RoomBand {
    /// Lower and upper edge in Hz, an octave apart.
    pub edges_hz: [f64; 2],
    /// Energy of the room's response in the band, relative to that of the direct sound, in dB.
    pub gain_db: f64,
    /// T60 in seconds.
    pub t60_s: f64,
}

/// An estimated room.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Room {
    /// Bands in which a tail is found: at least three neighbours, in order of frequency.
    pub bands: Vec<RoomBand>,
    /// Energy of the room's response relative to that of the direct sound, in dB: mean of the
    /// bands' energy ratios.
    pub gain_db: f64,
    /// T60 in seconds: geometric mean over the bands.
    pub t60_s: f64,
}

/// Centre frequencies in Hz of the octaves that are analysed.
const OCTAVES_HZ: [f64; 7] = [125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0];
/// Standard deviation of a band's Gaussian response in octaves.
const SPREAD_OCTAVES: f64 = 0.3;
/// Time after the strike that a band's filter smears, in standard deviations of its response in
/// time.
const SETTLED: f64 = 3.0;
/// Shortest and longest T60 of a room in seconds.
pub(crate) const T60_S: (f64, f64) = (0.1, 8.0);
/// Least ratio of the object's decay to the room's.
const FASTER: f64 = 2.0;
/// Least evidence for two slopes over one, as the logarithm of a likelihood ratio.
const EVIDENCE: f64 = 15.0;
/// Ratio of powers by which the tail must exceed the object's sound and the floor to be heard
/// alone: 10 dB.
const ALONE: f64 = 10.0;
/// Least time for which the tail must be heard alone, as a share of its T60.
const HEARD_T60: f64 = 0.2;
/// Least number of components of a tail.
const COMPONENTS: f64 = 5.0;
/// Largest ratio of the T60s of neighbouring bands.
const ALIKE: f64 = 1.8;
/// Least number of neighbouring bands of a room.
const BANDS: usize = 3;

/// Estimates the room of a strike heard alone.
///
/// `strike` has full scale 1 and begins at its onset; `rate_hz` is its rate. `None` for a dry
/// recording, or if the object rings longer than the room.
///
/// On synthetic rooms (`cargo test -p fit --test sounds room:: -- --nocapture`) T60s of bands are
/// found within 7 % (mean 2.4 %), gains within 4.5 dB (mean 1.5 dB).
pub fn estimate(strike: &[f64], rate_hz: f64) -> Option<Room> {
    let spectrum = Spectrum::of(strike, rate_hz)?;
    let length_s = strike.len() as f64 / rate_hz;
    let bands = OCTAVES_HZ.map(|centre_hz| {
        let root_of_two = std::f64::consts::SQRT_2;
        let smear_s = (std::f64::consts::TAU * SPREAD_OCTAVES * std::f64::consts::LN_2 * centre_hz).recip();
        (centre_hz * root_of_two < 0.5 * rate_hz)
            .then(|| spectrum.band(|f| gaussian((f / centre_hz).log2(), 0.0, SPREAD_OCTAVES), centre_hz, smear_s))
            .flatten()
            .and_then(|band| tail(strike, rate_hz, centre_hz, &band, length_s))
            .map(|(gain_db, t60_s)| RoomBand {
                edges_hz: [centre_hz / root_of_two, centre_hz * root_of_two],
                gain_db,
                t60_s,
            })
    });
    // The longest run of neighbours with similar decays is the room.
    let mut runs: Vec<Vec<RoomBand>> = vec![Vec::new()];
    for band in bands {
        let alike = |last: &RoomBand, band: &RoomBand| (last.t60_s / band.t60_s).ln().abs() < ALIKE.ln();
        match (band, runs.last_mut()) {
            (Some(band), Some(run)) if run.last().is_none_or(|last| alike(last, &band)) => run.push(band),
            (Some(band), _) => runs.push(vec![band]),
            (None, _) => runs.push(Vec::new()),
        }
    }
    let bands = runs.into_iter().max_by_key(Vec::len).filter(|run| run.len() >= BANDS)?;
    of_bands(bands)
}

/// Octave of the room that a frequency in Hz lies in, as its edges in Hz.
pub(crate) fn octave_of(frequency_hz: f64) -> [f64; 2] {
    let octave = (frequency_hz / OCTAVES_HZ[0]).log2().round();
    [-0.5, 0.5].map(|edge| OCTAVES_HZ[0] * (octave + edge).exp2())
}

/// Room of octaves; `None` of none.
pub(crate) fn of_bands(bands: Vec<RoomBand>) -> Option<Room> {
    let count = bands.len() as f64;
    let energy = bands.iter().map(|band| 10f64.powf(band.gain_db / 10.0)).sum::<f64>() / count;
    let t60_s = (bands.iter().map(|band| band.t60_s.ln()).sum::<f64>() / count).exp();
    (!bands.is_empty()).then_some(Room { gain_db: 10.0 * energy.log10(), t60_s, bands })
}

/// Gain in dB and T60 in seconds of the room's tail in a band, if there is one.
fn tail(strike: &[f64], rate_hz: f64, centre_hz: f64, band: &Subband, length_s: f64) -> Option<(f64, f64)> {
    let from_s = SETTLED * band.smear_s;
    let blocks = decay::blocks(&band.power, band.rate_hz, from_s, length_s - from_s);
    let (one, two) = (decay::fit(&blocks, 1)?, decay::fit(&blocks, 2)?);
    let [(direct, fast), (late, slow)] = [*two.parts.first()?, *two.parts.get(1)?];
    let heard_s: f64 = blocks.iter().map(|block| block.length_s).sum();
    let evidence = (one.misfit - two.misfit) * heard_s * band.independent_per_s();
    // The power decays at twice the amplitude's rate: 60 dB are 6 ln 10.
    let t60_s = 6.0 * 10f64.ln() / slow;
    if evidence < EVIDENCE || fast < FASTER * slow || !(T60_S.0..=T60_S.1).contains(&t60_s) {
        return None;
    }
    let alone = alone_s(&two, from_s, length_s - from_s);
    if alone.end - alone.start < HEARD_T60 * t60_s {
        return None;
    }
    let samples = strike.get((alone.start * rate_hz) as usize..(alone.end * rate_hz) as usize)?;
    if components(samples, rate_hz, centre_hz, 0.5 * slow) < COMPONENTS {
        return None;
    }
    // The object's power A e^{-2dt} through noise of variance σ² gives R (e^{-2 d_e t} - e^{-2dt})
    // with R = σ² A / (2 (d - d_e)); the noise's energy is σ² / 2 d_e.
    let gain = late * (fast - slow) / ((direct + late) * slow);
    Some((10.0 * gain.log10(), t60_s))
}

/// Interval in seconds in which the slower of two slopes is heard alone.
fn alone_s(two: &Decay, from_s: f64, to_s: f64) -> std::ops::Range<f64> {
    let (Some((direct, fast)), Some((late, slow))) = (two.parts.first(), two.parts.get(1)) else { return 0.0..0.0 };
    let start = (ALONE * direct / late).ln() / (fast - slow);
    let end = (late / (ALONE * two.floor.max(late * 1e-12))).ln() / slow;
    let start = start.max(from_s);
    start..end.min(to_s).max(start)
}

/// Number of damped sines with a decay in 1/s that make up a sound in an octave.
///
/// It is the width of the sound's spectrum, relative to that of a single one; the width is the
/// squared integral of the power over the integral of its square. Noise has as many components as
/// fit beside one another.
fn components(samples: &[f64], rate_hz: f64, centre_hz: f64, decay_per_s: f64) -> f64 {
    let Some(spectrum) = Spectrum::of(samples, rate_hz) else { return 0.0 };
    let (mut sum, mut squares) = (0.0, 0.0);
    for (bin, power) in spectrum.power().enumerate() {
        let power = power * gaussian((bin as f64 * spectrum.bin_hz() / centre_hz).log2(), 0.0, SPREAD_OCTAVES).powi(2);
        sum += power;
        squares += power * power;
    }
    if squares <= 0.0 {
        return 0.0;
    }
    // The ratio for a Lorentzian of half-width d/2π is d; one cut off after a time T is wider.
    let width_hz = sum * sum / squares * spectrum.bin_hz();
    let cut = samples.len() as f64 / rate_hz * decay_per_s;
    width_hz / (decay_per_s / cut.tanh())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::modes::DampedSine;
    use crate::synthetic::of_these;

    #[test]
    fn three_modes_have_few_components_and_noise_has_many() {
        for decay_per_s in [3.0, 10.0] {
            let modes = [700.0, 900.0, 1150.0].map(|frequency_hz| DampedSine {
                frequency_hz,
                decay_per_s,
                amplitude: 0.3,
                phase: 1.0,
            });
            let sound = of_these(modes.to_vec(), 44_100, 1, -100.0);
            let three = components(&sound.samples, 44_100.0, 1000.0, decay_per_s);
            assert!((1.0..5.0).contains(&three), "{three}");
            let noise = of_these(Vec::new(), 44_100, 1, -20.0).samples;
            let faded: Vec<f64> =
                noise.iter().enumerate().map(|(n, x)| x * (-decay_per_s * n as f64 / 44_100.0).exp()).collect();
            let many = components(&faded, 44_100.0, 1000.0, decay_per_s);
            assert!(many > 15.0, "{many}");
        }
    }
}
