//! Errors of a fit.

use std::path::PathBuf;

/// Reason why a recording cannot be fitted. Its message says what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// The file cannot be opened or read.
    #[error("{}: the file cannot be read ({cause}): check its path and permissions", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        cause: std::io::Error,
    },
    /// The file is no audio file of a known format.
    #[error("{}: not audio that can be decoded ({cause}): give WAV, FLAC, AIFF, Ogg Vorbis, MP3, AAC, ALAC or CAF", path.display())]
    NotAudio {
        /// Path of the file.
        path: PathBuf,
        /// Part of the file that is unknown or missing.
        cause: &'static str,
    },
    /// The file holds no samples.
    #[error("{}: the file holds no samples: give a recording of a strike", path.display())]
    Empty {
        /// Path of the file.
        path: PathBuf,
    },
    /// The channel asked for does not exist.
    #[error("{}: there is no channel {channel}: the file has {channels}, counted from 0; name one of them", path.display())]
    Channel {
        /// Path of the file.
        path: PathBuf,
        /// Index of the channel asked for.
        channel: usize,
        /// Number of channels in the file.
        channels: usize,
    },
    /// The only channel is the force, so that there is no sound.
    #[error("{}: its only channel is the force: give a recording with a microphone's channel too", path.display())]
    NoMicrophone {
        /// Path of the file.
        path: PathBuf,
    },
    /// The sample rate is out of range.
    #[error("{}: the sample rate is {rate_hz} Hz: give a recording at 8000 to 768000 Hz", path.display())]
    Rate {
        /// Path of the file.
        path: PathBuf,
        /// Sample rate of the file in Hz.
        rate_hz: u32,
    },
    /// A sample is not finite.
    #[error("{}: sample {index} is not a finite number: export the recording anew", path.display())]
    NotFinite {
        /// Path of the file.
        path: PathBuf,
        /// Index of the sample.
        index: usize,
    },
    /// The recording is silent.
    #[error("the recording is silent, no sample exceeds -120 dBFS: record it at a higher level")]
    Silence,
    /// The recording holds one value throughout.
    #[error(
        "{}: channel {channel} holds the constant value {value:.2e} of full scale and no sound: check the microphone and \
         its input, and record anew",
        path.display()
    )]
    Constant {
        /// Path of the file.
        path: PathBuf,
        /// Index of the channel, the loudest one, from 0.
        channel: usize,
        /// The value, full scale 1.
        value: f64,
    },
    /// No part of the recording rises and decays.
    #[error(
        "there is no strike: nothing rises by 12 dB above the sound before it and dies away; give a recording with a strike and its decay"
    )]
    NoOnset,
    /// A strike is clipped.
    #[error(
        "clipped: {percent:.1} % of the samples in the loudest part of the strike at {at_s:.3} s stand still at its largest \
         value; record it at a lower level, or choose other strikes with --hits"
    )]
    Clipped {
        /// Time of the strike in seconds.
        at_s: f64,
        /// Share of clipped samples in percent, of 20 ms from the strike or its first flat top on.
        percent: f64,
    },
    /// The hit asked for does not exist.
    #[error("there is no hit {hit}: the recording has {found}, counted from 1; name one of them")]
    NoSuchHit {
        /// Number of the hit asked for, from 1.
        hit: usize,
        /// Number of hits in the recording.
        found: usize,
    },
    /// A strike is too short.
    #[error(
        "the strike at {at_s:.3} s ends after {length_ms:.1} ms, at the end of the file or the next strike: choose one of at least 15 ms"
    )]
    TooShort {
        /// Time of the strike in seconds.
        at_s: f64,
        /// Length of the strike in milliseconds.
        length_ms: f64,
    },
    /// No mode stands out of the noise.
    #[error(
        "no mode stands out of the noise after the strike at {at_s:.3} s: give a recording with less noise or a longer decay"
    )]
    NoModes {
        /// Time of the strike in seconds.
        at_s: f64,
    },
    /// The force channel shows no strike.
    #[error(
        "channel {channel} shows no force pulse that rises 20 dB above its noise: name the channel of the force, or leave it out"
    )]
    NoForce {
        /// Index of the force channel.
        channel: usize,
    },
    /// The bins estimator cannot use a force channel.
    #[error(
        "the bins estimator reads modes off the sound alone: leave the force channel out, or use the modal estimator"
    )]
    BinsWithForce,
    /// The fitted table is invalid.
    #[error("the fitted table is refused: {0}")]
    Table(#[from] kit::KitError),
    /// The instrument or the reference refuses the table.
    #[error("the fitted table cannot be rendered: {0}")]
    Render(String),
}
