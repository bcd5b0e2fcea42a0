//! The dynamic filter: noise, and what is added to it, through an IIR whose coefficients move (dynamic-filter eq. 5, 6, 17 to 21).
//!
//! ```text
//!  seeded noise ─►(+)─► s(n) = b0(n) e(n) + b1(n) e(n-1) - a1(n) s(n-1) ─► added to the output
//!                  ▲
//!  modes ──────────┘      each strike starts the coefficients' path anew, its b0 and b1 by the strike's gain
//! ```
//!
//! The paper's eq. 17 is b1 = b0. Between the breakpoints of [`path::Path`] coefficients are interpolated linearly, so that |a1| < 1 holds everywhere.
//!
//! # Numbers
//!
//! The state is 64 bits wide, `S -= (1 + a1) high(S); S += b0 e(n) + b1 e(n-1)`, high(S) its 31 leading bits: no
//! product is rounded, so that a pole near 1 neither gathers noise nor stops short of silence. **Nothing can wrap**: with `|e| <= X`, `|s(n)| <= |a1| |s(n-1)| + (|b0| + |b1|) X`, hence
//! `|s| <= X R`, `R = max (|b0| + |b1|) / (1 - |a1|)` over the path; a convex numerator over a concave denominator is largest at a breakpoint. The
//! state's scale 2^h is chosen on load such that `X R 2^h < 2^28`, X being 2.0, to which the input is clipped. The bound holds for any jump from one point of the path to
//! another, so for any strikes.

pub mod first_order;
pub mod object;
pub mod path;

pub use crate::biquad::butterworth::Exciter;
pub use first_order::Filter;
pub use object::{DynamicFilter, DynamicFilterError, Settings};
pub use path::{Breakpoint, Path, PathError};
