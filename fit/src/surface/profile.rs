//! Profiles: rows of a surface without their straight lines.

use super::error::SurfaceError;
use super::heights::Heights;
use super::options::Note;

/// Rows of one length and step, without their straight lines.
#[derive(Clone, Debug)]
pub(super) struct Profiles {
    pub(super) step_m: f64,
    pub(super) rows: Vec<Vec<f64>>,
}

/// Least number of points of a row.
pub(super) const LEAST_POINTS: usize = 256;
/// Number of points at either end of a row that interpolation may have spoilt.
const SPOILT: usize = 20;
/// Wavelength in metres beyond which heights do not tell whether their unit is right.
const ROUGHNESS_M: f64 = 2.8e-3;
/// Smallest and largest rms of heights, in metres, of shorter waves than that.
const LIKELY_RMS_M: [f64; 2] = [20e-9, 1e-3];

/// Rows of a surface whose holes are filled.
///
/// The first and the last 20 points of a long row are left out.
///
/// # Errors
/// [`SurfaceError::TooFew`] or [`SurfaceError::Flat`].
pub(super) fn profiles(heights: &Heights) -> Result<Profiles, SurfaceError> {
    if heights.columns < LEAST_POINTS {
        return Err(SurfaceError::TooFew { points: heights.columns, least: LEAST_POINTS });
    }
    let spoilt = if heights.columns > 8 * LEAST_POINTS { SPOILT } else { 0 };
    let kept = heights.columns - 2 * spoilt;
    let row = |row: &[f64]| {
        let mut row = row[spoilt..spoilt + kept - kept % 2].to_vec();
        level(&mut row);
        row
    };
    let rows: Vec<Vec<f64>> = heights.values.chunks_exact(heights.columns).map(row).collect();
    let most = rows.iter().flatten().fold(0.0, |most: f64, height| most.max(height.abs()));
    let largest = heights.values.iter().fold(0.0, |most: f64, height| most.max(height.abs()));
    // What rounding leaves of a straight line is no surface.
    if most <= 1e-9 * largest || most == 0.0 {
        return Err(SurfaceError::Flat);
    }
    Ok(Profiles { step_m: heights.step_m, rows })
}

/// Takes the straight line of least squares off a row.
pub(super) fn level(row: &mut [f64]) {
    let count = row.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = row.iter().sum::<f64>() / count;
    let along: f64 = row.iter().enumerate().map(|(index, height)| (index as f64 - middle) * height).sum();
    let size = count * (count * count - 1.0) / 12.0;
    for (index, height) in row.iter_mut().enumerate() {
        *height -= mean + along / size * (index as f64 - middle);
    }
}

impl Profiles {
    /// Number of points of a row.
    pub(super) fn points(&self) -> usize {
        self.rows.first().map_or(0, Vec::len)
    }

    /// Length of a row in metres.
    pub(super) fn length_m(&self) -> f64 {
        self.points() as f64 * self.step_m
    }

    /// Note if the heights look wrong by powers of 1000, as those of another unit are; they were
    /// multiplied by `height_scale`.
    pub(super) fn doubt(&self, height_scale: f64) -> Option<Note> {
        let piece = ((ROUGHNESS_M / self.step_m) as usize).clamp(8, self.points());
        let pieces = self.rows.iter().flat_map(|row| row.chunks_exact(piece));
        let (mut sum, mut count) = (0.0, 0.0);
        for piece in pieces {
            let mut piece = piece.to_vec();
            level(&mut piece);
            sum += piece.iter().map(|height| height * height).sum::<f64>();
            count += piece.len() as f64;
        }
        let rms_m = (sum / count).sqrt();
        let [least, most] = LIKELY_RMS_M;
        // The power that leads nearest to the middle: heights that obey the advice are not doubted.
        let powers = ((rms_m / (least * most).sqrt()).log10() / 3.0).round().clamp(-20.0, 20.0);
        let wrong_by = 10f64.powi(3 * powers as i32);
        let is_doubted = rms_m < least || rms_m > most;
        is_doubted.then_some(Note::Scale { rms_m, wrong_by, factor: height_scale / wrong_by })
    }
}
