//! Why a recording cannot be fitted.

use std::path::PathBuf;

/// Why a recording cannot be fitted: what, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// The file cannot be opened or read.
    #[error("{}: cannot be read: {cause}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// The file is no audio file that is known here.
    #[error("{}: not audio that can be decoded ({cause}): give WAV, FLAC, AIFF, Ogg Vorbis, MP3, AAC, ALAC or CAF", path.display())]
    NotAudio {
        /// The file.
        path: PathBuf,
        /// What the decoder says.
        cause: String,
    },
    /// There are no samples.
    #[error("{}: holds no samples", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A channel that is not there.
    #[error("{}: has no channel {channel}: it has {channels}, counted from 0", path.display())]
    Channel {
        /// The file.
        path: PathBuf,
        /// The channel asked for.
        channel: usize,
        /// How many there are.
        channels: usize,
    },
    /// The only channel is the force: nothing to hear.
    #[error("{}: its only channel is the force: a microphone's is needed beside it", path.display())]
    NoMicrophone {
        /// The file.
        path: PathBuf,
    },
    /// A sample rate that cannot be.
    #[error("{}: sample rate {rate_hz} Hz: must be from 4000 to 768000", path.display())]
    Rate {
        /// The file.
        path: PathBuf,
        /// Its rate.
        rate_hz: u32,
    },
    /// Samples that are no numbers.
    #[error("{}: sample {index} is not a finite number", path.display())]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// Which sample.
        index: usize,
    },
    /// Nothing but silence.
    #[error("silence: no sample exceeds -120 dBFS")]
    Silence,
    /// Nothing rises and decays.
    #[error(
        "no strike: nothing rises by 12 dB above what was before it and dies away; give a recording with a strike and its decay"
    )]
    NoOnset,
    /// The strike is cut off at full scale.
    #[error(
        "clipped: {percent:.0} % of the samples of the strike at {at_s:.3} s stand at its largest value; record it at a lower level"
    )]
    Clipped {
        /// Time of the strike in seconds.
        at_s: f64,
        /// Share of samples.
        percent: f64,
    },
    /// A hit that is not there.
    #[error("no hit {hit}: the recording has {found}, counted from 1")]
    NoSuchHit {
        /// The hit asked for.
        hit: usize,
        /// How many there are.
        found: usize,
    },
    /// What is left of a strike is too short.
    #[error(
        "the strike at {at_s:.3} s is over after {length_ms:.1} ms (end of the file or the next strike): at least 15 ms are needed"
    )]
    TooShort {
        /// Time of the strike in seconds.
        at_s: f64,
        /// How long it is.
        length_ms: f64,
    },
    /// No mode stands out of the noise.
    #[error("no mode stands out of the noise after the strike at {at_s:.3} s")]
    NoModes {
        /// Time of the strike in seconds.
        at_s: f64,
    },
    /// The force channel shows no strike.
    #[error("channel {channel} shows no force pulse that rises 20 dB above its noise: is it the force?")]
    NoForce {
        /// The channel.
        channel: usize,
    },
    /// The bins estimator knows no force.
    #[error(
        "the bins estimator reads modes off the sound alone: leave the force channel out, or use the modal estimator"
    )]
    BinsWithForce,
    /// The table that was fitted is none that a board plays.
    #[error("the fitted table is refused: {0}")]
    Table(#[from] kit::KitError),
    /// The instrument refuses the table.
    #[error("the fitted table cannot be rendered: {0}")]
    Render(String),
}
