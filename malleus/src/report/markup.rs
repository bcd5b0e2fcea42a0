//! Text, sounds and pictures as parts of an HTML page.

use std::io::Cursor;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Escapes a text so that no part of it is taken for markup.
pub(super) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            other => safe.push(other),
        }
    }
    safe
}

/// Writes bytes of a media type as a `data:` address that holds them.
pub(super) fn data_uri(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", STANDARD.encode(bytes))
}

/// Writes a mono sound as a `data:` address that holds a 16-bit WAV file.
///
/// Samples beyond full scale, 1.0, are clipped.
///
/// # Errors
/// The encoder's error if the sound is longer than a WAV file can be.
pub(crate) fn sound_uri(samples: &[f32], rate_hz: f64) -> Result<String, hound::Error> {
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: rate_hz.round() as u32,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut bytes, spec)?;
    for sample in samples {
        writer.write_sample((sample.clamp(-1.0, 1.0) * 32_767.0).round() as i16)?;
    }
    writer.finalize()?;
    Ok(data_uri("audio/wav", bytes.get_ref()))
}

/// Escapes JSON for a script element, which a `<` could end.
pub(crate) fn json_in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}
