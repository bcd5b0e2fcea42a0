//! Refusals of a separation.

/// Reason why recordings cannot be separated.
///
/// Its message says what is wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SeparateError {
    /// Only one pair of thing and striker is recorded, and neither is known.
    #[error(
        "all recordings are of one thing and one striker, so that nothing tells their modes apart: record one of them with another partner too, or give the table of one"
    )]
    OnePair,
    /// Several pairs of thing and striker are recorded, no part with two partners, and none is
    /// known.
    #[error(
        "every thing is struck by one striker alone, and every striker strikes one thing alone, so that nothing tells their modes apart: record one of them with another partner too, or give the table of one"
    )]
    DisjointPairs,
    /// A recording has another sample rate than the first.
    #[error("recording {clip} has {rate_hz} Hz, and the first one {first_hz} Hz: convert them to one rate")]
    Rates {
        /// Index of the recording, from 0.
        clip: usize,
        /// Its sample rate in Hz.
        rate_hz: f64,
        /// Sample rate of the first recording in Hz.
        first_hz: f64,
    },
    /// A recording is silent or too short.
    #[error("recording {clip} holds no blow: no stretch of 12 ms follows a rise of the sound; leave it out")]
    NoBlow {
        /// Index of the recording, from 0.
        clip: usize,
    },
    /// There are no recordings.
    #[error("there is nothing to separate: give recordings")]
    Nothing,
    /// The modes cannot be solved for.
    #[error("the recordings' modes cannot be told apart: give recordings with less noise, or more of them")]
    Unsolved,
}
