//! Strikes as rises in the ear's bands over what rings before them.

use std::f64::consts::TAU;

/// Length of a frame in samples per second of rate: 11.6 ms.
const FRAME_S: f64 = 0.0116;
/// Number of hops in a frame.
const HOPS: usize = 4;
/// Width of a band in units of the ear's.
const WIDTH_ERB: f64 = 1.5;
/// Lowest frequency of a band in Hz.
const LOWEST_HZ: f64 = 120.0;
/// Share of frames that are quieter than a band's noise floor.
const FLOOR_SHARE: f64 = 0.05;
/// Level in dB over the floor below which a band counts as silent.
const OVER_FLOOR_DB: f64 = 8.0;
/// Power that a band has at least, so that silence has a level.
const LEAST_POWER: f64 = 1e-14;
/// Largest rise of a band that counts, in dB.
const MOST_RISE_DB: f64 = 20.0;
/// Least mean rise of all bands in a strike, in dB.
const LEAST_RISE_DB: f64 = 1.2;
/// Least time from one strike to the next in seconds.
const APART_S: f64 = 0.03;

/// Samples near which strikes begin, within about 3 ms, in order of time.
///
/// A frame is compared with the frames that end before it begins. Ringing only decays, or beats
/// slowly, so a rise in many bands at once is a strike.
pub(crate) fn rises(samples: &[f64], rate_hz: f64) -> Vec<usize> {
    let size = ((FRAME_S * rate_hz) as usize).next_power_of_two();
    let hop = size / HOPS;
    let bands = bands(rate_hz, size);
    let mut levels = levels_db(samples, &bands, size, hop);
    raise_to_floor(&mut levels, bands.len());
    let novelty: Vec<f64> = (0..levels.len()).map(|frame| rise_db(&levels, frame)).collect();
    let apart = ((APART_S * rate_hz) as usize / hop).max(1);
    let is_peak = |frame: &usize| {
        let here = novelty[*frame];
        let (from, to) = (frame.saturating_sub(apart), (frame + apart + 1).min(novelty.len()));
        here >= LEAST_RISE_DB
            && novelty[from..*frame].iter().all(|other| *other < here)
            && novelty[frame + 1..to].iter().all(|other| *other <= here)
    };
    (0..novelty.len()).filter(is_peak).map(|frame| (frame * hop + hop / 2).min(samples.len())).collect()
}

/// Power of a recording's noise in dB of full scale, as its quietest frames tell it; `None` for
/// silence and for recordings shorter than a frame.
///
/// White noise of that power is as loud as the median band of the ear in the quietest twentieth of
/// the frames. The power is 6 dB too low, because narrow bands scatter. Digital silence does not
/// count.
pub(super) fn quietest_db(samples: &[f64], rate_hz: f64) -> Option<f64> {
    let size = ((FRAME_S * rate_hz) as usize).next_power_of_two();
    let bands = bands(rate_hz, size);
    let mut levels = levels_db(samples, &bands, size, size / HOPS);
    let silent_db = 10.0 * LEAST_POWER.log10();
    levels.retain(|frame| frame.iter().any(|level| *level > silent_db));
    // Energy of the window, whose samples are 1 - cos.
    let window = 1.5 * size as f64;
    let quiet = |(index, band): (usize, &std::ops::Range<usize>)| {
        let share = window * band.len() as f64;
        quietest(&levels, index).map(|level| level - 10.0 * share.log10())
    };
    let mut quiet = bands.iter().enumerate().map(quiet).collect::<Option<Vec<f64>>>()?;
    quiet.sort_by(f64::total_cmp);
    quiet.get(quiet.len() / 2).copied()
}

/// Level of a band that a twentieth of the frames does not reach.
fn quietest(levels: &[Vec<f64>], band: usize) -> Option<f64> {
    let mut sorted: Vec<f64> = levels.iter().map(|frame| frame[band]).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get((FLOOR_SHARE * sorted.len() as f64) as usize).copied()
}

/// Levels in dB of all bands, frame by frame; silence precedes the first frame.
fn levels_db(samples: &[f64], bands: &[std::ops::Range<usize>], size: usize, hop: usize) -> Vec<Vec<f64>> {
    let transform = fourier::forward(size);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let window: Vec<f64> = (0..size).map(|n| 1.0 - (TAU * (n as f64 + 0.5) / size as f64).cos()).collect();
    let mut levels = Vec::with_capacity(samples.len() / hop);
    for start in (0..samples.len().saturating_sub(size)).step_by(hop) {
        for ((slot, x), weight) in input.iter_mut().zip(&samples[start..start + size]).zip(&window) {
            *slot = x * weight;
        }
        if transform.process(&mut input, &mut output).is_err() {
            break;
        }
        let power = |band: &std::ops::Range<usize>| output[band.clone()].iter().map(|bin| bin.norm_sqr()).sum::<f64>();
        levels.push(bands.iter().map(|band| 10.0 * (power(band) + LEAST_POWER).log10()).collect::<Vec<f64>>());
    }
    levels
}

/// Raises levels to 8 dB over each band's noise floor, so that noise does not rise.
fn raise_to_floor(levels: &mut [Vec<f64>], bands: usize) {
    for band in 0..bands {
        let Some(floor) = quietest(levels, band).map(|level| level + OVER_FLOOR_DB) else { continue };
        levels.iter_mut().for_each(|frame| frame[band] = frame[band].max(floor));
    }
}

/// Bins of bands as wide as the ear's, at least two bins each.
fn bands(rate_hz: f64, size: usize) -> Vec<std::ops::Range<usize>> {
    let bin_hz = rate_hz / size as f64;
    let mut bands = Vec::new();
    let mut low = (LOWEST_HZ / bin_hz) as usize;
    while low + 2 < size / 2 {
        let width_hz = WIDTH_ERB * 24.7 * (0.004_37 * low as f64 * bin_hz + 1.0);
        let high = (low + (width_hz / bin_hz).round().max(2.0) as usize).min(size / 2);
        bands.push(low..high);
        low = high;
    }
    bands
}

/// Mean over bands of the rise of a frame over the loudest of three frames before it.
fn rise_db(levels: &[Vec<f64>], frame: usize) -> f64 {
    let Some(before) = frame.checked_sub(HOPS) else { return 0.0 };
    let earlier = &levels[before.saturating_sub(2)..=before];
    let rises = levels[frame].iter().enumerate().map(|(band, level)| {
        let most = earlier.iter().map(|frame| frame[band]).fold(f64::NEG_INFINITY, f64::max);
        (level - most).clamp(0.0, MOST_RISE_DB)
    });
    rises.sum::<f64>() / levels[frame].len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;

    #[test]
    fn nine_of_ten_strikes_rise_and_few_rises_are_none() {
        let (mut found, mut all, mut rising) = (0, 0, 0);
        for seed in 1..4 {
            let sound = plain(seed, 6.0, 10, -60.0);
            let rises = rises(&sound.samples, sound.rate_hz);
            let near = |at_s: f64| rises.iter().any(|rise| (*rise as f64 / sound.rate_hz - at_s).abs() < 0.006);
            found += sound.strikes.iter().filter(|strike| near(strike.at_s)).count();
            all += sound.strikes.len();
            rising += rises.len();
        }
        assert!(found * 10 >= all * 8 && rising <= all, "{found} of {all}, {rising} rises");
    }
}
