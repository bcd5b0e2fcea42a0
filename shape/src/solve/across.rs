//! Expansion of a sheet across its width: as many terms as the error that is asked for needs.

use std::f64::consts::TAU;

use super::{Body, SolveError, Wanted};
use crate::eigen;
use crate::element::{Elasticity, PlaneState, Support};
use crate::file::Kind;
use crate::mesh::Mesh;

/// Largest number of terms.
const MOST_TERMS: usize = 8;
/// Share of the error that is asked for that the expansion may have.
const SHARE: f64 = 0.2;
/// Order of the elements of trials.
const ORDER: usize = 3;
/// Least share of a change that the next term leaves, and the largest one that is believed.
const RATES: [f64; 2] = [0.2, 0.75];
/// Error of plane stress where waves bend a flat bar: this number times (ν k b)², with the wave
/// number k and the width b. Bars in the tests of `shape` named `sheets` reach 0.024.
const NARROW_ERROR: f64 = 0.03;
/// Error of plane stress from clamped edges, as they hold the strain across the sheet, too: this
/// number times ν² times the width, times the length of the edges by the area. It is 0.125 for a
/// sheet 0.03 times as wide as long.
const CLAMPED_ERROR: f64 = 0.13;
/// Share of the error that is asked for below which a sheet less wide than a wave by 2π is in plane
/// stress without a trial.
const NARROW_SHARE: f64 = 0.05;
/// Largest number of modes by which terms are chosen.
const MOST_MODES: usize = 128;
/// Least number of unknowns in plane stress for each mode.
const LEAST_UNKNOWNS: usize = 8;
/// Largest number of unknowns of a trial.
const MOST_UNKNOWNS: usize = 60_000;
/// Distance of frequencies on coarse and fine meshes, as a share of them.
const COARSE: f64 = 0.02;
/// Ratio of trial meshes' edges.
const FINER: f64 = 0.7;
/// Poisson's ratio across the grain that tells how much this number, which the file does not have,
/// changes.
const OTHER_AROUND: f64 = 0.0;

/// Expansion of a sheet across its width.
#[derive(Clone, Debug, Default)]
pub(super) struct Across {
    /// Number of terms; 0 is plane stress.
    pub(super) terms: usize,
    /// Poisson's ratio across the grain of wood, if it is not that in the plane.
    pub(super) around: Option<f64>,
    /// True if the width is not small beside all waves.
    pub(super) is_wide: bool,
    /// Frequencies in Hz, the lowest first, and the errors up to them, as shares of the frequency.
    errors: Vec<[f64; 2]>,
}

impl Across {
    /// Error of the expansion at a frequency in Hz, as a share of it. Beyond the modes that were
    /// tried it grows as that of plane stress does.
    pub(super) fn error(&self, frequency_hz: f64) -> f64 {
        let below = self.errors.partition_point(|[hz, _]| *hz < frequency_hz * (1.0 - COARSE));
        // Meshes of trials are coarse: the mode may be the next one there.
        let near = self.errors.iter().skip(below).take_while(|[hz, _]| *hz < frequency_hz * (1.0 + COARSE)).last();
        let Some([hz, error]) = near.or(self.errors.get(below)).or(self.errors.last()).copied() else { return 0.0 };
        error * (frequency_hz / hz).powi(2).max(1.0)
    }
}

