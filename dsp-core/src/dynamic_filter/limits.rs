//! Limits of the poles, gains and times of a path.

/// Largest real pole, and largest magnitude of a conjugate pole.
pub const MAX_POLE: f64 = 0.9999;
/// Smallest pole of the first order.
///
/// Rounding errors grow with 1/(1 - |p|), and faster near -1 than near 1. So for poles below
/// [`MIN_REAL_POLE`] the damping multiplies all bits of the state.
pub const MIN_POLE: f64 = -0.9999;
/// Smallest real pole of the second order. Eq. 17's low-pass is at 0.48 fs with such a pole.
pub const MIN_REAL_POLE: f64 = -0.9;
/// Largest gain, summed over the impulse response: `(|b0| + |b1|) / (1 - |a1|)` in the first order.
pub const MAX_GAIN: f64 = 4096.0;
/// Latest time of a breakpoint, in seconds after the strike.
pub const MAX_TIME_S: f64 = 3600.0;

/// Limits of the poles and the gain at a sample rate.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// Smallest pole of the first order, and largest pole of either order.
    pub(super) poles: [f64; 2],
    /// Smallest real pole of the second order.
    pub(super) least_real: f64,
    /// Largest gain, summed over the impulse response.
    pub(super) gain: f64,
}

/// Limits of a table at its own rate.
pub(super) const OF_TABLE: Limits = Limits { poles: [MIN_POLE, MAX_POLE], least_real: MIN_REAL_POLE, gain: MAX_GAIN };
/// Limits after the table's coefficients were carried to the engine's rate.
pub(super) const CARRIED: Limits = Limits { poles: [-0.999_999, 0.999_999], least_real: -0.9999, gain: 2.0 * MAX_GAIN };
