//! Decay times: those that a recording shows, and the longest that a table may have.

use std::f64::consts::{PI, TAU};

use kit::Object;

/// Length of the frames in which a recording's decay is followed, in samples.
///
/// It is 93 ms at 44.1 kHz, for a band of about 16 Hz.
const FRAME: usize = 4096;
/// Distance from a frame to the next, in samples.
const HOP: usize = 1024;
/// Level below the loudest frame, in dB, down to which the decay is followed from the second frame.
const DOWN_DB: f64 = 40.0;
/// Level above the median of the last quarter's frames, in dB, at which the following of the decay
/// ends at the latest.
const ABOVE_NOISE_DB: f64 = 6.0;
/// Least number of frames of which a slope is taken.
const LEAST_FRAMES: usize = 6;
/// Ratio by which a mode's T60 may exceed that of the band round it, because beating bends the
/// slope.
const TOLERANCE: f64 = 1.2;
/// Longest T60, in lengths of the recording: a slower decay would fall by less than 30 dB in all of
/// it.
const MOST_LENGTHS: f64 = 2.0;
/// Longest T60 where the band round it shows no decay, in times in which the whole recording falls
/// by [`FALL_DB`].
///
/// The background of a recording of a short sound does not decay: without this limit the fit's
/// modes and noise bands would imitate it for seconds.
const MOST_FALLS: f64 = 4.0;
/// Fall of the whole recording in dB.
const FALL_DB: f64 = 30.0;

/// T60 in seconds of the band round a frequency, by least squares on the level of Hann-windowed
/// frames.
///
/// Returns `None` if the level does not fall, or falls too fast for the frames to follow.
pub(crate) fn band_t60_s(heard: &[f64], rate_hz: f64, frequency_hz: f64) -> Option<f64> {
    let starts = (0..heard.len().saturating_sub(FRAME)).step_by(HOP);
    let levels: Vec<f64> = starts
        .filter_map(|start| heard.get(start..start + FRAME))
        .map(|frame| level_db(frame, frequency_hz / rate_hz))
        .collect();
    let loudest = levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut last = levels.get(levels.len() - levels.len() / 4..).unwrap_or(&[]).to_vec();
    last.sort_by(f64::total_cmp);
    let noise = last.get(last.len() / 2).copied().unwrap_or(f64::NEG_INFINITY);
    let least = (loudest - DOWN_DB).max(noise + ABOVE_NOISE_DB);
    let falling: Vec<f64> = levels.into_iter().skip(1).take_while(|&level| level > least).collect();
    if falling.len() < LEAST_FRAMES {
        return None;
    }
    let middle = (falling.len() - 1) as f64 / 2.0;
    let mean = falling.iter().sum::<f64>() / falling.len() as f64;
    let (mut across, mut square) = (0.0, 0.0);
    for (index, level) in falling.iter().enumerate() {
        let from_middle = index as f64 - middle;
        across += from_middle * (level - mean);
        square += from_middle * from_middle;
    }
    let db_per_s = across / square * rate_hz / HOP as f64;
    (db_per_s < 0.0).then(|| -60.0 / db_per_s)
}

/// Level in dB of one frequency, given in cycles per sample, in a Hann-windowed frame.
fn level_db(frame: &[f64], frequency: f64) -> f64 {
    let (mut real, mut imaginary) = (0.0, 0.0);
    for (index, sample) in frame.iter().enumerate() {
        let window = (PI * index as f64 / frame.len() as f64).sin().powi(2);
        let (sine, cosine) = (TAU * frequency * index as f64).sin_cos();
        real += window * sample * cosine;
        imaginary += window * sample * sine;
    }
    10.0 * (real * real + imaginary * imaginary).max(1e-30).log10()
}

/// Numbers of modes and noise bands whose decay was shortened.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limited {
    pub(crate) modes: usize,
    pub(crate) bands: usize,
}

/// Shortens the T60 of the object's modes and noise bands that ring longer than the recording
/// shows.
pub(crate) fn limit(object: &mut Object, heard: &[f64], rate_hz: f64) -> Limited {
    let longest = MOST_LENGTHS * heard.len() as f64 / rate_hz;
    let without_band = fall_time_s(heard, rate_hz, FALL_DB).map_or(longest, |fall| longest.min(MOST_FALLS * fall));
    // The shorter T60 that is allowed in place of the given one; none if that is allowed.
    let shorter = |t60_s: f64, frequency_hz: f64| {
        let allowed = band_t60_s(heard, rate_hz, frequency_hz)
            .map_or(without_band, |band| if t60_s > TOLERANCE * band { band.min(longest) } else { longest });
        (allowed < t60_s).then_some(allowed)
    };
    let mut limited = Limited { modes: 0, bands: 0 };
    for mode in &mut object.modes {
        let t60_s = 1000f64.ln() / f64::from(mode.decay_per_s);
        if let Some(allowed) = shorter(t60_s, f64::from(mode.frequency_hz)) {
            mode.decay_per_s = (1000f64.ln() / allowed) as f32;
            limited.modes += 1;
        }
    }
    if let Some(residual) = &mut object.residual {
        for (edges_hz, decay_db_per_s) in residual.edges_hz.windows(2).zip(&mut residual.decay_db_per_s) {
            let centre_hz = edges_hz.iter().map(|edge| f64::from(*edge)).product::<f64>().sqrt();
            if let Some(allowed) = shorter(60.0 / f64::from(*decay_db_per_s), centre_hz) {
                *decay_db_per_s = (60.0 / allowed) as f32;
                limited.bands += 1;
            }
        }
    }
    limited
}

/// Length of a stretch of which a level is taken, in seconds.
const LEVEL_S: f64 = 0.02;

/// Time in seconds from the loudest 20 ms until the level has fallen by `down_db` for good.
///
/// Returns `None` if it does not within the sound.
pub(crate) fn fall_time_s(sound: &[f64], rate_hz: f64, down_db: f64) -> Option<f64> {
    let size = (LEVEL_S * rate_hz) as usize;
    let powers: Vec<f64> = sound.chunks_exact(size).map(|chunk| chunk.iter().map(|x| x * x).sum()).collect();
    let (peak, &most) = powers.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    let last = powers.iter().rposition(|&power| power > most * 10f64.powf(-down_db / 10.0))?;
    (last + 1 < powers.len()).then(|| (last + 1 - peak) as f64 * LEVEL_S)
}
