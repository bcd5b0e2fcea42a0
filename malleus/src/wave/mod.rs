//! WAV files: forces are read, and sounds are written as 24-bit stereo or 32-bit float mono.

mod stream;

use std::io::Cursor;
use std::path::{Path, PathBuf};

use dsp_core::SampleRate;
use dsp_core::fixed::q27_from;
use hound::{SampleFormat, WavReader};
use kit::file::FileError;

/// Refusal of a WAV file that is to be read or written.
#[derive(Debug, thiserror::Error)]
pub enum WaveError {
    /// The file cannot be read from disk or written to it.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is not a WAV file, is damaged, or holds samples of another format than is read
    /// here.
    #[error(
        "{}: not a readable WAV file; give a whole WAV file of integer PCM with 8 to 32 bits or of 32-bit float",
        path.display()
    )]
    Kind {
        /// Path of the refused file.
        path: PathBuf,
        /// Error of the WAV decoder, kept for programs; the message leaves it out.
        #[source]
        cause: hound::Error,
    },
    /// The file has fewer channels than the one asked for.
    #[error(
        "{}: there is no channel {channel}; channels are counted from 0, and the file's last one is {}",
        path.display(),
        channels.saturating_sub(1)
    )]
    Channel {
        /// Path of the refused file.
        path: PathBuf,
        /// Channel asked for, counted from 0.
        channel: u16,
        /// Number of channels in the file.
        channels: u16,
    },
    /// The file holds no samples.
    #[error("{}: the file holds no samples; a force needs at least one", path.display())]
    Empty {
        /// Path of the refused file.
        path: PathBuf,
    },
    /// A sample is not a number, or lies beyond the end of the force bus at ±16.
    #[error("{}: sample {index} = {value}: must be from -16 to 16 (full scale is 1.0)", path.display())]
    Sample {
        /// Path of the refused file.
        path: PathBuf,
        /// Index of the sample in its channel, counted from 0.
        index: usize,
        /// Value of the sample, 1.0 = full scale.
        value: f32,
    },
    /// The sound is longer than a WAV file can be.
    #[error("{}: {frames} frames do not fit a WAV file (4 GiB); play less at once", path.display())]
    TooLong {
        /// Path of the file that was to be written.
        path: PathBuf,
        /// Number of frames in the sound.
        frames: usize,
    },
    /// The file's sample rate lies outside the range of the engine.
    #[error(
        "{}: the sample rate is {rate_hz} Hz, and a force is played at the rate of its file, 8000 to 192000 Hz: resample it",
        path.display()
    )]
    Rate {
        /// Path of the refused file.
        path: PathBuf,
        /// Sample rate of the file in Hz.
        rate_hz: u32,
    },
}

/// Force over time, read from one channel of a WAV file.
#[derive(Clone, Debug)]
pub struct Force {
    /// Sample rate of the file.
    pub rate: SampleRate,
    /// Samples of the force in Q4.27; full scale, 1.0, is the object's reference force.
    pub samples: Vec<i32>,
}

/// Reads one channel of a WAV file, counted from 0, as a force.
///
/// A file that was written into a pipe, whose header leaves the length open, is read to its end.
///
/// # Errors
/// [`WaveError`] with the file's path, for a file that is not WAV, and for a channel, sample rate
/// or sample outside its range.
pub fn read_force(path: &Path, channel: u16) -> Result<Force, WaveError> {
    let bytes = stream::with_length(kit::file::read_whole(path)?);
    let kind = |cause| WaveError::Kind { path: path.to_owned(), cause };
    let mut reader = WavReader::new(Cursor::new(bytes)).map_err(kind)?;
    let spec = reader.spec();
    let rate = SampleRate::new(spec.sample_rate, 1)
        .ok_or_else(|| WaveError::Rate { path: path.to_owned(), rate_hz: spec.sample_rate })?;
    if channel >= spec.channels {
        return Err(WaveError::Channel { path: path.to_owned(), channel, channels: spec.channels });
    }
    let (skip, step) = (usize::from(channel), usize::from(spec.channels));
    let samples = match spec.sample_format {
        SampleFormat::Int => {
            let full_scale = 2f64.powi(i32::from(spec.bits_per_sample) - 1);
            let all = reader.samples::<i32>().skip(skip).step_by(step);
            all.map(|sample| Ok(q27_from(f64::from(sample.map_err(kind)?) / full_scale)))
                .collect::<Result<Vec<_>, WaveError>>()?
        }
        SampleFormat::Float => {
            let all = reader.samples::<f32>().skip(skip).step_by(step).enumerate();
            all.map(|(index, sample)| match sample.map_err(kind)? {
                value if (-16.0..=16.0).contains(&value) => Ok(q27_from(f64::from(value))),
                value => Err(WaveError::Sample { path: path.to_owned(), index, value }),
            })
            .collect::<Result<Vec<_>, WaveError>>()?
        }
    };
    if samples.is_empty() {
        return Err(WaveError::Empty { path: path.to_owned() });
    }
    Ok(Force { rate, samples })
}

