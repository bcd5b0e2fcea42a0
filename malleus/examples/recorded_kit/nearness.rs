//! Nearness of a table's sound to the recording that the table names.

use std::path::Path;

use fit::audio::{self, Recording};
use fit::hearing::{Heard, Scores};
use fit::render::by_instrument;
use fit::segment::{self, Hit};
use kit::Kit;

/// Failure of a measurement, from any of its parts.
type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Length of the attack whose level is compared, in seconds.
const ATTACK_S: f64 = 0.003;

/// Measures of a table's sound against the recorded strike.
///
/// The sound of a table is scaled in common, so that it is compared at the level at which its
/// loudness error is least, to a tenth of a dB.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearness {
    /// Measures of hearing.
    pub(crate) scores: Scores,
    /// Peak of the sound over that of the recording, in dB.
    pub(crate) peak_db: f64,
    /// Rms of the sound's first 3 ms over that of the recording, in dB.
    pub(crate) attack_db: f64,
}

/// Reads the recording that a table names, from a folder, and finds the strike in it.
///
/// # Errors
/// A message if the table's source names no strike, or the recording cannot be read or holds no
/// strike.
pub(crate) fn recorded(table: &Kit, recordings: &Path) -> Result<(Recording, Hit), Failure> {
    let object = table.objects.first().ok_or("the table has no object")?;
    let (file, at_s) = strike_of(&object.source).ok_or("the source names no strike of a recording")?;
    let recording = audio::read(&recordings.join(file), None)?;
    let (hits, _) = segment::hits(&recording)?;
    let off_s = |hit: &Hit| (hit.onset as f64 / recording.rate_hz - at_s).abs();
    let hit = hits.into_iter().min_by(|a, b| off_s(a).total_cmp(&off_s(b))).ok_or("the recording holds no strike")?;
    Ok((recording, hit))
}

/// Plays a table by dsp-core, with the table's own noise, and compares it with a recording in a
/// folder.
///
/// # Errors
/// The errors of [`recorded`], and those of a table that a board would refuse.
pub(crate) fn of(table: &Kit, recordings: &Path) -> Result<Nearness, Failure> {
    let (recording, hit) = recorded(table, recordings)?;
    let rate_hz = recording.rate_hz;
    let strike = recording.samples.get(hit.onset..hit.end).ok_or("the recording holds no sound")?;
    let sound = by_instrument(table, 0.0, rate_hz, strike.len())?;
    let heard = Heard::new(&recording.samples, rate_hz, hit.onset, hit.end);
    let sound = at_best_level(&heard, strike, &sound);
    let first = (ATTACK_S * rate_hz) as usize;
    let attack = |sound: &[f64]| power(sound.get(..first).unwrap_or(sound));
    Ok(Nearness {
        scores: heard.scores(&sound),
        peak_db: 20.0 * (peak(&sound) / peak(strike)).log10(),
        attack_db: 10.0 * (attack(&sound) / attack(strike)).log10(),
    })
}

/// File and time in seconds of the strike that a source names: "FILE, strike at TIME s: ...".
fn strike_of(source: &str) -> Option<(&str, f64)> {
    let (file, rest) = source.split_once(", strike at ")?;
    let (time, _) = rest.split_once(" s")?;
    Some((file, time.parse().ok()?))
}

/// The sound at the level at which its loudness error is least.
///
/// That level is found in two passes round the level of equal power: steps of 0.5 dB, then of 0.1
/// dB.
fn at_best_level(heard: &Heard, strike: &[f64], sound: &[f64]) -> Vec<f64> {
    let equal = (power(strike) / power(sound)).sqrt();
    let compared = heard.loudness().length().min(sound.len());
    let scaled =
        |sound: &[f64], db: f64| -> Vec<f64> { sound.iter().map(|x| x * equal * 10f64.powf(db / 20.0)).collect() };
    let mut best = (f64::INFINITY, 0.0);
    for (step_db, steps) in [(0.5, 8), (0.1, 4)] {
        let middle = best.1;
        for step in -steps..=steps {
            let db = middle + step_db * f64::from(step);
            let error = heard.loudness().error(&scaled(sound.get(..compared).unwrap_or(sound), db)).whole;
            if error < best.0 {
                best = (error, db);
            }
        }
    }
    scaled(sound, best.1)
}

fn power(sound: &[f64]) -> f64 {
    sound.iter().map(|x| x * x).sum::<f64>().max(f64::MIN_POSITIVE)
}

fn peak(sound: &[f64]) -> f64 {
    sound.iter().fold(f64::MIN_POSITIVE, |peak: f64, x| peak.max(x.abs()))
}
