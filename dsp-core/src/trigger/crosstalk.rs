//! Crosstalk: a blow on one pad shakes its neighbours.

/// Whether a peak may be no more than what the others' peaks of the last 20 ms or so cause: all of them may shake a pad at once, so
/// their sum counts, times the pad's `ratio`.
pub(super) fn explains(peak: i32, elsewhere: impl Iterator<Item = i32>, ratio: f32) -> bool {
    let sum = elsewhere.fold(0i32, i32::saturating_add);
    (peak as f32) < sum as f32 * ratio
}
