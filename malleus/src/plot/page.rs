//! Blank pages, and their way into a PNG file, whole or not at all.

use std::path::Path;

use super::canvas::{Canvas, CanvasError};
use super::error::PlotError;

/// Creates a blank page, of `width` by `height` pixels, for the picture at `path`.
pub(super) fn blank(path: &Path, width: u32, height: u32) -> Result<Canvas, PlotError> {
    Canvas::new(width, height).map_err(|error| match error {
        CanvasError::Font => PlotError::Font { path: path.to_owned() },
        CanvasError::Surface => PlotError::Surface { path: path.to_owned(), width, height },
    })
}

/// Writes a page to the file at `path` as PNG with 8 bits per colour.
pub(super) fn write(path: &Path, canvas: &Canvas) -> Result<(), PlotError> {
    Ok(kit::file::write_whole(path, &png(path, canvas)?)?)
}

/// Bytes of a page as a PNG file with 8 bits per colour, for the file at `path`.
pub(super) fn png(path: &Path, canvas: &Canvas) -> Result<Vec<u8>, PlotError> {
    encode(canvas).map_err(|cause| PlotError::Encoding { path: path.to_owned(), cause })
}

fn encode(canvas: &Canvas) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, canvas.width(), canvas.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&canvas.rgb())?;
    writer.finish()?;
    Ok(bytes)
}
