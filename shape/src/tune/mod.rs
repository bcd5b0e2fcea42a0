//! Undercut of a bar: the arch in its lower side that tunes its first modes, as makers of marimbas
//! and xylophones cut it.
//!
//! The bar is a sheet seen from its side. The arch has one number for each ratio, and the length is
//! cut to a pitch if one is asked for. Newton steps on the logarithms of the frequencies find these
//! numbers; each frequency is that of the tuned outline by finite elements.
//!
//! Steps are made in plane stress, whose frequencies get the factors that the width of the bar has
//! in elasticity in space. These are found anew for each arch at which the steps end, until they
//! move it no further.

mod arch;
mod bending;
mod error;
mod text;

use faer::linalg::solvers::Solve;

use crate::file::ShapeFile;

use arch::{Bar, FEW_SIDES, SIDES};
use bending::Width;
pub use error::TuneError;

/// Largest number of ratios, that of the fundamental included.
const MOST_RATIOS: usize = 3;
/// Ratio beyond which no bending mode of a bar lies.
const HIGHEST_RATIO: f64 = 30.0;
/// Fundamentals that a bar can be cut to, Hz.
const FUNDAMENTALS_HZ: std::ops::RangeInclusive<f64> = 10.0..=20_000.0;
/// Largest number of Newton steps.
const STEPS: usize = 25;
/// Distance of a ratio from the one that is asked for at which the search ends, in logarithms.
const TOLERANCE: f64 = 5e-5;
/// Step by which slopes are measured, in shares of the height and in the logarithm of the length.
const PROBE: f64 = 0.01;
/// Distance below which slopes of the step before are near enough.
const NEAR: f64 = 0.01;
/// Distance after new factors of the width below which those of the arch that it leads to are the
/// same within the tolerance: factors change by less than a fiftieth of the frequencies.
const SETTLED: f64 = 0.002;
/// Largest change of a number of the arch in one step.
const LONGEST_STEP: f64 = 0.12;
/// Number of halvings of a step that leads nowhere.
const HALVINGS: usize = 6;
/// Depth at which the search begins, as a share of the height.
const FIRST_DEPTH: f64 = 0.3;

/// Sound that a bar shall have.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// Frequencies of the first bending modes as multiples of the lowest, that one (1) included.
    pub ratios: Vec<f64>,
    /// Frequency of the lowest mode, Hz; the bar keeps its length if there is none.
    pub fundamental_hz: Option<f64>,
}

/// Tuned bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// Text of its shape file: that of the bar with the polygon of the arch.
    pub text: String,
    /// Frequencies of the bending modes that the ratios name, Hz.
    pub frequencies_hz: Vec<f64>,
    /// Thickness where it is least, metres.
    pub thinnest_m: f64,
    /// Length, metres.
    pub length_m: f64,
    /// Number of Newton steps.
    pub steps: usize,
}

impl Wish {
    fn check(&self) -> Result<(), TuneError> {
        let is_rising = self.ratios.windows(2).all(|pair| pair[0] < pair[1]);
        let is_right = (2..=MOST_RATIOS).contains(&self.ratios.len())
            && self.ratios.first() == Some(&1.0)
            && self.ratios.iter().all(|&ratio| ratio <= HIGHEST_RATIO)
            && is_rising;
        if !is_right {
            return Err(TuneError::Ratios { most: HIGHEST_RATIO });
        }
        match self.fundamental_hz {
            Some(hz) if !FUNDAMENTALS_HZ.contains(&hz) => Err(TuneError::Fundamental(hz)),
            _ => Ok(()),
        }
    }

    /// Distances of the frequencies from those that are asked for, in logarithms.
    fn distances(&self, frequencies_hz: &[f64]) -> Vec<f64> {
        let lowest = frequencies_hz.first().copied().unwrap_or(1.0);
        let of_ratio = |(hz, ratio): (&f64, &f64)| (hz / lowest / ratio).ln();
        let mut all: Vec<f64> = frequencies_hz.iter().zip(&self.ratios).skip(1).map(of_ratio).collect();
        all.extend(self.fundamental_hz.map(|hz| (lowest / hz).ln()));
        all
    }
}

