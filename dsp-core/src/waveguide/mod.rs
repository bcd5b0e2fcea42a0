//! Banded waveguides: feedback loops round the dynamic filter, each a delay and a narrow band-pass
//! (dynamic-filter eq. 8 to 13, 22 to 24).
//!
//! ```text
//!  noise e ─►(+)─► clip ─► dynamic filter F ─┬─► s
//!             ▲                              │
//!             └───── Σ B_s ◄──── z^-D_s ◄────┘
//! ```
//!
//! All loops read one line of s, and are summed, with the noise, where s will be written. Where
//! every delay is at least a tick (p in eq. 22 chosen so), they work in blocks of a tick; otherwise
//! in blocks of the shortest delay. The fraction of a delay is in the numerator of its band-pass
//! ([`tuning`]), which turns the phase at the band's frequency by it.
//!
//! **Stability.** On load `|F(ω)| Σ |B_s(ω)| < 1` is required all along the path, on a grid that is
//! dense about each band: frozen at any point, the loops decay. While coefficients move, and for
//! any strikes, the filter clips its input to 2.0, so that s stays within the bound of
//! [`crate::dynamic_filter`], the line's words below 2^30, and each loop within that of
//! [`resonance`]; when the path is over, the loops are the frozen ones of its last point and decay.
//! Rounding can keep up to 2^10 steps of the bus for ever. So, after the path's end, what has
//! stayed below 2^[`SILENCE`] for [`STILL_S`] without losing a bit is cleared; and what is at most
//! 2^[`NOTHING`] for a longest delay: a filter that ends closed so ends its loops.

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

/// Samples below 2^11 steps of the bus, -96 dBFS, may be what rounding keeps.
pub const SILENCE: i32 = 11;
/// It is where in so many seconds they lose no bit: what rings with a T60 of up to 30 s does.
pub const STILL_S: f64 = 3.0;
/// Samples below 2 steps of the bus, -156 dBFS, are nothing.
pub const NOTHING: i32 = 1;
