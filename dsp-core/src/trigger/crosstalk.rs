//! Crosstalk: a strike on one pad shakes its neighbours.

/// True if a peak is below `ratio` times the sum of the other pads' peaks of the last 20 ms or so.
///
/// The sum counts because all pads may shake one at once.
pub(super) fn explains(peak: i32, elsewhere: impl Iterator<Item = i32>, ratio: f32) -> bool {
    let sum = elsewhere.fold(0i32, i32::saturating_add);
    (peak as f32) < sum as f32 * ratio
}
