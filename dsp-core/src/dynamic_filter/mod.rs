//! The dynamic filter: an IIR filter whose coefficients move after each strike (dynamic-filter
//! eq. 5, 6, 17 to 21).
//!
//! Its input is noise, to which the object's modes and the loops may be added.
//!
//! ```text
//!  seeded noise ─► [exciter] ─►(+)─► s(n) = b0(n) e(n) + b1(n) e(n-1) - a1(n) s(n-1) ─► out
//!                               ▲
//!  modes, loops ────────────────┘      a strike starts the path anew and sets the noise's level
//! ```
//!
//! The paper's eq. 17 is b1 = b0. Between breakpoints ([`path`]) the first order's coefficients are
//! interpolated linearly, so that |a1| < 1 holds on the whole path. The second order has forms of
//! its own, whose states cannot grow however their parameters move.
//!
//! # Numbers
//!
//! The first order's state is 64 bits wide: `S -= (1 + a1) high(S); S += b0 e(n) + b1 e(n-1)`,
//! where high(S) is its leading word. No product is rounded. So a pole near 1 neither gathers noise
//! nor stops short of silence.
//!
//! **Nothing can wrap.** The input is clipped to X = 2.0, so that `|e| <= X` holds. Then
//! `|s(n)| <= |a1| |s(n-1)| + (|b0| + |b1|) X`, hence `|s| <= X R`, where
//! `R = max (|b0| + |b1|) / (1 - |a1|)` over the path. The maximum is at a breakpoint, because a
//! convex numerator over a concave denominator is largest at an end of its piece. On load the
//! state's scale 2^h is chosen such that `X R 2^h` is within 2^29 steps, less a thousandth for the
//! rounding of coefficients. The bound holds for any jump from one point of the path to another, so
//! for any strikes. The second order is bounded in the same way, one state at a time.

pub mod error;
pub mod kernel;
pub mod level;
pub mod limits;
pub mod object;
pub mod path;
pub mod settings;
pub mod walk;

mod bound;
mod carry;
mod exciter;
mod filter;
mod load;
mod point;
mod stability;
mod whole_ticks;

pub use error::{DynamicFilterError, PathError};
pub use object::{DynamicFilter, FilterSize};
pub use path::Path;
pub use settings::{Breakpoint, Exciter, Settings};
