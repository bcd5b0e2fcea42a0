//! Places on a solid: of strikes, and of what is heard.

use super::SolveError;
use crate::file::{Readout, ShapeFile};
use crate::gain::{self, Gain};
use crate::solid::{Cells, Grid};
use crate::surface::{Foot, Point, Surface, dot, unit};

/// Distance from the surface up to which a place is on it, as a share of the longest extent: that
/// of a round body from its triangles.
const NEAR: f64 = 0.01;

/// Places on a solid.
#[derive(Clone, Debug)]
pub(super) struct SolidPlaces {
    /// Places of strikes and their directions, into or out of the body alike.
    strikes: Vec<(Point, Point)>,
    /// Place and direction of the velocity that is heard; `None` for the even readout.
    heard: Option<(Point, Point)>,
}

impl SolidPlaces {
    /// Places of a file. With a thickness `top_m`, a place with two coordinates is on the top.
    pub(super) fn of(file: &ShapeFile, surface: &Surface, top_m: Option<f64>) -> Result<Self, SolveError> {
        let direction = |given: &Option<Vec<f64>>| {
            given.as_ref().map(|parts| unit([0, 1, 2].map(|axis| parts.get(axis).copied().unwrap_or(0.0))))
        };
        let count = file.strike.positions.unwrap_or(super::places::POSITIONS);
        let given = direction(&file.strike.direction);
        let strikes = match &file.strike.path_m {
            None => default_strikes(surface, count, given),
            Some(path) => {
                let on_top = path.iter().all(|point| point.len() == 2);
                let corners = path.iter().map(|point| to_space("strike.path_m", point, top_m));
                let corners = corners.collect::<Result<Vec<Point>, _>>()?;
                let places = super::places::along(&corners, count);
                let strike = |at| place("strike.path_m", surface, at, given.or(on_top.then_some([0.0, 0.0, 1.0])));
                places.into_iter().map(strike).collect::<Result<_, _>>()?
            }
        };
        let heard = match (file.sound.readout, &file.sound.at_m) {
            (Readout::Pressure, _) => return Err(SolveError::NoPressure),
            (Readout::Velocity, Some(at_m)) => {
                let up = (at_m.len() == 2).then_some([0.0, 0.0, 1.0]);
                let at = to_space("sound.at_m", at_m, top_m)?;
                Some(place("sound.at_m", surface, at, direction(&file.sound.direction).or(up))?)
            }
            _ => None,
        };
        Ok(Self { strikes, heard })
    }

    /// Places of strikes in the order of the positions, metres.
    pub(super) fn struck(&self) -> impl Iterator<Item = Point> {
        self.strikes.iter().map(|strike| strike.0)
    }

    /// Point of the body that is heard, metres; `None` for other readouts.
    pub(super) fn heard_point(&self) -> Option<Point> {
        self.heard.map(|heard| heard.0)
    }

    /// Gains of a mode at all positions; ω in rad/s, d in 1/s.
    pub(super) fn gains(
        &self,
        cells: &Cells,
        vector: &[f64],
        omega: f64,
        decay_per_s: f64,
    ) -> Result<Vec<Gain>, SolveError> {
        let shape = |key: &'static str, (at, direction): (Point, Point)| {
            let value = cells.value(vector, at).ok_or(SolveError::OffSurface { key, at })?;
            Ok::<f64, SolveError>(dot(value, direction))
        };
        let strikes = self.strikes.iter().map(|&strike| shape("strike.path_m", strike));
        let strikes = strikes.collect::<Result<Vec<f64>, _>>()?;
        Ok(match self.heard {
            None => strikes.into_iter().map(gain::even).collect(),
            Some(heard) => {
                let heard = shape("sound.at_m", heard)?;
                strikes.into_iter().map(|strike| gain::velocity(strike, heard, omega, decay_per_s)).collect()
            }
        })
    }
}

/// Point in space of the numbers of a file.
fn to_space(key: &'static str, numbers: &[f64], top_m: Option<f64>) -> Result<Point, SolveError> {
    match (numbers, top_m) {
        (&[x, y, z], _) => Ok([x, y, z]),
        (&[x, y], Some(top)) => Ok([x, y, top]),
        _ => Err(SolveError::Coordinates { key }),
    }
}

/// Place on the surface next to a point, with the direction given or its normal.
fn place(
    key: &'static str,
    surface: &Surface,
    at: Point,
    direction: Option<Point>,
) -> Result<(Point, Point), SolveError> {
    let [low, high] = surface.bounds();
    let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let foot = surface.nearest(at).filter(|foot| foot.distance_m <= NEAR * longest);
    let foot = foot.ok_or(SolveError::OffSurface { key, at })?;
    Ok((foot.at_m, direction.unwrap_or(foot.normal)))
}

/// Strikes on the broadest side, from above the middle along the longest axis to the rim.
fn default_strikes(surface: &Surface, count: usize, direction: Option<Point>) -> Vec<(Point, Point)> {
    let grid = Grid::over(surface, f64::INFINITY);
    let extents = grid.extents_m();
    let order = |ascending: bool| {
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a: &usize, &b: &usize| extents[a].total_cmp(&extents[b]));
        if ascending { axes[0] } else { axes[2] }
    };
    let (up, along) = (grid.axes[order(true)], grid.axes[order(false)]);
    let (middle, _) = surface.second_moments();
    let point = |far: f64| [0, 1, 2].map(|axis| middle[axis] + far * along[axis]);
    // The rim is where the line through the middle leaves the body, or the end of what lies below.
    let reach = extents[order(false)] / 2.0;
    let foot = |far: f64| surface.last_exit(point(far), up).or_else(|| surface.nearest(point(far)));
    let places = (0..count).filter_map(|index| {
        let share = if count > 1 { index as f64 / (count - 1) as f64 } else { 0.0 };
        foot(super::places::NEAR_RIM * reach * share)
    });
    places.map(|Foot { at_m, normal, .. }| (at_m, direction.unwrap_or(normal))).collect()
}
