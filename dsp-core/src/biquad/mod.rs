//! Parallel chains of biquads: `H(z) = Σ_l Π_m k (1 - 2 Re q z⁻¹ + |q|² z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)` (diffmodal eq. 2, 3).
//!
//! ```text
//!          ┌─► section ─► section ─► ... ─► section ─┐
//!  input ──┼─► section ─► section ─► ... ─► section ─┼─(+)─► output
//!          └─► ...                                   ┘
//! ```
//!
//! # The form
//!
//! A direct form in Q31 keeps 51 dB of a low pole. A section is the modified coupled form of [`crate::resonator`] instead, with the input going into
//! both states and straight through:
//!
//! ```text
//! y = v + d x;   u -= e v;   v += e u;   u -= δ u;   u += g_u x;   v += g_v x
//! δ = 1 - |p|²,  e² = |1 - p|²;   d = k,  g_v = 2k Re(p - q),  e g_u = k(|q|² - |p|²) + |p|² g_v
//! ```
//!
//! Three free multipliers realise any pair of zeros, δ and e any pair of conjugate poles. Poles of Re p < 0 run mirrored (on input and output of
//! alternating sign); poles of e >= 1/2 or |p|² < 1/2 have their own scaling ([`design::Form`]).
//!
//! # Chains
//!
//! The product of a chain is run as the sum of its partial fractions, a section each and as many as before, wherever their poles are apart
//! (the private module `parallel` says why); chains whose poles coincide run one section behind the other.
//!
//! # Scaling
//!
//! Every section has a power of two of its own, `state = value · 2^E`, kept between ticks by `section::Section::settle`: from its state and the
//! level of its input the largest E is chosen for which nothing can wrap. So a resonance that takes 50 dB off a noise input still has all its bits.
//! The proof stands there.
//!
//! Worst SNR against `f64`, and cycles: see [`Bank`].

pub mod bank;
pub mod butterworth;
pub mod design;
pub mod kernel;
pub mod section;

mod parallel;

pub use bank::Bank;
pub use design::{Biquad, BiquadError, Root};
