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

/// Value that [`read_map`] and [`read_cells`] give for a curvature of 1 unit: 36 for the splines of
/// both directions.
pub(in super::super) const MAP_ONE: i32 = 36 << 9;

/// Begin of a column's sum in [`read_map`]: 2 for the shift by 2 bits, and 4 for what the products
/// lose, on average 2 in an axis's direction and 6 in others. Left out, it would be a slope of the
/// surface, and pile up in that of the path.
const MAP_ROUNDING: i32 = 6;

/// Fraction bits of the weights of [`read_cells`].
pub(in super::super) const WEIGHT_BITS: u32 = 24;
/// Bits of the sums over a map's weights that the terms of a column do without.
const TERMS_BITS: u32 = 5;

/// Begins of the sums over the weights of a cell in its outer and its inner rows, which make up for
/// what the products and a column's term of 1 lose. Left out, it would pile up in the path's slope.
///
/// A product loses half on average, unless its weight is 0. The term of 1, in which an outer row
/// counts once and an inner row 23 times, loses 15.5 on top: in all 40 or 88. A few more, 46 or 94,
/// came nearest to the reference.
const fn cell_rounding([_, mixed, _]: [i32; CURVATURES]) -> [i32; 2] {
    if mixed == 0 { [0, 1] } else { [1, 2] }
}
