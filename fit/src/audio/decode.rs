//! From a file to samples.

use std::fs::File;
use std::path::Path;

use symphonia::core::codecs::audio::AudioDecoderOptions;
use symphonia::core::errors::Error;
use symphonia::core::formats::probe::Hint;
use symphonia::core::formats::{FormatOptions, TrackType};
use symphonia::core::io::MediaSourceStream;
use symphonia::core::meta::MetadataOptions;

use super::decimate::decimate;
use super::{Note, Recording};
use crate::FitError;

/// Seconds read at most, so that memory stays bounded whatever the file.
const LONGEST_S: f64 = 120.0;
/// Rates above this are decimated.
const HIGHEST_RATE_HZ: u32 = 48_000;
const RATES_HZ: std::ops::RangeInclusive<u32> = 4_000..=768_000;

/// All channels of a file as far as they were read.
struct Decoded {
    interleaved: Vec<f32>,
    channels: usize,
    rate_hz: u32,
    notes: Vec<Note>,
}

/// Reads the loudest channel of an audio file (other than the force), and its force channel (counted from 0) if one is named.
///
/// # Errors
/// [`FitError`] for what cannot be read, is no audio, is empty, has no such channel, or holds samples that are no numbers.
pub fn read(path: &Path, force_channel: Option<usize>) -> Result<Recording, FitError> {
    let Decoded { interleaved, channels, rate_hz, mut notes } = decode(path)?;
    if interleaved.is_empty() || channels == 0 {
        return Err(FitError::Empty { path: path.to_owned() });
    }
    if let Some(index) = interleaved.iter().position(|x| !x.is_finite()) {
        return Err(FitError::NotFinite { path: path.to_owned(), index: index / channels });
    }
    if let Some(channel) = force_channel.filter(|channel| *channel >= channels) {
        return Err(FitError::Channel { path: path.to_owned(), channel, channels });
    }
    let of = |channel: usize| interleaved.iter().copied().skip(channel).step_by(channels);
    let energy = |channel: usize| of(channel).map(|x| f64::from(x).powi(2)).sum::<f64>();
    let taken = (0..channels)
        .filter(|channel| Some(*channel) != force_channel)
        .map(|channel| (channel, energy(channel)))
        .reduce(|best, next| if next.1 > best.1 { next } else { best })
        .ok_or_else(|| FitError::NoMicrophone { path: path.to_owned() })?
        .0;
    if channels > 1 + usize::from(force_channel.is_some()) {
        notes.push(Note::Channel { taken, channels });
    }
    let factor = rate_hz.div_ceil(HIGHEST_RATE_HZ) as usize;
    let new_rate_hz = f64::from(rate_hz) / factor as f64;
    if factor > 1 {
        notes.push(Note::Decimated { from_hz: f64::from(rate_hz), to_hz: new_rate_hz });
    }
    let channel = |index| decimate(&of(index).collect::<Vec<f32>>(), factor);
    Ok(Recording { samples: channel(taken), force: force_channel.map(channel), rate_hz: new_rate_hz, notes })
}

fn decode(path: &Path) -> Result<Decoded, FitError> {
    let file = File::open(path).map_err(|cause| FitError::Read { path: path.to_owned(), cause })?;
    if file.metadata().is_ok_and(|metadata| metadata.len() == 0) {
        return Err(FitError::Empty { path: path.to_owned() });
    }
    let not_audio = |cause: String| FitError::NotAudio { path: path.to_owned(), cause };
    let stream = MediaSourceStream::new(Box::new(file), Default::default());
    let mut hint = Hint::new();
    if let Some(extension) = path.extension().and_then(|extension| extension.to_str()) {
        hint.with_extension(extension);
    }
    let mut format = symphonia::default::get_probe()
        .probe(&hint, stream, FormatOptions::default(), MetadataOptions::default())
        .map_err(|error| not_audio(error.to_string()))?;
    let track = format.default_track(TrackType::Audio).ok_or_else(|| not_audio("no audio track".to_owned()))?;
    let track_id = track.id;
    let parameters = track
        .codec_params
        .as_ref()
        .and_then(|parameters| parameters.audio())
        .ok_or_else(|| not_audio("the track has no audio codec".to_owned()))?;
    let mut decoder = symphonia::default::get_codecs()
        .make_audio_decoder(parameters, &AudioDecoderOptions::default())
        .map_err(|error| not_audio(error.to_string()))?;
    let mut decoded = Decoded { interleaved: Vec::new(), channels: 0, rate_hz: 0, notes: Vec::new() };
    let mut packet_samples: Vec<f32> = Vec::new();
    loop {
        let packet = match format.next_packet() {
            Ok(Some(packet)) => packet,
            Ok(None) => break,
            Err(Error::IoError(error)) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
                decoded.notes.push(Note::Cut { cause: error.to_string() });
                break;
            }
            Err(error) => {
                decoded.notes.push(Note::Cut { cause: error.to_string() });
                break;
            }
        };
        if packet.track_id != track_id {
            continue;
        }
        let buffer = match decoder.decode(&packet) {
            Ok(buffer) => buffer,
            Err(error) => {
                decoded.notes.push(Note::Cut { cause: error.to_string() });
                break;
            }
        };
        let (channels, rate_hz) = (buffer.spec().channels().count(), buffer.spec().rate());
        if decoded.channels == 0 {
            (decoded.channels, decoded.rate_hz) = (channels, rate_hz);
            if !RATES_HZ.contains(&rate_hz) {
                return Err(FitError::Rate { path: path.to_owned(), rate_hz });
            }
        } else if (decoded.channels, decoded.rate_hz) != (channels, rate_hz) {
            decoded.notes.push(Note::Cut { cause: "channels or rate change in the middle".to_owned() });
            break;
        }
        buffer.copy_to_vec_interleaved(&mut packet_samples);
        decoded.interleaved.extend_from_slice(&packet_samples);
        let most = (LONGEST_S * f64::from(rate_hz)) as usize * channels;
        if decoded.interleaved.len() > most {
            decoded.interleaved.truncate(most);
            decoded.notes.push(Note::Truncated { seconds: LONGEST_S });
            break;
        }
    }
    Ok(decoded)
}
