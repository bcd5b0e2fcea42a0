//! The mug: measured with an impact hammer (samuel-clarke/diffimpact, MIT).
//!
//! Frequencies and decays are those of `mug_modes.csv`. Gains are fitted by linear least squares:
//! the modes, driven by the measured force, are to give the microphone's signal over 0.3 s of the
//! hit at 0.4047 s. The gains of the file itself would leave an error of -23.5 dB.
//!
//! Least squares alone would leave -27.4 dB, and a static response that makes 4.5 % of a soft
//! strike a thump. One more equation asks that this response be 0. Its weight takes a quarter of
//! the response away and costs 0.3 dB.

use std::path::Path;

use kit::{Acceleration, Gain, Mode, Object};

use crate::failure::Failure;
use crate::level::rounded;

/// Sample rate of the recording in Hz.
const RATE_HZ: f64 = 44_100.0;
/// Index of the sample at which the force peaks.
const PEAK: usize = 17_849;
/// Number of samples from the start of the force to its peak.
const BEFORE: usize = 132;
/// Delay from the hammer's force to the microphone, in samples.
const DELAY: usize = 14;
/// Length of the stretch that is fitted, in samples: 0.3 s.
const LENGTH: usize = 13_230;
/// Weight of the equation for the static response, where one sample of the microphone has 1.
const STATIC_WEIGHT: f64 = 0.8;

/// Makes the mug from its data; `None` if the data are absent.
pub(crate) fn derive(folder: &Path) -> Result<Option<Object>, Failure> {
    let (modes, recording) = (folder.join("mug_modes.csv"), folder.join("hammer_ceramic.wav"));
    if !modes.exists() || !recording.exists() {
        return Ok(None);
    }
    let mut poles: Vec<(f64, f64)> = Vec::new();
    for row in csv::Reader::from_path(&modes)?.deserialize() {
        let (frequency_hz, decay_per_s, _, _): (f64, f64, f64, f64) = row?;
        poles.push((frequency_hz, decay_per_s));
    }
    let samples = hound::WavReader::open(&recording)?.into_samples::<i16>().collect::<Result<Vec<_>, _>>()?;
    let channel = |channel: usize, start: usize| -> Vec<f64> {
        samples.iter().skip(2 * start + channel).step_by(2).take(LENGTH).map(|&x| f64::from(x) / 32_768.0).collect()
    };
    let force = channel(1, PEAK - BEFORE);
    let mut microphone = channel(0, PEAK - BEFORE + DELAY);

    let mut columns: Vec<Vec<f64>> = poles.iter().flat_map(|&pole| driven(pole, &force)).collect();
    columns.push(force); // the acceleration sound
    let still = poles.iter().flat_map(|&pole| under_constant_force(pole)).chain([1.0]);
    columns.iter_mut().zip(still).for_each(|(column, still)| column.push(STATIC_WEIGHT * still));
    microphone.push(0.0);
    let solution = least_squares(&columns, &microphone);
    let gains = solution.chunks_exact(2);
    Ok(Some(Object {
        name: "mug".to_owned(),
        source: "ceramic mug, impact hammer: frequencies and decays of 64 fitted modes; gains and acceleration by linear least squares of the microphone over 0.3 s of the hit at 0.4047 s, and of the static response, driven by the measured force (samuel-clarke/diffimpact, data/hammer/ceramic.wav); force in units of the recording's full scale".to_owned(),
        licence: "MIT".to_owned(),
        reference_force: 1.0,
        acceleration: Acceleration::Factor(rounded(solution.last().copied().unwrap_or(0.0))),
        modes: poles
            .iter()
            .zip(gains)
            .map(|(&(frequency_hz, decay_per_s), gain)| Mode {
                frequency_hz: rounded(frequency_hz),
                decay_per_s: rounded(decay_per_s),
                gains: vec![Gain { sine: rounded(gain[0]), cosine: rounded(gain[1]) }],
            })
            .collect(),
        residual: None,
        dynamic_filter: None,
        biquads: None,
            surface: None,
    }))
}

/// Force through `h = e^{-dt} sin 2πft` and through `h = e^{-dt} cos 2πft`, as tables define gains.
///
/// That is `(1/fs) Σ F[m] h[n-m]`, with h[0] at half weight.
fn driven((frequency_hz, decay_per_s): (f64, f64), force: &[f64]) -> [Vec<f64>; 2] {
    let radius = (-decay_per_s / RATE_HZ).exp();
    let (sin, cos) = (std::f64::consts::TAU * frequency_hz / RATE_HZ).sin_cos();
    let (mut re, mut im) = (0.0, 0.0);
    let mut columns = [Vec::with_capacity(force.len()), Vec::with_capacity(force.len())];
    for &force in force {
        let input = force / RATE_HZ;
        (re, im) = (radius * (cos * re - sin * im) + input, radius * (sin * re + cos * im));
        columns[0].push(im);
        columns[1].push(re - input / 2.0);
    }
    columns
}

/// Limits of the two results of [`driven`] under a constant force of 1.
fn under_constant_force((frequency_hz, decay_per_s): (f64, f64)) -> [f64; 2] {
    let radius = (-decay_per_s / RATE_HZ).exp();
    let (sin, cos) = (std::f64::consts::TAU * frequency_hz / RATE_HZ).sin_cos();
    // 1 / (1 - r e^(iθ))
    let (re, im) = (1.0 - radius * cos, radius * sin);
    let power = re * re + im * im;
    [im / power / RATE_HZ, (re / power - 0.5) / RATE_HZ]
}

/// Solves linear least squares by the normal equations and Cholesky's decomposition.
///
/// The columns are far from dependent, and a table needs only six digits.
fn least_squares(columns: &[Vec<f64>], target: &[f64]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let count = columns.len();
    // Columns are scaled to unit length, so that all pivots are of one order of magnitude.
    let lengths: Vec<f64> = columns.iter().map(|column| dot(column, column).sqrt()).collect();
    let mut factor = vec![vec![0.0; count]; count];
    let mut solution = vec![0.0; count];
    for row in 0..count {
        for column in 0..=row {
            let product = dot(&columns[row], &columns[column]) / (lengths[row] * lengths[column]);
            let rest = product - dot(&factor[row][..column], &factor[column][..column]);
            factor[row][column] = if row == column { rest.sqrt() } else { rest / factor[column][column] };
        }
        let target = dot(&columns[row], target) / lengths[row];
        solution[row] = (target - dot(&factor[row][..row], &solution[..row])) / factor[row][row];
    }
    for row in (0..count).rev() {
        let later: f64 = (row + 1..count).map(|other| factor[other][row] * solution[other]).sum();
        solution[row] = (solution[row] - later) / factor[row][row];
    }
    solution.iter().zip(&lengths).map(|(solution, length)| solution / length).collect()
}
