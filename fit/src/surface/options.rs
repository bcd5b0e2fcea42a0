//! Choices of a surface's fit, and what it decided without asking.

use std::fmt;

/// Source of a table's heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A new profile with the statistics of the whole surface.
    Statistics,
    /// A section of the profile as measured, from and to in metres; its ends are faded into one
    /// another.
    Section([f64; 2]),
    /// The map as measured; its edges are faded into one another.
    Map,
}

/// Choices of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Factor on all heights.
    pub height_scale: f64,
    /// Number of points of a synthesis, a power of two from 256 to 4096.
    pub points: usize,
    /// Source of the heights.
    pub source: Source,
    /// Shortest wavelength in metres to which the spectrum is continued by its slope.
    pub extend_to_m: Option<f64>,
    /// Radius in metres of a ball whose path is taken in place of the surface.
    pub tip_radius_m: Option<f64>,
    /// Seed of the synthesis.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            height_scale: 1.0,
            points: 4096,
            source: Source::Statistics,
            extend_to_m: None,
            tip_radius_m: None,
            seed: 1,
        }
    }
}

/// Decision that was made without asking.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// Points were missing, and were filled from their neighbours.
    Filled {
        /// Share of all points in percent.
        percent: f64,
    },
    /// Positions were uneven, and the profile was resampled.
    Resampled {
        /// Step in metres.
        step_m: f64,
    },
    /// Heights look as if they were in another unit than metres.
    Scale {
        /// Rms of the heights in metres, without waves longer than 2.8 mm.
        rms_m: f64,
        /// Power of 1000 by which they look too large, or too small if it is below 1.
        wrong_by: f64,
        /// `--height-scale` that would mend it, in place of the one that was given.
        factor: f64,
    },
    /// The first line of a CSV file has names that are not known.
    Head {
        /// The line.
        head: String,
        /// Meaning that its columns have all the same.
        read_as: &'static str,
    },
    /// Nothing was measured below the shortest wavelength.
    Upsampled {
        /// Shortest wavelength in metres.
        shortest_m: f64,
        /// Step of the file in metres.
        step_m: f64,
    },
    /// The spectrum goes on below the shortest measured wavelength.
    Extended {
        /// Measured shortest wavelength in metres.
        from_m: f64,
        /// Shortest wavelength of the table in metres.
        to_m: f64,
        /// Slope of the power spectral density of heights over frequency.
        slope: f64,
    },
    /// Long waves were taken off, so that 16-bit heights hold the short ones.
    LongWaves {
        /// Longest wave in metres that is kept.
        longest_m: f64,
    },
    /// A map was read as a bundle of profiles.
    Rows {
        /// Number of profiles.
        rows: usize,
        /// True if they are the map's columns, since its rows are too short.
        is_turned: bool,
    },
}

impl Note {
    /// True for [`Note::Scale`].
    pub(super) fn is_scale(&self) -> bool {
        matches!(self, Self::Scale { .. })
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Filled { percent } => {
                write!(f, "{percent:.1} % of the points were missing, and are filled from their neighbours")
            }
            Self::Resampled { step_m } => write!(f, "positions are uneven: resampled to steps of {step_m:.3e} m"),
            Self::Scale { rms_m, wrong_by, factor } => write!(
                f,
                "heights of {rms_m:.1e} m rms look wrong by a factor of {wrong_by:e}: if so, give --height-scale {factor:e}"
            ),
            Self::Head { head, read_as } => {
                write!(f, "the head {head:?} is not known: {read_as}, in metres")
            }
            Self::Upsampled { shortest_m, step_m } => write!(
                f,
                "nothing was measured below waves of {:.1} µm though points are {:.2} µm apart: what lies below is left out",
                1e6 * shortest_m,
                1e6 * step_m
            ),
            Self::Extended { from_m, to_m, slope } => write!(
                f,
                "waves from {:.1} to {:.1} µm are not measured: the spectrum goes on with its slope of {slope:.1}",
                1e6 * from_m,
                1e6 * to_m
            ),
            Self::LongWaves { longest_m } => write!(
                f,
                "waves longer than {:.2} mm are left out: beside them 16-bit heights would be too coarse for the short ones",
                1e3 * longest_m
            ),
            Self::Rows { rows, is_turned } => {
                let (lines, why) = if *is_turned { ("columns", ", since its rows are short") } else { ("rows", "") };
                write!(f, "the map's {rows} {lines} are read as profiles{why}; --map keeps the map itself")
            }
        }
    }
}
