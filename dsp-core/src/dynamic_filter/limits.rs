//! Between what a path's poles, gains and times lie.

/// The largest real pole, and the largest magnitude of a conjugate one.
pub const MAX_POLE: f64 = 0.9999;
/// The smallest pole of the first order. What rounding leaves grows with 1/(1 - |p|), and faster at
/// this end, so that below [`MIN_REAL_POLE`] it takes all bits of its state.
pub const MIN_POLE: f64 = -0.9999;
/// The smallest real pole of the second order. Eq. 17's low-pass is at 0.48 fs there.
pub const MIN_REAL_POLE: f64 = -0.9;
/// The largest gain, summed over the impulse response: `(|b0| + |b1|) / (1 - |a1|)` in the first
/// order.
pub const MAX_GAIN: f64 = 4096.0;
/// The longest path.
pub const MAX_TIME_S: f64 = 3600.0;

/// Ranges of a table at its own rate, and at another.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    pub(super) poles: [f64; 2],
    /// Of the second order.
    pub(super) least_real: f64,
    pub(super) gain: f64,
}

pub(super) const OF_TABLE: Limits = Limits { poles: [MIN_POLE, MAX_POLE], least_real: MIN_REAL_POLE, gain: MAX_GAIN };
pub(super) const CARRIED: Limits = Limits { poles: [-0.999_999, 0.999_999], least_real: -0.9999, gain: 2.0 * MAX_GAIN };
