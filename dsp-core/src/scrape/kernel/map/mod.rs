//! Readings of a map: for slow contacts that go straight, and for all others.

#[cfg(cortex_m4f)]
mod cortex_m4;
#[cfg(not(cortex_m4f))]
mod portable;

use super::super::ramp::Ramp;
use crate::table::layout::CURVATURES;

#[cfg(cortex_m4f)]
pub(in super::super) use cortex_m4::{read_cells, read_map};
#[cfg(not(cortex_m4f))]
pub(in super::super) use portable::{read_cells, read_map};

/// Weights of a map's curvatures over a tick, Q30: c², c s and s² in the direction (c, s).
pub(in super::super) type Directions = [Ramp; CURVATURES];

/// Result of [`read_map`] and [`read_cells`] on a map whose curvature is 1 everywhere. The weights
/// of a cubic spline sum to 6 along one axis, and so to 36 along both.
pub(in super::super) const MAP_ONE: i32 = 36 << 9;

/// Begin of a column's sum in [`read_map`]: 2 for the shift by 2 bits, and 4 for what the products
/// lose, on average 2 in an axis's direction and 6 in others. Left out, it would be a slope of the
/// surface, and pile up in that of the path.
const MAP_ROUNDING: i32 = 6;

/// Fraction bits of the weights of [`read_cells`].
pub(in super::super) const WEIGHT_BITS: u32 = 24;
/// Bits of the sums over a map's weights that the terms of a column do without.
const TERMS_BITS: u32 = 5;

/// First values of the sums over a cell's weights, in its outer rows and in its inner rows. They
/// add what rounding towards minus infinity takes away; without them the path's slope would
/// drift.
///
/// A product loses half a unit on average, or nothing if its weight is 0. The constant term takes
/// each outer row once and each inner row 23 times, and its shift loses 15.5 units more. That is
/// 40 units in the direction of an axis, 88 in others. Values here give certain sums only: of
/// these, 46 and 94 came nearest to the reference.
const fn cell_rounding([_, mixed, _]: [i32; CURVATURES]) -> [i32; 2] {
    if mixed == 0 { [0, 1] } else { [1, 2] }
}