/// Finds the undercut of the bar in a shape file's text. `tell` gets the share of the way in
/// percent.
///
/// # Errors
/// A [`TuneError`] that says what no arch can do, or why the file is no bar.
pub fn undercut(text: &str, wish: &Wish, tell: &mut dyn FnMut(usize)) -> Result<Tuned, TuneError> {
    wish.check()?;
    let file = ShapeFile::parse(text)?;
    let mut bar = Bar::of(&file, wish)?;
    let count = wish.ratios.len();
    let mut width = Width::first(&bar.cut(&file, FEW_SIDES), count)?;
    let heard = |bar: &Bar, width: &Width| {
        let plain_hz = bending::frequencies_hz(&bar.cut(&file, SIDES), count)?;
        Ok::<Vec<f64>, TuneError>(plain_hz.iter().zip(&width.factors).map(|(hz, factor)| hz * factor).collect())
    };
    let mut frequencies_hz = heard(&bar, &width)?;
    let mut distances = wish.distances(&frequencies_hz);
    let start = worst(&distances);
    let mut slopes = Vec::new();
    let mut is_settled = false;
    let mut told = 0;
    for steps in 0..STEPS {
        let mut left = worst(&distances);
        let share = 100.0 * (start / left).ln() / (start / TOLERANCE).ln();
        told = told.max(share.clamp(0.0, 99.0) as usize);
        tell(told);
        if left <= TOLERANCE && !is_settled {
            width = width.of(&bar.cut(&file, SIDES), count)?;
            frequencies_hz = heard(&bar, &width)?;
            distances = wish.distances(&frequencies_hz);
            left = worst(&distances);
            is_settled = left <= SETTLED;
        }
        if left <= TOLERANCE {
            let text = text::with(text, &file, &bar)?;
            return Ok(Tuned { text, frequencies_hz, thinnest_m: bar.thinnest_m(), length_m: bar.length_m(), steps });
        }
        if left > NEAR {
            slopes.clear();
        }
        for number in slopes.len()..distances.len() {
            let probed = wish.distances(&heard(&bar.changed(number, PROBE), &width)?);
            slopes.push(probed.iter().zip(&distances).map(|(new, old)| (new - old) / PROBE).collect::<Vec<f64>>());
        }
        let whole = newton(&slopes, &distances);
        let Some((next, new_hz, new_distances)) = step(&bar, &whole, left, wish, &|bar| heard(bar, &width))? else {
            break;
        };
        (bar, frequencies_hz, distances) = (next, new_hz, new_distances);
    }
    let lowest = frequencies_hz.first().copied().unwrap_or(1.0);
    let reached = frequencies_hz.iter().map(|hz| hz / lowest).collect();
    Err(TuneError::OutOfReach { asked: wish.ratios.clone(), reached, thinnest: bar.thinnest_m() / bar.height_m() })
}

/// Bar with its frequencies in Hz and their distances.
type Heard = (Bar, Vec<f64>, Vec<f64>);

/// Bar after a Newton step, halved until the bar can be cut and is nearer; `None` if no step is.
fn step(
    bar: &Bar,
    whole: &[f64],
    left: f64,
    wish: &Wish,
    heard: &dyn Fn(&Bar) -> Result<Vec<f64>, TuneError>,
) -> Result<Option<Heard>, TuneError> {
    let longest = whole.iter().fold(0.0_f64, |longest, change| longest.max(change.abs()));
    let mut share = (LONGEST_STEP / longest.max(f64::MIN_POSITIVE)).min(1.0);
    for _ in 0..HALVINGS {
        let next =
            whole.iter().enumerate().fold(bar.clone(), |bar, (number, change)| bar.changed(number, share * change));
        if next.can_be_cut() {
            let frequencies_hz = heard(&next)?;
            let distances = wish.distances(&frequencies_hz);
            if worst(&distances) < left {
                return Ok(Some((next, frequencies_hz, distances)));
            }
        }
        share /= 2.0;
    }
    Ok(None)
}

/// Changes that bring the distances to 0 where the slopes hold; `slopes` by number, then distance.
fn newton(slopes: &[Vec<f64>], distances: &[f64]) -> Vec<f64> {
    let count = distances.len();
    let slope =
        |row: usize, column: usize| slopes.get(column).and_then(|slopes| slopes.get(row)).copied().unwrap_or(0.0);
    let matrix = faer::Mat::from_fn(count, count, slope);
    let right = faer::Mat::from_fn(count, 1, |row, _| -distances.get(row).copied().unwrap_or(0.0));
    let solution = matrix.partial_piv_lu().solve(&right);
    (0..count).map(|row| if solution[(row, 0)].is_finite() { solution[(row, 0)] } else { 0.0 }).collect()
}

fn worst(distances: &[f64]) -> f64 {
    distances.iter().fold(0.0, |worst: f64, distance| worst.max(distance.abs()))
}
