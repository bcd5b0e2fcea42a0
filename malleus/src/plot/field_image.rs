//! Picture of a field over a body, which is transparent elsewhere.

use std::path::Path;

use super::error::PlotError;
use super::spectrogram_image::encode;

/// Grey of the value -1.
const DARKEST: f64 = 40.0;
/// Grey of the value 1.
const LIGHTEST: f64 = 250.0;

/// PNG of values from -1 (dark) over 0 (grey) to 1 (light); row 0 is the highest, and pixels
/// without a value are transparent.
///
/// # Errors
/// [`PlotError::Encoding`] with the path of the page if the picture has no pixels.
pub fn field_png(path: &Path, columns: u32, pixels: &[Option<f64>]) -> Result<Vec<u8>, PlotError> {
    let grey = |value: f64| (DARKEST + (LIGHTEST - DARKEST) * (0.5 + 0.5 * value.clamp(-1.0, 1.0))).round() as u8;
    let bytes: Vec<u8> = pixels.iter().flat_map(|value| value.map_or([0, 0], |value| [grey(value), 255])).collect();
    let rows = (pixels.len() / columns.max(1) as usize) as u32;
    encode(&bytes, columns, rows, png::ColorType::GrayscaleAlpha)
        .map_err(|cause| PlotError::Encoding { path: path.to_owned(), cause })
}
