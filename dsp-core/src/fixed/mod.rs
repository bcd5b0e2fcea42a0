//! Fixed-point arithmetic: the operations of the Cortex-M4, portable and exact.
//!
//! Formats are named after their fraction. Q27 is an `i32` whose 1.0 is 2^27: the bus between
//! stages is Q4.27, with 1.0 = 0 dBFS. Q32 is an `i32` whose 1.0 would be 2^32, so that it spans
//! -0.5 to 0.5. A Q32 coefficient multiplies by taking the high word of a 64-bit product, which the
//! Cortex-M4 does in one cycle (`smmulr` and its kin).
//!
//! No arithmetic here depends on the build: every machine gives the same bits.

mod format;
mod high_word;
mod power;
mod saturating;
mod scale;

pub use format::{FULL_SCALE_24_BIT, ONE_Q27, q27_from};
pub use high_word::{rounding_shift_right, smmla, smmlar, smmls, smmlsr, smmul, smmulr, times_q31};
pub use power::{Log2, Power, power};
pub use saturating::{qadd, qsub, saturate, saturating_shift_left, sum_of_magnitudes, to_24_bit};
pub use scale::Scale;
