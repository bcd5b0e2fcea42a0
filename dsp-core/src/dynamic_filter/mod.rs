//! The dynamic filter: noise, and what is added to it, through an IIR whose coefficients move
//! (dynamic-filter eq. 5, 6, 17 to 21).
//!
//! ```text
//!  seeded noise ─► [exciter] ─►(+)─► s(n) = b0(n) e(n) + b1(n) e(n-1) - a1(n) s(n-1) ─► out
//!                               ▲
//!  modes, loops ────────────────┘      a strike starts the path anew, the noise at its level
//! ```
//!
//! The paper's eq. 17 is b1 = b0. Between breakpoints ([`path`]) coefficients are interpolated
//! linearly, so that |a1| < 1 holds everywhere. The second order has forms of its own, which no
//! movement of their parameters can make grow.
//!
//! # Numbers
//!
//! The first order's state is 64 bits wide, `S -= (1 + a1) high(S); S += b0 e(n) + b1 e(n-1)`,
//! high(S) its leading word: no product is rounded, so that a pole near 1 neither gathers noise nor
//! stops short of silence.
//!
//! **Nothing can wrap**: with `|e| <= X`, `|s(n)| <= |a1| |s(n-1)| + (|b0| + |b1|) X`, hence `|s|
//! <= X R`, `R = max (|b0| + |b1|) / (1 - |a1|)` over the path; a convex numerator over a concave
//! denominator is largest at a breakpoint. The state's scale 2^h is chosen on load such that `X R
//! 2^h` is within 2^29 steps, less a thousandth for what rounding does to coefficients, X being
//! 2.0, to which the input is clipped. The bound holds for any jump from one point of the path to
//! another, so for any strikes. The second order is bounded in the same way, a state at a time.

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
