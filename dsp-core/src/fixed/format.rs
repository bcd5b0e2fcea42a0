//! Formats of the bus and of the output.

/// 1.0 on the bus: 0 dBFS, or one `reference_force`, in Q4.27.
pub const ONE_Q27: i32 = 1 << 27;

/// Full scale of the 24-bit output, 2^23.
pub const FULL_SCALE_24_BIT: i32 = 1 << 23;

/// Turns a real number into Q4.27: nearest, saturating at ±16. NaN gives 0.
///
/// Not for the audio path: it is `f64` arithmetic, in software on a Cortex-M4F.
pub fn q27_from(value: f64) -> i32 {
    // `as` saturates and sends NaN to 0.
    libm::rint(value * f64::from(ONE_Q27)) as i32
}