impl Body {
    /// The body with as many terms across its width, where it is a sheet with free faces, as
    /// leave the expansion a share of the error.
    ///
    /// Trials on a coarse mesh have one term after the other. Changes fall from term to term by
    /// about the same rate r, so that the sum of all changes to come is the last one times
    /// r/(1 - r).
    pub(super) fn expanded(mut self, wanted: Wanted, error: f64) -> Result<Self, SolveError> {
        if self.kind != Kind::Sheet || self.plane != PlaneState::Stress {
            return Ok(self);
        }
        let turn = TAU / self.wavelength(wanted) * self.thickness;
        let (poisson, is_wood) = match self.material.elasticity {
            Elasticity::Isotropic { poisson, .. } => (poisson, false),
            Elasticity::Orthotropic { poisson, .. } => (poisson, true),
        };
        let square = poisson * poisson;
        let narrow = NARROW_ERROR * square * turn * turn;
        let of_edge = |support: &Support| if *support == Support::Clamped { CLAMPED_ERROR * square } else { 0.0 };
        let edges = self.edge_error(of_edge);
        if turn < 1.0 && narrow <= NARROW_SHARE * error && narrow + edges <= SHARE * error {
            self.across.errors = vec![[f64::MAX, narrow + edges]];
            return Ok(self);
        }
        self.across.is_wide = true;
        let trial = Trial::of(&self, wanted)?;
        let mut frequencies_hz = trial.frequencies_hz(&self)?;
        let mut before: Vec<f64> = Vec::new();
        let mut errors: Vec<f64>;
        let is_enough = |errors: &[f64]| errors.iter().all(|&left| left <= SHARE * error);
        loop {
            self.across.terms += 1;
            let next_hz = trial.frequencies_hz(&self)?;
            let changes = changes(&frequencies_hz, &next_hz);
            if self.across.terms == 1 && is_enough(&changes) {
                self.across.terms = 0;
                errors = changes;
                break;
            }
            frequencies_hz = next_hz;
            let left = |(mode, change): (usize, &f64)| {
                let last = before.get(mode).copied().unwrap_or(*change).max(f64::MIN_POSITIVE);
                let rate = (change / last).clamp(RATES[0], RATES[1]);
                change * rate / (1.0 - rate)
            };
            errors = changes.iter().enumerate().map(left).collect();
            let terms = self.across.terms;
            if is_enough(&errors) || terms >= MOST_TERMS || trial.unknowns(terms + 1) > MOST_UNKNOWNS {
                break;
            }
            before = changes;
        }
        if is_wood && self.across.terms > 0 {
            self.across.around = Some(OTHER_AROUND);
            let changes = changes(&frequencies_hz, &trial.frequencies_hz(&self)?);
            errors.iter_mut().zip(changes).for_each(|(error, change)| *error += change);
            self.across.around = None;
        }
        self.across.errors = frequencies_hz.iter().zip(errors).map(|(&hz, error)| [hz, error]).collect();
        Ok(self)
    }
}

/// Coarse mesh, and the number of modes by which terms are chosen.
struct Trial {
    mesh: Mesh,
    count: usize,
    /// Number of unknowns in plane stress.
    unknowns: usize,
}

impl Trial {
    fn of(body: &Body, wanted: Wanted) -> Result<Self, SolveError> {
        let few = |count: usize| Self::with(body, Wanted::Lowest(count.clamp(1, MOST_MODES)));
        match wanted {
            Wanted::Lowest(count) => few(count),
            Wanted::Below(frequency_hz) => {
                let trial = Self::with(body, wanted)?;
                let discrete = body.sheet(&trial.mesh, ORDER)?;
                let below = eigen::count_below(&discrete.problem, (TAU * frequency_hz / body.units.rad_per_s).powi(2))?;
                // One more, which may come below the limit.
                let count = below.saturating_sub(discrete.rigid) + 1;
                if count > MOST_MODES { few(count) } else { Ok(Self { count, ..trial }) }
            }
        }
    }

    fn with(body: &Body, wanted: Wanted) -> Result<Self, SolveError> {
        let count = if let Wanted::Lowest(count) = wanted { count } else { 1 };
        let [mut size, _] = body.first_sizes().map(|size| size * body.wavelength(wanted));
        loop {
            let mesh = body.mesh(size)?;
            let unknowns = body.sheet(&mesh, ORDER)?.problem.size;
            if unknowns >= LEAST_UNKNOWNS * count {
                return Ok(Self { mesh, count, unknowns });
            }
            size *= FINER;
        }
    }

    /// Number of unknowns with a number of terms.
    fn unknowns(&self, terms: usize) -> usize {
        self.unknowns / 2 * (2 + 3 * terms)
    }

    /// Frequencies of the lowest elastic modes with the terms that the body has, Hz.
    fn frequencies_hz(&self, body: &Body) -> Result<Vec<f64>, SolveError> {
        let discrete = body.sheet(&self.mesh, ORDER)?;
        let wanted = eigen::Wanted::Lowest(discrete.rigid + self.count);
        let found = eigen::modes(&discrete.problem, wanted, None)?;
        let unit_hz = body.units.rad_per_s / TAU;
        Ok(found.values.iter().skip(discrete.rigid).map(|value| unit_hz * value.max(0.0).sqrt()).collect())
    }
}

/// Largest change of the frequencies up to each one, as a share of it.
fn changes(frequencies_hz: &[f64], next_hz: &[f64]) -> Vec<f64> {
    let change = |(hz, next): (&f64, &f64)| (hz / next - 1.0).abs();
    let largest = |largest: &mut f64, change: f64| {
        *largest = largest.max(change);
        Some(*largest)
    };
    frequencies_hz.iter().zip(next_hz).map(change).scan(0.0, largest).collect()
}
