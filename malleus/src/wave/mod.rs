//! WAV files: forces in, 24-bit stereo out.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use dsp_core::SampleRate;
use dsp_core::fixed::q27_from;
use hound::{SampleFormat, WavReader};
use kit::file::FileError;

/// A WAV file that cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum WaveError {
    /// The file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is not a WAV file of a kind that is read here, or it is damaged.
    #[error("{}: not a readable WAV file: {cause}; integer PCM of 8 to 32 bits or 32-bit float is", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        cause: hound::Error,
    },
    /// The file has no such channel.
    #[error("{}: channel {channel}: it has {channels} (counted from 0)", path.display())]
    Channel {
        /// The file.
        path: PathBuf,
        /// The channel asked for.
        channel: u16,
        /// How many it has.
        channels: u16,
    },
    /// The file has no samples.
    #[error("{}: no samples: a force needs at least one", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A sample is not a number, or beyond the force bus.
    #[error("{}: sample {index} = {value}: must be from -16 to 16 (full scale is 1.0)", path.display())]
    Sample {
        /// The file.
        path: PathBuf,
        /// Which sample of the channel, from 0.
        index: usize,
        /// Its value.
        value: f32,
    },
    /// The sound does not fit a WAV file.
    #[error("{}: {frames} frames do not fit a WAV file (4 GiB); play less at once", path.display())]
    TooLong {
        /// The file.
        path: PathBuf,
        /// How many there are.
        frames: usize,
    },
    /// The file's rate is none that the engine plays.
    #[error("{}: sample rate {rate_hz} Hz: must be from 8000 to 192000", path.display())]
    Rate {
        /// The file.
        path: PathBuf,
        /// Its rate.
        rate_hz: u32,
    },
}

/// A force from a WAV file.
#[derive(Clone, Debug)]
pub struct Force {
    /// The file's sample rate.
    pub rate: SampleRate,
    /// The force, Q4.27: full scale = 1.0 = the object's reference force.
    pub samples: Vec<i32>,
}

/// Reads one channel (counted from 0) of a WAV file as a force.
///
/// # Errors
/// A [`WaveError`] that names the file and what is wrong.
pub fn read_force(path: &Path, channel: u16) -> Result<Force, WaveError> {
    let bytes = kit::file::read_whole(path)?;
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

/// Writes 24-bit stereo samples as a WAV file, whole or not at all. The header's rate is a whole number of Hz, the nearest.
///
/// The header is the plain one of 44 bytes (format 1, PCM): crates write 24 bits as "extensible", which simple readers refuse, Python's
/// `wave` before 3.12 among them.
///
/// # Errors
/// A [`WaveError`] that names the file.
pub fn write_stereo(path: &Path, rate: SampleRate, frames: &[[i32; 2]]) -> Result<(), WaveError> {
    const BYTES_PER_FRAME: u32 = 6;
    let data_bytes = u32::try_from(frames.len())
        .ok()
        .and_then(|frames| frames.checked_mul(BYTES_PER_FRAME))
        .filter(|bytes| *bytes < u32::MAX - 44)
        .ok_or_else(|| WaveError::TooLong { path: path.to_owned(), frames: frames.len() })?;
    let rate_hz = rate.hz().round() as u32;
    let mut bytes = Vec::with_capacity(data_bytes as usize + 44);
    bytes.extend_from_slice(b"RIFF");
    bytes.extend_from_slice(&(data_bytes + 36).to_le_bytes());
    bytes.extend_from_slice(b"WAVEfmt ");
    bytes.extend_from_slice(&16u32.to_le_bytes());
    for word in [1u16, 2] {
        bytes.extend_from_slice(&word.to_le_bytes()); // PCM, two channels
    }
    for word in [rate_hz, rate_hz * BYTES_PER_FRAME] {
        bytes.extend_from_slice(&word.to_le_bytes());
    }
    for word in [BYTES_PER_FRAME as u16, 24] {
        bytes.extend_from_slice(&word.to_le_bytes()); // bytes a frame, bits a sample
    }
    bytes.extend_from_slice(b"data");
    bytes.extend_from_slice(&data_bytes.to_le_bytes());
    for sample in frames.iter().flatten() {
        bytes.extend(sample.to_le_bytes().into_iter().take(3));
    }
    Ok(kit::file::write_whole(path, &bytes)?)
}

/// Writes a mono sound as 32-bit float, full scale 1, whole or not at all.
///
/// # Errors
/// A [`WaveError`] that names the file.
pub fn write_mono(path: &Path, rate_hz: f64, samples: &[f64]) -> Result<(), WaveError> {
    let kind = |cause| WaveError::Kind { path: path.to_owned(), cause };
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: rate_hz.round() as u32,
        bits_per_sample: 32,
        sample_format: SampleFormat::Float,
    };
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut bytes, spec).map_err(kind)?;
    for &sample in samples {
        writer.write_sample(sample as f32).map_err(kind)?;
    }
    writer.finalize().map_err(kind)?;
    Ok(kit::file::write_whole(path, bytes.get_ref())?)
}
