//! Parallel chains of biquads:
//! `H(z) = Σ_l Π_m k (1 - 2 Re q z⁻¹ + |q|² z⁻²) / (1 - 2 Re p z⁻¹ + |p|² z⁻²)` (diffmodal
//! eq. 2, 3).
//!
//! ```text
//!          ┌─► section ─► section ─► ... ─► section ─┐
//!  input ──┼─► section ─► section ─► ... ─► section ─┼─(+)─► output
//!          └─► ...                                   ┘
//! ```
//!
//! # The form
//!
//! A direct form in Q31 keeps 51 dB of a low pole. A section is the modified coupled form of
//! [`crate::resonator`] instead, with the input going into both states. The direct gain is added
//! once for all chains:
//!
//! ```text
//! y = v;   u -= e v;   v += e u;   u -= δ u;   u += g_u x;   v += g_v x
//! δ = 1 - |p|²,  e² = |1 - p|²
//! n1 z⁻¹ + n2 z⁻² over the denominator:  g_v = n1,  e g_u = n2 + |p|² n1
//! ```
//!
//! Two multipliers realise any numerator, δ and e any pair of conjugate poles. Poles of Re p < 0
//! run mirrored (on input and output of alternating sign). Poles of e >= 1/2 or |p|² < 1/2 have
//! scalings of their own ([`pole::Form`]).
//!
//! # Chains
//!
//! A chain is a product of sections and runs as the sum of its partial fractions, which has as many
//! sections. Sections whose poles (nearly) coincide stay in a row, and each gets a share of the
//! input. [`fractions`] says why, and derives the shares.
//!
//! # Scaling
//!
//! A pair of sections has a power of two of its own, `state = value · 2^E`. Between ticks the
//! private module `settle` chooses the largest E for which nothing can wrap, from the states and
//! the level of the input. The proof stands there. So a resonance that takes 50 dB off a noise
//! input still has all its bits.
//!
//! # Choke
//!
//! Under a choke a chain's states are multiplied by κ after each frame, so that the chain decays at
//! least as fast as the choke wants (private module `choke`).
//!
//! Worst SNR against `f64`, and cycles: `docs/biquads.md`.

pub mod bank;
pub mod butterworth;
pub mod design;
pub mod fractions;
pub mod kernel;
pub mod modes;
pub mod pair;
pub mod pole;
pub mod rate;

mod choke;
mod extent;
mod gain;
mod load;
mod placement;
mod settle;
mod unit;

pub use bank::{Bank, TickKind};
pub use design::{Biquad, BiquadError, Root};
pub use modes::{ModalForm, Partial};
