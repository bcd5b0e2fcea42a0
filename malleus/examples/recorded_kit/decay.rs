//! How long things ring: in a recording, and what a table may claim.

use std::f64::consts::{PI, TAU};

use kit::Mode;

/// Frames in which a recording's decay is followed: 93 ms at 44.1 kHz, a band of about 16 Hz.
const FRAME: usize = 4096;
const HOP: usize = 1024;
/// The decay is followed from the second frame to this much below the loudest, or to `ABOVE_NOISE_DB` above the quietest frame.
const DOWN_DB: f64 = 40.0;
const ABOVE_NOISE_DB: f64 = 6.0;
/// Frames that a slope needs.
const LEAST_FRAMES: usize = 6;
/// A mode may ring this much longer than the band round it: beating bends the slope.
const TOLERANCE: f64 = 1.2;
/// T60 at most, in lengths of the recording: a slower decay falls by less than 30 dB in all that was heard.
const MOST_LENGTHS: f64 = 2.0;

/// T60 in seconds of the band round a frequency, by least squares on the level of Hann-windowed frames; `None` where it does not
/// fall, or too fast for the frames to tell.
pub(crate) fn band_t60_s(heard: &[f64], rate_hz: f64, frequency_hz: f64) -> Option<f64> {
    let starts = (0..heard.len().saturating_sub(FRAME)).step_by(HOP);
    let levels: Vec<f64> = starts
        .filter_map(|start| heard.get(start..start + FRAME))
        .map(|frame| level_db(frame, frequency_hz / rate_hz))
        .collect();
    let loudest = levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let quietest = levels.iter().copied().fold(f64::INFINITY, f64::min);
    let least = (loudest - DOWN_DB).max(quietest + ABOVE_NOISE_DB);
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

/// Level of one frequency (in cycles a sample) in a Hann-windowed frame, dB.
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

/// Makes modes that ring longer than the recording shows ring as long as it does; returns how many.
pub(crate) fn limit(modes: &mut [Mode], heard: &[f64], rate_hz: f64) -> usize {
    let longest = MOST_LENGTHS * heard.len() as f64 / rate_hz;
    let mut limited = 0;
    for mode in modes {
        let t60_s = 1000f64.ln() / f64::from(mode.decay_per_s);
        let band = band_t60_s(heard, rate_hz, f64::from(mode.frequency_hz)).filter(|band| t60_s > TOLERANCE * band);
        let allowed = t60_s.min(longest).min(band.unwrap_or(f64::INFINITY));
        if allowed < t60_s {
            mode.decay_per_s = (1000f64.ln() / allowed) as f32;
            limited += 1;
        }
    }
    limited
}

/// Stretch of which a level is taken, in seconds.
const LEVEL_S: f64 = 0.02;

/// Seconds from the loudest 20 ms to where the level has fallen by `down_db` for good; `None` if it never does.
pub(crate) fn fall_time_s(sound: &[f64], rate_hz: f64, down_db: f64) -> Option<f64> {
    let size = (LEVEL_S * rate_hz) as usize;
    let powers: Vec<f64> = sound.chunks_exact(size).map(|chunk| chunk.iter().map(|x| x * x).sum()).collect();
    let (peak, &most) = powers.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    let last = powers.iter().rposition(|&power| power > most * 10f64.powf(-down_db / 10.0))?;
    (last + 1 < powers.len()).then(|| (last + 1 - peak) as f64 * LEVEL_S)
}
