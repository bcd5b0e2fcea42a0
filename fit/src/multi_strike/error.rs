//! Reasons for which strikes are not fitted together.

use kit::counting::counted;

use super::layout::Layout;

/// Least number of strikes that are fitted together.
pub(crate) const LEAST_STRIKES: usize = 2;
/// Least number of strikes of each striker.
const LEAST_OF_STRIKER: usize = 2;
/// Number of rises of the sound from which on too few strikes are not for want of strikes.
const MANY_RISES: usize = 5;
/// Maximum number of strikes a second, in the mean of a recording.
const MOST_PER_S: f64 = 9.0;

/// Reason for which the strikes of a recording cannot be fitted together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StrikesError {
    /// The recording is too short.
    #[error("the recording lasts {seconds:.3} s: strikes are fitted together in at least 0.2 s; give a longer one")]
    TooShort {
        /// Length of the recording in seconds.
        seconds: f64,
    },
    /// There are too few strikes.
    #[error(
        "{} heard, and at least 2 are fitted together: give a recording with more, or leave out --events",
        counted(*found, "strikes")
    )]
    TooFew {
        /// Number of strikes that are heard.
        found: usize,
    },
    /// There are too few strikes for the layout that was asked for.
    #[error(
        "{} heard, and --positions {positions} with --strikers {strikers} needs at least {needed}: give a recording with more strikes, or smaller numbers",
        counted(*found, "strikes")
    )]
    TooFewForLayout {
        /// Number of strikes that are heard.
        found: usize,
        /// Least number of strikes that tell the layout.
        needed: usize,
        /// Number of positions that was asked for.
        positions: usize,
        /// Number of strikers that was asked for.
        strikers: usize,
    },
    /// There are more strikes than can be told apart.
    #[error(
        "{found} strikes are heard in {seconds:.1} s: at most 9 a second are told apart, and beating modes, speech or noise are taken for more; give a drier recording of one thing that is struck less often, or leave out --events"
    )]
    TooMany {
        /// Number of strikes that are heard.
        found: usize,
        /// Length of the recording in seconds.
        seconds: f64,
    },
    /// Other sounds hide the strikes.
    #[error(
        "the sound rises {rises} times, and {found} of the rises are strikes of a thing that rings: speech, noise or other things sound between the strikes, or the thing beats; give a recording of one thing alone, or leave out --events"
    )]
    Unclear {
        /// Number of strikes that are heard.
        found: usize,
        /// Number of rises of the sound.
        rises: usize,
    },
    /// No mode rings between the strikes.
    #[error("no mode rings between the strikes: give a recording of a thing that rings, with gaps of at least 40 ms")]
    NoModes,
    /// One thing and its strikes explain too little.
    #[error(
        "one thing, struck at one place, leaves {left_db:.1} dB of the recording: a strong room, several things or other sounds are in it; give a drier recording of one thing, or leave out --events"
    )]
    Unexplained {
        /// Energy that is left, in dB of that of the recording.
        left_db: f64,
    },
    /// Two modes or strikes cannot be told apart.
    #[error(
        "two modes or strikes cannot be told apart: give a recording of one thing, with less noise or longer gaps, or ask for fewer modes (--modes)"
    )]
    Untold,
}

impl StrikesError {
    /// Refuses a recording in which too few strikes are heard; so often its sound rises.
    pub(super) fn refuse_few(found: usize, rises: usize) -> Result<(), Self> {
        match found {
            LEAST_STRIKES.. => Ok(()),
            _ if rises > MANY_RISES => Err(Self::Unclear { found, rises }),
            _ => Err(Self::TooFew { found }),
        }
    }

    /// Refuses fewer strikes than tell the gains along the object and the law of each striker.
    ///
    /// For P > 1 positions P + 1 strikes are needed: P strikes can be explained by any P gains.
    /// Each striker needs two strikes, for its contact time and its exponent.
    pub(super) fn refuse_few_for(layout: Layout, found: usize) -> Result<(), Self> {
        let Layout { positions, strikers } = layout;
        let for_positions = if positions > 1 { positions + 1 } else { LEAST_STRIKES };
        let needed = for_positions.max(LEAST_OF_STRIKER * strikers);
        if found >= needed { Ok(()) } else { Err(Self::TooFewForLayout { found, needed, positions, strikers }) }
    }

    /// Refuses more strikes in a time than can be told apart.
    pub(super) fn refuse_too_many(found: usize, seconds: f64) -> Result<(), Self> {
        if found as f64 > MOST_PER_S * seconds { Err(Self::TooMany { found, seconds }) } else { Ok(()) }
    }

    /// Refuses a fit that leaves more than a share of a recording's energy.
    pub(super) fn refuse_unexplained(residual: &[f64], samples: &[f64], most: f64) -> Result<(), Self> {
        let energy = |sound: &[f64]| sound.iter().map(|x| x * x).sum::<f64>();
        let left = energy(residual) / energy(samples);
        if left > most {
            return Err(Self::Unexplained { left_db: 10.0 * left.log10() });
        }
        Ok(())
    }
}