/// Writes 24-bit stereo samples as a WAV file, whole or not at all.
///
/// # Errors
/// [`WaveError`] with the file's path, if the sound is longer than 4 GiB or cannot be written.
pub fn write_stereo(path: &Path, rate_hz: f64, frames: &[[i32; 2]]) -> Result<(), WaveError> {
    Ok(kit::file::write_whole(path, &stereo_bytes(path, rate_hz, frames)?)?)
}

/// Makes the bytes of a WAV file of 24-bit stereo samples; `path` is named in the error.
///
/// The file says `rate_hz` rounded to whole Hz. Its header is the plain one of 44 bytes (format 1,
/// PCM). Libraries write an "extensible" header for 24 bits, which simple readers refuse, such as
/// Python's `wave` before 3.12.
///
/// # Errors
/// [`WaveError`] with the file's path, if the sound is longer than 4 GiB.
pub fn stereo_bytes(path: &Path, rate_hz: f64, frames: &[[i32; 2]]) -> Result<Vec<u8>, WaveError> {
    const BYTES_PER_FRAME: u32 = 6;
    let data_bytes = u32::try_from(frames.len())
        .ok()
        .and_then(|frames| frames.checked_mul(BYTES_PER_FRAME))
        .filter(|bytes| *bytes < u32::MAX - 44)
        .ok_or_else(|| WaveError::TooLong { path: path.to_owned(), frames: frames.len() })?;
    let rate_hz = rate_hz.round() as u32;
    let mut bytes = Vec::with_capacity(data_bytes as usize + 44);
    bytes.extend_from_slice(b"RIFF");
    bytes.extend_from_slice(&(data_bytes + 36).to_le_bytes());
    bytes.extend_from_slice(b"WAVEfmt ");
    bytes.extend_from_slice(&16u32.to_le_bytes());
    for word in [1u16, 2] {
        bytes.extend_from_slice(&word.to_le_bytes()); // format PCM, two channels
    }
    for word in [rate_hz, rate_hz * BYTES_PER_FRAME] {
        bytes.extend_from_slice(&word.to_le_bytes());
    }
    for word in [BYTES_PER_FRAME as u16, 24] {
        bytes.extend_from_slice(&word.to_le_bytes()); // bytes per frame, bits per sample
    }
    bytes.extend_from_slice(b"data");
    bytes.extend_from_slice(&data_bytes.to_le_bytes());
    for sample in frames.iter().flatten() {
        bytes.extend(sample.to_le_bytes().into_iter().take(3));
    }
    Ok(bytes)
}

/// Writes a mono sound as a WAV file of 32-bit float, full scale 1.0, whole or not at all.
///
/// # Errors
/// [`WaveError`] with the file's path, if the sound is longer than 4 GiB or cannot be written.
pub fn write_mono(path: &Path, rate_hz: f64, samples: &[f64]) -> Result<(), WaveError> {
    Ok(kit::file::write_whole(path, &channels_bytes(path, rate_hz, &[samples])?)?)
}

/// Makes the bytes of a WAV file of 32-bit float with channels of equal length; `path` is named in
/// the error.
///
/// # Errors
/// [`WaveError`] with the file's path, if the sound is longer than 4 GiB.
pub fn channels_bytes(path: &Path, rate_hz: f64, channels: &[&[f64]]) -> Result<Vec<u8>, WaveError> {
    // Into memory, the encoder fails only where the file would be longer than its header can say.
    let frames = channels.first().map_or(0, |channel| channel.len());
    let too_long = |_| WaveError::TooLong { path: path.to_owned(), frames };
    let spec = hound::WavSpec {
        channels: channels.len() as u16,
        sample_rate: rate_hz.round() as u32,
        bits_per_sample: 32,
        sample_format: SampleFormat::Float,
    };
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut bytes, spec).map_err(too_long)?;
    for frame in 0..frames {
        for channel in channels {
            writer.write_sample(channel[frame] as f32).map_err(too_long)?;
        }
    }
    writer.finalize().map_err(too_long)?;
    Ok(bytes.into_inner())
}
