//! Moments of the body in each cell: ∫ P_a(x) P_b(y) P_c(z) over the part inside the surface.
//!
//! By Gauss's theorem along the first axis, a moment is a sum over the surface: each triangle gives
//! the integral, over its shadow on the y-z plane, of what lies below it in the cell. Triangles are
//! cut at the faces of the cells, so that all integrands are polynomials.

use super::functions::{MOMENTS, gauss, legendre, legendre_integrals};
use super::{Grid, ORDER};
use crate::surface::{Point, Surface, SurfaceError};

/// Number of moments of a cell.
pub(super) const ALL: usize = MOMENTS * MOMENTS * MOMENTS;
/// Difference of a moment from that of the whole cell up to which the cell is full.
const FULL: f64 = 1e-10;
/// Share of a cell that is filled, below which the cell is empty.
const EMPTY: f64 = 1e-9;
/// Number of points with which a rule on a triangle is exact: the integrand has degree
/// 3 · 2 · ORDER + 1, and the map of a square on a triangle adds one.
const EXACT_POINTS: usize = 3 * ORDER + 2;
/// Number of points on pieces of less than [`SMALL`] of a cell, exact to 1e-15 there.
const FEW_POINTS: usize = 6;
const SMALL: f64 = 0.02;

/// Part of a cell that is inside the body.
#[derive(Clone, Debug)]
pub(super) enum Inside {
    None,
    All,
    /// Moments, those of the third axis first, as shares of the cell's volume.
    Part(Box<[f64; ALL]>),
}

/// Computes the moments of all cells.
pub(super) fn of(surface: &Surface, grid: &Grid) -> Result<Vec<Inside>, SurfaceError> {
    let mut sums = Sums {
        grid,
        moments: vec![None; grid.count()],
        below: vec![None; grid.count()],
        rules: [gauss(FEW_POINTS), gauss(EXACT_POINTS)],
    };
    let extents = grid.extents_m();
    for corners in surface.corners() {
        // The grid ends where the body ends: rounding must not leave a face outside of it.
        let within = |point: Point| [0, 1, 2].map(|axis| point[axis].clamp(0.0, extents[axis]));
        sums.add(&corners.map(|corner| within(grid.local(corner))));
    }
    sums.finish()
}

struct Sums<'a> {
    grid: &'a Grid,
    /// Sums of pieces in each cell.
    moments: Vec<Option<Box<[f64; ALL]>>>,
    /// Sums, of pieces in each cell, for whole cells below it along the first axis.
    below: Vec<Option<Box<[f64; MOMENTS * MOMENTS]>>>,
    /// Gauss's rules for small pieces and for others.
    rules: [Vec<[f64; 2]>; 2],
}

impl Sums<'_> {
    /// Adds a triangle, placed along the axes of the grid.
    fn add(&mut self, corners: &[Point; 3]) {
        let [a, b, c] = corners;
        let shadow = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
        if shadow == 0.0 {
            return;
        }
        for y in self.layers(corners, 1) {
            let strip = cut(corners, 1, self.grid.layer(1, y));
            for z in self.layers(&strip, 2) {
                let pillar = cut(&strip, 2, self.grid.layer(2, z));
                for x in self.layers(&pillar, 0) {
                    let piece = cut(&pillar, 0, self.grid.layer(0, x));
                    self.add_piece(&piece, [x, y, z], shadow.signum());
                }
            }
        }
    }

    /// Layers of cells that points span along an axis.
    fn layers(&self, points: &[Point], axis: usize) -> std::ops::Range<usize> {
        if points.is_empty() {
            return 0..0;
        }
        let low = points.iter().map(|point| point[axis]).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|point| point[axis]).fold(f64::NEG_INFINITY, f64::max);
        self.grid.layer_of(axis, low)..self.grid.layer_of(axis, high) + 1
    }

    fn add_piece(&mut self, piece: &[Point], cell: [usize; 3], sign: f64) {
        let Some((first, rest)) = piece.split_first() else { return };
        let number = self.grid.number(cell);
        let layers = [0, 1, 2].map(|axis| self.grid.layer(axis, cell[axis]));
        let share = |at: f64, [low, high]: [f64; 2]| (at - low) / (high - low);
        let place = |point: Point| [0, 1, 2].map(|axis| share(point[axis], layers[axis]));
        let mut moments = self.moments[number].take().unwrap_or_else(|| Box::new([0.0; ALL]));
        let mut below = self.below[number].take().unwrap_or_else(|| Box::new([0.0; MOMENTS * MOMENTS]));
        for pair in rest.windows(2) {
            let corners = [*first, pair[0], pair[1]].map(place);
            add_triangle(&mut moments, &mut below, corners, sign, &self.rules);
        }
        self.moments[number] = Some(moments);
        self.below[number] = Some(below);
    }

    fn finish(mut self) -> Result<Vec<Inside>, SurfaceError> {
        let mut result = vec![Inside::None; self.grid.count()];
        let [length, width, height] = self.grid.counts();
        for column in 0..width * height {
            // Cells below a piece are whole under its shadow.
            let mut above = [0.0; MOMENTS * MOMENTS];
            for x in (0..length).rev() {
                let number = column * length + x;
                let mut moments = self.moments[number].take().unwrap_or_else(|| Box::new([0.0; ALL]));
                moments.iter_mut().zip(&above).for_each(|(moment, whole)| *moment += whole);
                let crossing = || SurfaceError::Crossing(self.grid.corner(self.grid.place(number)));
                result[number] = judge(moments).ok_or_else(crossing)?;
                if let Some(below) = &self.below[number] {
                    above.iter_mut().zip(below.iter()).for_each(|(whole, part)| *whole += part);
                }
            }
        }
        Ok(result)
    }
}

