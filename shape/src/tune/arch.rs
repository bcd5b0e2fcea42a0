//! Bar with an arch in its lower side.

use super::{FIRST_DEPTH, TuneError, Wish};
use crate::file::{Edge, Kind, ShapeFile};
use crate::outline::Point;

/// Share of the length that the arch takes.
const SPAN: f64 = 0.82;
/// Number of straight sides that draw the arch.
pub(super) const SIDES: usize = 48;
/// Number of straight sides that draw it where the terms for a wide bar are chosen.
pub(super) const FEW_SIDES: usize = 16;
/// Least thickness that is left, as a share of the height.
const LEAST: f64 = 0.08;
/// Unit of the polygon's coordinates, metres.
const UNIT_M: f64 = 1e-7;

/// Bar whose lower side has an arch: at a share s of the way from its middle to its end (-1 to 1)
/// it is (1 - s²)² (a + 6.75 b s²) times the height deep. The largest value of s² (1 - s²)² is
/// 1/6.75.
#[derive(Clone, Debug)]
pub(super) struct Bar {
    /// Lower left and upper right corner, metres.
    corners: [Point; 2],
    /// Depths a and b, as shares of the height.
    depths: [f64; 2],
    /// Number of depths that change; the length changes after them.
    free: usize,
    /// Length, as a share of that in the file.
    stretch: f64,
}

impl Bar {
    /// Bar of a file, with a first arch.
    pub(super) fn of(file: &ShapeFile, wish: &Wish) -> Result<Self, TuneError> {
        if file.shape.kind != Kind::Sheet {
            return Err(TuneError::NoBar("shape.kind must be \"sheet\": the bar seen from its side"));
        }
        if !file.shape.holes_m.is_empty() {
            return Err(TuneError::NoBar("shape.holes_m must be missing: the undercut is that of a whole bar"));
        }
        if file.support.edges.is_some() || file.support.edge.is_some_and(|edge| edge != Edge::Free) {
            return Err(TuneError::NoBar("the bar must be free: leave [support] out"));
        }
        let no_rectangle = TuneError::NoBar("shape.polygon_m must be a rectangle along x, longer than high");
        let Some(polygon) = &file.shape.polygon_m else { return Err(no_rectangle) };
        let range = |axis: usize| {
            let values = polygon.iter().map(|corner| corner[axis]);
            [values.clone().fold(f64::MAX, f64::min), values.fold(f64::MIN, f64::max)]
        };
        let [[left, right], [low, high]] = [range(0), range(1)];
        let is_corner = |corner: &Point| [left, right].contains(&corner[0]) && [low, high].contains(&corner[1]);
        let is_upright = |pair: [&Point; 2]| (pair[0][0] == pair[1][0]) != (pair[0][1] == pair[1][1]);
        let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
        let is_rectangle = polygon.len() == 4
            && polygon.iter().all(is_corner)
            && sides.into_iter().all(|(from, to)| is_upright([from, to]));
        if !is_rectangle || high - low >= right - left {
            return Err(no_rectangle);
        }
        let free = wish.ratios.len() - 1;
        Ok(Self { corners: [[left, low], [right, high]], depths: [FIRST_DEPTH, 0.0], free, stretch: 1.0 })
    }

    /// Bar with one of its numbers changed: a depth by a share of the height, or the logarithm of
    /// the length.
    pub(super) fn changed(&self, number: usize, change: f64) -> Self {
        let mut bar = self.clone();
        match bar.depths.get_mut(..self.free).and_then(|depths| depths.get_mut(number)) {
            Some(depth) => *depth += change,
            None => bar.stretch *= change.exp(),
        }
        bar
    }

    pub(super) fn height_m(&self) -> f64 {
        self.corners[1][1] - self.corners[0][1]
    }

    pub(super) fn length_m(&self) -> f64 {
        self.stretch * (self.corners[1][0] - self.corners[0][0])
    }

    /// Horizontal place after the change of length: the left end stays.
    pub(super) fn stretched(&self, x: f64) -> f64 {
        let left = self.corners[0][0];
        left + self.stretch * (x - left)
    }

    /// Factor of the length.
    pub(super) fn stretch(&self) -> f64 {
        self.stretch
    }

    /// Depth at a share of the way from the middle to the arch's end, as a share of the height.
    fn depth(&self, share: f64) -> f64 {
        let square = share * share;
        (1.0 - square).powi(2) * (self.depths[0] + 6.75 * self.depths[1] * square)
    }

    fn shares(sides: usize) -> impl Iterator<Item = f64> {
        (0..=sides).map(move |side| 2.0 * side as f64 / sides as f64 - 1.0)
    }

    pub(super) fn thinnest_m(&self) -> f64 {
        self.height_m() * (1.0 - Self::shares(SIDES).map(|share| self.depth(share)).fold(0.0, f64::max))
    }

    /// True if the arch takes wood away everywhere, and leaves some.
    pub(super) fn can_be_cut(&self) -> bool {
        Self::shares(SIDES).all(|share| (-1e-9..=1.0 - LEAST).contains(&self.depth(share)))
            && self.length_m() > self.height_m()
    }

    /// Outline counter-clockwise from the lower left corner, metres, with a number of sides along
    /// the arch.
    pub(super) fn polygon(&self, sides: usize) -> Vec<Point> {
        let [[left, low], [_, high]] = self.corners;
        let (length, height) = (self.length_m(), self.height_m());
        let on_arch = |share: f64| [left + length / 2.0 * (1.0 + SPAN * share), low + height * self.depth(share)];
        let mut points = vec![[left, low]];
        points.extend(Self::shares(sides).map(on_arch));
        points.extend([[left + length, low], [left + length, high], [left, high]]);
        points.into_iter().map(|point| point.map(|x| (x / UNIT_M).round() * UNIT_M)).collect()
    }

    /// The file with the outline of the bar.
    pub(super) fn cut(&self, file: &ShapeFile, sides: usize) -> ShapeFile {
        let mut cut = file.clone();
        cut.shape.polygon_m = Some(self.polygon(sides));
        cut
    }
}
