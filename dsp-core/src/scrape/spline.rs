//! Cubic B-spline between the points of a table, in fixed point.
//!
//! The table holds the spline's coefficients, from which the loss of the spline's own response,
//! sinc(f)^4, has been taken out: its values are those of the surface up to the table's finest
//! waves. Images lie 24 dB lower at a third of a wave a point, and 56 dB at a sixth.

use crate::fixed;

/// Value of the spline times [`ONE`] for a coefficient of 1 everywhere.
pub(super) const ONE: i32 = 6 << SHIFT;
/// Shift of the coefficients, which leaves room for the sums: 12·2^15·2^11 < 2^30.
const SHIFT: u32 = 11;

/// Value of the spline at a fraction of a point behind the second of four coefficients.
///
/// `fraction` is Q31, 0 to below 1. The result is at most 2^15 · [`ONE`] in size.
#[inline(always)]
pub(super) fn value(c: [i32; 4], fraction: i32) -> i32 {
    let [a, b, c, d] = c;
    let outer = a + c;
    // Each step of a product's high word halves the sum.
    let constant = (outer + 4 * b) << (SHIFT - 3);
    let linear = (3 * (c - a)) << (SHIFT - 2);
    let square = (3 * (outer - 2 * b)) << (SHIFT - 1);
    let cube = (d - a + 3 * (b - c)) << SHIFT;
    let sum = fixed::smmlar(square, cube, fraction);
    let sum = fixed::smmlar(linear, sum, fraction);
    fixed::smmlar(constant, sum, fraction) << 3
}