/// Says what part of a cell its moments tell; `None` if they are no body's.
fn judge(moments: Box<[f64; ALL]>) -> Option<Inside> {
    let share = moments[0];
    if !(-1e-6..=1.0 + 1e-6).contains(&share) {
        return None;
    }
    if moments[1..].iter().chain(&[share - 1.0]).all(|moment| moment.abs() < FULL) {
        return Some(Inside::All);
    }
    Some(if share < EMPTY { Inside::None } else { Inside::Part(moments) })
}

/// Adds what a triangle in a cell gives, in the cell's coordinates of 0 to 1.
fn add_triangle(
    moments: &mut [f64; ALL],
    below: &mut [f64; MOMENTS * MOMENTS],
    [a, b, c]: [Point; 3],
    sign: f64,
    rules: &[Vec<[f64; 2]>; 2],
) {
    let area = sign * ((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])).abs();
    let size = (0..3).map(|axis| (b[axis] - a[axis]).abs().max((c[axis] - a[axis]).abs())).fold(0.0, f64::max);
    // Moments that contradict each other make a stiffness that is not positive: integrals are
    // exact, on small pieces to rounding.
    let rule = &rules[usize::from(size >= SMALL)];
    for &[along, first] in rule {
        for &[across, second] in rule {
            // A square is mapped on the triangle: one of its edges becomes the corner a.
            let [share_b, share_c] = [along * (1.0 - across), along * across];
            let weight = area * first * second * along;
            let [x, y, z] = [0, 1, 2].map(|axis| {
                let place = a[axis] + share_b * (b[axis] - a[axis]) + share_c * (c[axis] - a[axis]);
                place.clamp(0.0, 1.0)
            });
            let (x, y, z) = (legendre_integrals(x), legendre::<MOMENTS>(y), legendre::<MOMENTS>(z));
            let mut flat = [0.0; MOMENTS * MOMENTS];
            for (row, y) in flat.chunks_exact_mut(MOMENTS).zip(y) {
                row.iter_mut().zip(z).for_each(|(entry, z)| *entry = weight * y * z);
            }
            below.iter_mut().zip(flat).for_each(|(sum, part)| *sum += part);
            for (plane, x) in moments.chunks_exact_mut(MOMENTS * MOMENTS).zip(x) {
                plane.iter_mut().zip(flat).for_each(|(sum, part)| *sum += x * part);
            }
        }
    }
}

/// Cuts a convex polygon to a layer of cells: what lies between two places along an axis.
fn cut(polygon: &[Point], axis: usize, [low, high]: [f64; 2]) -> Vec<Point> {
    let upper = half(polygon, |point| point[axis] - low);
    half(&upper, |point| high - point[axis])
}

/// Cuts a convex polygon to the points at which a linear function is not negative.
fn half(polygon: &[Point], height: impl Fn(&Point) -> f64) -> Vec<Point> {
    let mut result = Vec::with_capacity(polygon.len() + 1);
    for (index, point) in polygon.iter().enumerate() {
        let next = &polygon[(index + 1) % polygon.len()];
        let [here, there] = [height(point), height(next)];
        if here >= 0.0 {
            result.push(*point);
        }
        if here * there < 0.0 {
            let share = here / (here - there);
            result.push([0, 1, 2].map(|axis| point[axis] + share * (next[axis] - point[axis])));
        }
    }
    result
}
