//! Banded waveguides: feedback loops round the dynamic filter (dynamic-filter eq. 8 to 13, 22 to
//! 24). Each loop has a delay and a narrow band-pass.
//!
//! ```text
//!  noise e ─►(+)─► clip ─► dynamic filter F ─┬─► s
//!             ▲                              │
//!             └───── Σ B_s ◄──── z^-D_s ◄────┘
//! ```
//!
//! All loops read one delay line of s. Noise and loops are summed in the line, where s will be
//! written. If every delay is at least a tick (p in eq. 22 chosen so), the loops work in blocks of
//! a tick. Otherwise they work in blocks of the shortest delay. The fraction of a delay is in the
//! numerator of the band-pass ([`tuning`]), which turns the phase at the band's frequency by it.
//!
//! **Stability.** On load `|F(ω)| Σ |B_s(ω)| < 1` is required all along the path, on a grid that is
//! dense about each band. So the loops decay if the path is frozen at any point. While coefficients
//! move, and for any strikes, the filter clips its input to 2.0. This keeps s within the bound of
//! [`crate::dynamic_filter`], the line's words below 2^30, and each loop within the bound of
//! [`resonance`]. When the path is over, the loops are the frozen ones of its last point and decay.
//!
//! **Silence.** Rounding can keep up to 2^10 steps of the bus for ever. So, after the path's end,
//! the loops are cleared if samples have stayed below 2^[`SILENCE`] for [`STILL_S`] without losing
//! a bit. They are also cleared if samples are below 2^[`NOTHING`] for a longest delay. Thus a
//! filter that ends closed ends its loops.

pub mod error;
pub mod resonance;
pub mod tuning;

mod kernel;
mod loops;

pub use error::LoopError;
pub use resonance::COARSE_BITS;
pub use tuning::Loop;

pub(crate) use loops::Loops;
pub(crate) use tuning::Tuned;

/// Level below which samples may be kept up by rounding alone: 2^11 steps of the bus, -96 dBFS.
pub const SILENCE: i32 = 11;
/// Time in seconds in which a sound with a T60 of up to 30 s loses a bit.
///
/// Samples below 2^[`SILENCE`] that lose none in this time are kept up by rounding.
pub const STILL_S: f64 = 3.0;
/// Level below which samples are silence: 2 steps of the bus, -156 dBFS.
pub const NOTHING: i32 = 1;
