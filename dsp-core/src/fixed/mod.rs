//! Fixed-point arithmetic: the operations of the Cortex-M4, portable and exact.
//!
//! Formats are named after their fraction: Q27 is an `i32` whose 1.0 is 2^27 (the bus between stages: Q4.27, 1.0 = 0 dBFS); a Q32
//! coefficient is an `i32` whose 1.0 would be 2^32, so that it spans -0.5 to 0.5 and multiplies by taking the high word of a
//! 64-bit product, which the Cortex-M4 does in one cycle (`smmulr` and its like).
//!
//! Everything here is `const`, has no branch that depends on the build, and gives the same bits on every machine.

mod high_word;
mod power;
mod saturating;
mod scale;

pub use high_word::{rounding_shift_right, smmla, smmlar, smmls, smmlsr, smmul, smmulr, times_q31};
pub use power::{Log2, Power};
pub use saturating::{qadd, qsub, saturate, saturating_shift_left, to_24_bit};
pub use scale::Scale;

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
