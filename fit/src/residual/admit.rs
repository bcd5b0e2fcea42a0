//! Choice of the residual bands that sound: noise in place of a few strong modes would blur the
//! spectrum.

use super::noise::render;
use crate::band::Band;
use crate::distance::{ErbLevels, RecordedLevels};

/// Number of noises over which the distance is averaged.
const DRAWS: u64 = 2;
/// Factors on a band's weight that are tried.
const LEVELS: [f64; 3] = [1.0, 0.7, 0.4];
/// Rise of the distance in dB that counts as none, because noises differ.
const SAME_DB: f64 = 0.003;

/// Keeps residual bands as long as the log-spectral distance allows; the others get the weight 0.
///
/// Bands are tried in the order in which the model misses them most. First those are kept that do
/// not raise the distance, then those that keep it within `most_rise_db` of the model's alone.
pub fn admit(
    mut bands: Vec<Band>,
    recorded: &RecordedLevels,
    model: &[f64],
    rate_hz: f64,
    most_rise_db: f64,
) -> Vec<Band> {
    let (recording, end) = (recorded.strike(), recorded.early());
    let distance = |sounds: &[Vec<f64>]| {
        let each = sounds.iter().map(|sound| recorded.lsd_db(sound));
        each.sum::<f64>() / sounds.len() as f64
    };
    let mut sounds = vec![model.get(..end).unwrap_or(model).to_vec(); DRAWS as usize];
    let alone_db = distance(&sounds);
    let missed = missed_db2(recording, model, rate_hz);
    let mut waiting: Vec<usize> = (0..bands.len()).filter(|&band| bands[band].weight > 0.0).collect();
    waiting.sort_by(|&a, &b| missed(b).total_cmp(&missed(a)));
    let mut level_of = vec![0.0; bands.len()];
    let mut now_db = alone_db;
    for may_rise in [false, true] {
        let mut refused = Vec::new();
        for &index in &waiting {
            let noise: Vec<Vec<f64>> = (0..DRAWS)
                .map(|draw| render(&bands[index..=index], end, rate_hz, 1000 * draw + index as u64))
                .collect();
            let limit_db = if may_rise { alone_db + most_rise_db } else { now_db + SAME_DB };
            let tried = LEVELS.iter().find_map(|&level| {
                let with: Vec<Vec<f64>> = sounds
                    .iter()
                    .zip(&noise)
                    .map(|(sound, noise)| sound.iter().zip(noise).map(|(sound, noise)| sound + level * noise).collect())
                    .collect();
                let with_db = distance(&with);
                (with_db <= limit_db).then_some((level, with_db, with))
            });
            match tried {
                Some((level, with_db, with)) => (level_of[index], now_db, sounds) = (level, with_db, with),
                None => refused.push(index),
            }
        }
        waiting = refused;
    }
    for (band, level) in bands.iter_mut().zip(level_of) {
        band.weight *= level;
    }
    bands
}

/// Error of the model in a band, in squared decibels summed over all frames.
///
/// Bands above those of the ERB distance have none and come last.
fn missed_db2(recording: &[f64], model: &[f64], rate_hz: f64) -> impl Fn(usize) -> f64 {
    let (wanted, given) = (ErbLevels::new(recording, rate_hz), ErbLevels::new(model, rate_hz));
    let floor = wanted.floor();
    move |band| {
        let frames = wanted.frames.iter().zip(&given.frames).filter_map(|(wanted, given)| {
            let (wanted, given) = (wanted.get(band)?.max(floor), given.get(band)?.max(floor));
            Some((10.0 * (given / wanted).log10()).powi(2))
        });
        frames.sum()
    }
}
