//! Reasons for which a recording is not fitted by descent.

/// Reason for which a recording cannot be fitted by descent.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DescentError {
    /// The recording is too short or too long.
    #[error(
        "the recording lasts {seconds:.2} s: the descent fits clips of {shortest} to {longest} s; cut out a part, or leave out --estimator"
    )]
    Length {
        /// Length of the recording in seconds.
        seconds: f64,
        /// Shortest length in seconds.
        shortest: f64,
        /// Longest length in seconds.
        longest: f64,
    },
    /// The recording is silent.
    #[error("the recording is silent: give one in which something is struck")]
    Silent,
    /// No step leads to a sound.
    #[error(
        "the descent leads to no sound: give a recording that begins before its first strike, or leave out --estimator"
    )]
    Lost,
}
