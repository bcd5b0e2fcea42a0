//! Decoding of audio files to samples.

use std::fs::File;
use std::path::Path;

use symphonia::core::codecs::audio::AudioDecoderOptions;
use symphonia::core::errors::Error;
use symphonia::core::formats::probe::Hint;
use symphonia::core::formats::{FormatOptions, TrackType};
use symphonia::core::io::MediaSourceStream;
use symphonia::core::meta::MetadataOptions;

use super::decimate::decimate;
use super::offset::constant_offset;
use super::recording::{Note, Recording};
use crate::clipping::flat_tops;
use crate::error::FitError;

/// Maximum length in seconds that [`read`] takes, so that memory stays bounded for every file.
const LONGEST_S: f64 = 120.0;
/// Highest sample rate in Hz that is not decimated.
const HIGHEST_RATE_HZ: u32 = 48_000;
/// Sample rates that are accepted, in Hz: the instrument plays from 8000 Hz on, and rates above
/// [`HIGHEST_RATE_HZ`] are decimated.
const RATES_HZ: std::ops::RangeInclusive<u32> = 8_000..=768_000;
/// Level below which a channel is silent, full scale 1. A louder channel whose values all lie
/// within this of each other is constant.
const LEAST_SOUND: f64 = 2e-6;

/// Samples of all channels, as far as the file was read.
struct Decoded {
    interleaved: Vec<f32>,
    channels: usize,
    rate_hz: u32,
    notes: Vec<Note>,
}

/// Reads the loudest channel of an audio file, and the force channel (counted from 0) if one is
/// named.
///
/// The force channel never counts as the loudest. A constant offset that stands out of the noise is
/// subtracted, and files of more than 120 s are cut there. A note says which of the two was done.
///
/// # Errors
/// [`FitError`] if the file cannot be read, is no audio, is empty, lacks the channel, or holds
/// samples that are not finite or one value throughout.
pub fn read(path: &Path, force_channel: Option<usize>) -> Result<Recording, FitError> {
    read_up_to(path, force_channel, LONGEST_S)
}

/// Reads a file as [`read`] does, but up to a length of `longest_s` seconds.
///
/// # Errors
/// Those of [`read`].
pub fn read_up_to(path: &Path, force_channel: Option<usize>, longest_s: f64) -> Result<Recording, FitError> {
    let Decoded { interleaved, channels, rate_hz, mut notes } = decode(path, longest_s)?;
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
    let offset_of =
        |channel| constant_offset(of(channel).map(f64::from), interleaved.len() / channels, f64::from(rate_hz));
    let offsets: Vec<f64> = (0..channels).map(offset_of).collect();
    let energy = |channel: usize| of(channel).map(|x| (f64::from(x) - offsets[channel]).powi(2)).sum::<f64>();
    let taken = (0..channels)
        .filter(|channel| Some(*channel) != force_channel)
        .map(|channel| (channel, energy(channel)))
        .reduce(|best, next| if next.1 > best.1 { next } else { best })
        .ok_or_else(|| FitError::NoMicrophone { path: path.to_owned() })?
        .0;
    let [low, high] = of(taken).map(f64::from).fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(x), high.max(x)]);
    let is_silent = low.abs().max(high.abs()) < LEAST_SOUND;
    if high - low < LEAST_SOUND && !is_silent {
        return Err(FitError::Constant { path: path.to_owned(), channel: taken, value: 0.5 * (low + high) });
    }
    if channels > 1 + usize::from(force_channel.is_some()) {
        notes.push(Note::Channel { taken, channels });
    }
    let has_offset = |channel: &usize| offsets[*channel] != 0.0;
    let used = [Some(taken), force_channel].into_iter().flatten().filter(has_offset);
    notes.extend(used.map(|channel| Note::Offset { channel, offset: offsets[channel] }));
    let factor = rate_hz.div_ceil(HIGHEST_RATE_HZ) as usize;
    let new_rate_hz = f64::from(rate_hz) / factor as f64;
    if factor > 1 {
        notes.push(Note::Decimated { from_hz: f64::from(rate_hz), to_hz: new_rate_hz });
    }
    // A decimated sound has no flat tops any more: they are looked for in the file's samples.
    let raw: Vec<f64> = of(taken).map(f64::from).collect();
    let flat_tops = flat_tops(&raw).into_iter().map(|top| top.start / factor..top.end.div_ceil(factor)).collect();
    let channel = |index| decimate(&of(index).collect::<Vec<f32>>(), offsets[index], factor);
    Ok(Recording {
        samples: channel(taken),
        offset: offsets[taken],
        force: force_channel.map(channel),
        flat_tops,
        rate_hz: new_rate_hz,
        notes,
    })
}

fn decode(path: &Path, longest_s: f64) -> Result<Decoded, FitError> {
    let file = File::open(path).map_err(|cause| FitError::Read { path: path.to_owned(), cause })?;
    if file.metadata().is_ok_and(|metadata| metadata.len() == 0) {
        return Err(FitError::Empty { path: path.to_owned() });
    }
    let not_audio = |cause: &'static str| FitError::NotAudio { path: path.to_owned(), cause };
    let stream = MediaSourceStream::new(Box::new(file), Default::default());
    let mut hint = Hint::new();
    if let Some(extension) = path.extension().and_then(|extension| extension.to_str()) {
        hint.with_extension(extension);
    }
    let mut format = symphonia::default::get_probe()
        .probe(&hint, stream, FormatOptions::default(), MetadataOptions::default())
        .map_err(|_| not_audio("its format is unknown"))?;
    let track = format.default_track(TrackType::Audio).ok_or_else(|| not_audio("it has no audio track"))?;
    let track_id = track.id;
    let parameters = track
        .codec_params
        .as_ref()
        .and_then(|parameters| parameters.audio())
        .ok_or_else(|| not_audio("its track has no audio codec"))?;
    let mut decoder = symphonia::default::get_codecs()
        .make_audio_decoder(parameters, &AudioDecoderOptions::default())
        .map_err(|_| not_audio("its codec is unknown"))?;
    let mut decoded = Decoded { interleaved: Vec::new(), channels: 0, rate_hz: 0, notes: Vec::new() };
    let mut packet_samples: Vec<f32> = Vec::new();
    loop {
        let packet = match format.next_packet() {
            Ok(Some(packet)) => packet,
            Ok(None) => break,
            Err(Error::IoError(error)) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
                decoded.notes.push(Note::Cut { cause: "it ends in the middle of its data" });
                break;
            }
            Err(_) => {
                decoded.notes.push(Note::Cut { cause: "a part of it cannot be read" });
                break;
            }
        };
        if packet.track_id != track_id {
            continue;
        }
        let buffer = match decoder.decode(&packet) {
            Ok(buffer) => buffer,
            Err(_) => {
                decoded.notes.push(Note::Cut { cause: "a part of it cannot be decoded" });
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
            decoded.notes.push(Note::Cut { cause: "its channels or its rate change" });
            break;
        }
        buffer.copy_to_vec_interleaved(&mut packet_samples);
        decoded.interleaved.extend_from_slice(&packet_samples);
        let most = (longest_s * f64::from(rate_hz)) as usize * channels;
        if decoded.interleaved.len() > most {
            decoded.interleaved.truncate(most);
            decoded.notes.push(Note::Truncated { seconds: longest_s });
            break;
        }
    }
    Ok(decoded)
}
