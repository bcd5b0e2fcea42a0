//! Spectrograms without axes, for pages that draw their own.

use std::path::Path;

use super::colour::{LANE, MAGMA};
use super::error::PlotError;
use super::spectrogram::{FLOOR_DB, HIGHEST_HZ, LOWEST_HZ, Spectrogram};

/// Frequencies in Hz at the lower and upper edge of a spectrogram without axes.
///
/// Between them, equal ratios of frequency take equal heights.
pub const SPECTROGRAM_HZ: (f64, f64) = (LOWEST_HZ, HIGHEST_HZ);
/// Range of levels that a spectrogram without axes shows, in dB below its loudest place.
pub const SPECTROGRAM_RANGE_DB: f32 = 80.0;

/// Encodes the spectrograms of sounds as PNG, each `columns` by `rows` pixels.
///
/// Time runs to the right over the whole sound, and frequency upwards over [`SPECTROGRAM_HZ`]. All
/// sounds share one scale of levels: the loudest place of the first sound is the brightest, and
/// [`SPECTROGRAM_RANGE_DB`] below it is black.
///
/// # Errors
/// [`PlotError`] with `path`, the page that the pictures are for, if a picture has no pixels.
pub fn spectrogram_pngs(
    path: &Path,
    sounds: &[&[f32]],
    rate_hz: f64,
    columns: u32,
    rows: u32,
) -> Result<Vec<Vec<u8>>, PlotError> {
    let (width, height) = (columns as usize, rows as usize);
    let pictures: Vec<Spectrogram> =
        sounds.iter().map(|sound| Spectrogram::of(&[sound], rate_hz, width, height)).collect();
    let places = || (0..width).flat_map(|column| (0..height).map(move |row| (column, row)));
    let loudest_db = pictures
        .first()
        .map_or(0.0, |first| places().filter_map(|(column, row)| first.level_db(column, row)).fold(FLOOR_DB, f32::max));
    let encoded = pictures.iter().map(|picture| {
        let mut rgb = Vec::with_capacity(width * height * 3);
        for row in (0..height).rev() {
            for column in 0..width {
                let colour = picture
                    .level_db(column, row)
                    .map_or(LANE, |level| MAGMA.colour(1.0 - (loudest_db - level) / SPECTROGRAM_RANGE_DB));
                rgb.extend([colour.red, colour.green, colour.blue]);
            }
        }
        encode(&rgb, columns, rows, png::ColorType::Rgb)
            .map_err(|cause| PlotError::Encoding { path: path.to_owned(), cause })
    });
    encoded.collect()
}

/// PNG of values from -1 (blue) over 0 (white) to 1 (red); row 0 is the lowest.
///
/// # Errors
/// [`PlotError::Encoding`] with the path of the page.
pub fn signed_png(path: &Path, columns: u32, rows: u32, at: impl Fn(u32, u32) -> f64) -> Result<Vec<u8>, PlotError> {
    let mut rgb = Vec::with_capacity(columns as usize * rows as usize * 3);
    for row in (0..rows).rev() {
        for column in 0..columns {
            let value = at(column, row).clamp(-1.0, 1.0);
            // The root shows errors of a hundredth, too.
            let faded = (255.0 * (1.0 - value.abs().sqrt())) as u8;
            rgb.extend(if value > 0.0 { [255, faded, faded] } else { [faded, faded, 255] });
        }
    }
    encode(&rgb, columns, rows, png::ColorType::Rgb)
        .map_err(|cause| PlotError::Encoding { path: path.to_owned(), cause })
}

/// Encodes pixels of 8 bits a channel as PNG.
pub(super) fn encode(
    pixels: &[u8],
    columns: u32,
    rows: u32,
    colour: png::ColorType,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_is_a_bright_line_at_its_frequency_and_a_quieter_one_is_darker() {
        let sine = |amplitude: f64| -> Vec<f32> {
            (0..24_000)
                .map(|n| (amplitude * (std::f64::consts::TAU * 1000.0 * f64::from(n) / 48_000.0).sin()) as f32)
                .collect()
        };
        let (loud, quiet) = (sine(0.5), sine(0.005));
        let pngs = spectrogram_pngs(Path::new("page.html"), &[&loud, &quiet], 48_000.0, 40, 100).expect("encoded");
        let brightest = |png: &[u8]| {
            let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().expect("a PNG");
            let mut rgb = vec![0; 40 * 100 * 3];
            reader.next_frame(&mut rgb).expect("pixels");
            let light = |row: usize| rgb[(row * 40 + 20) * 3..][..3].iter().map(|x| u32::from(*x)).sum::<u32>();
            (0..100).map(|row| (light(row), row)).max().expect("rows")
        };
        let ((loud, row), (quiet, _)) = (brightest(&pngs[0]), brightest(&pngs[1]));
        let expected = 100.0 * (1.0 - (1000.0 / LOWEST_HZ).ln() / (HIGHEST_HZ / LOWEST_HZ).ln());
        assert!((row as f64 - expected).abs() < 4.0, "row {row}, expected {expected}");
        assert!(loud > quiet + 150, "{loud} {quiet}");
    }
}
