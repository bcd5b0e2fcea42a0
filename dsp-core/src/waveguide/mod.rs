//! Banded waveguides: feedback loops round the dynamic filter, each a delay and a narrow band-pass (dynamic-filter eq. 8 to 13, 22 to 24).
//!
//! ```text
//!  noise e ─►(+)─► dynamic filter F ─┬─► s
//!             ▲                      │
//!             └─ Σ B_s ◄── z^-D_s ◄──┘
//! ```
//!
//! Delays are at least a tick long ([`band::Loop::derive`] takes p in eq. 22 large enough), so that all works in blocks. The fraction of a delay is in
//! the numerator of its band-pass, which turns the phase at the band's frequency by it: over a band of a few hertz that is the delay.
//!
//! **Stability.** On load `|F(ω)| Σ |B_s(ω)| < 1` is required of every point of the path, on a grid that is dense about each band: frozen
//! at any point, the loops decay. While coefficients move, and for any strikes, the filter clips its input to 2.0, so that all stays within
//! the bound of [`crate::dynamic_filter`]; when the path is over, the loops are the frozen ones of its last point and decay. A loop
//! of rounded samples would stop decaying at some 2^10 steps of the bus: what stays below [`SILENCE`] for a whole delay line after the path's
//! end is cleared.

pub mod band;
pub mod loops;

pub use band::{Loop, LoopError};
pub use loops::Waveguides;

/// Samples below this, -96 dBFS, are cleared when a whole delay line of them is.
pub const SILENCE: u32 = 1 << 11;
