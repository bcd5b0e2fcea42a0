//! WAV files: forces in, 24-bit stereo out.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use dsp_core::SampleRate;
use dsp_core::fixed::q27_from;
use hound::{SampleFormat, WavReader, WavSpec, WavWriter};
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
/// # Errors
/// A [`WaveError`] that names the file.
pub fn write_stereo(path: &Path, rate: SampleRate, frames: &[[i32; 2]]) -> Result<(), WaveError> {
    let spec = WavSpec {
        channels: 2,
        sample_rate: rate.hz().round() as u32,
        bits_per_sample: 24,
        sample_format: SampleFormat::Int,
    };
    let kind = |cause| WaveError::Kind { path: path.to_owned(), cause };
    let mut bytes = Cursor::new(Vec::with_capacity(frames.len() * 6 + 80));
    let mut writer = WavWriter::new(&mut bytes, spec).map_err(kind)?;
    for sample in frames.iter().flatten() {
        writer.write_sample(*sample).map_err(kind)?;
    }
    writer.finalize().map_err(kind)?;
    Ok(kit::file::write_whole(path, bytes.get_ref())?)
}
