//! Sections of a surface as measured, made periodic.

use std::f64::consts::PI;

use super::error::SurfaceError;
use super::profile::Profiles;
use super::waves::{frequency_per_m, signal, spectrum};

/// Length of the fade of a section's end into its beginning, in shortest waves.
pub(super) const FADE: f64 = 10.0;
/// Least length of a section in shortest waves.
const LEAST_WAVES: f64 = 20.0;

/// A section of the middle row in steps of at most `step_m`, and its step in metres.
///
/// The sound behind the section's end fades into its beginning, where there is any.
///
/// # Errors
/// [`SurfaceError::Section`] if it lies outside the profile or is too short.
pub(super) fn section(
    profiles: &Profiles,
    [from_m, to_m]: [f64; 2],
    shortest_m: f64,
    step_m: f64,
) -> Result<(Vec<f64>, f64), SurfaceError> {
    let row = &profiles.rows[profiles.rows.len() / 2];
    let length_m = profiles.length_m();
    if !(from_m >= 0.0 && to_m <= length_m && to_m - from_m >= LEAST_WAVES * shortest_m) {
        return Err(SurfaceError::Section { from_m, to_m, length_m, shortest_m });
    }
    let count = even((to_m - from_m) / profiles.step_m);
    let begin = ((from_m / profiles.step_m) as usize).min(row.len() - count);
    let fade = ((FADE * shortest_m / profiles.step_m) as usize).min(row.len() - begin - count).min(count / 4);
    let part = closed(&row[begin..begin + count + fade], fade);
    let points = even(count as f64 * profiles.step_m / step_m).max(2);
    let own_step_m = count as f64 * profiles.step_m / points as f64;
    Ok((limited(&part, profiles.step_m, points, shortest_m), own_step_m))
}

/// Even number of points nearest to a length.
pub(super) fn even(length: f64) -> usize {
    2 * (length / 2.0).round() as usize
}

/// A part whose last `fade` points are faded into its first ones, which follow on its end so.
pub(super) fn closed(part: &[f64], fade: usize) -> Vec<f64> {
    let count = part.len() - fade;
    let mut closed = part[..count].to_vec();
    for (index, behind) in part[count..].iter().enumerate() {
        let weight = 0.5 - 0.5 * (PI * (index as f64 + 0.5) / fade as f64).cos();
        closed[index] = weight * closed[index] + (1.0 - weight) * behind;
    }
    closed
}

/// A periodic part in another number of points, without its mean and waves shorter than
/// `shortest_m`.
fn limited(part: &[f64], step_m: f64, points: usize, shortest_m: f64) -> Vec<f64> {
    resampled(part, points, |bin| bin > 0 && frequency_per_m(bin, part.len(), step_m) <= 1.0 / shortest_m)
}

/// A periodic part in another number of points, of the waves that are kept.
pub(super) fn resampled(part: &[f64], points: usize, is_kept: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut bins = spectrum(part);
    for (bin, value) in bins.iter_mut().enumerate() {
        if !is_kept(bin) {
            *value *= 0.0;
        }
    }
    bins.resize(points / 2 + 1, fourier::Complex::new(0.0, 0.0));
    let scale = points as f64 / part.len() as f64;
    signal(bins, points).into_iter().map(|height| height * scale).collect()
}
