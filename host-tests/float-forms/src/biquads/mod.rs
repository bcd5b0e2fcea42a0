//! The bank of biquads in single precision: [`dsp_core::biquad`] for those who mix in floats, with
//! the same run time and half as many decibels.
//!
//! # The form
//!
//! The modified coupled form again, scaled so that one of the two input gains is 1:
//!
//! ```text
//! y = v;   u -= a v;   v += b u;   u = κ u;   u += x;   v += g x
//! κ = |p|²,  a b = e² = |1 - p|²;   g = n1,  b = n2 + |p|² n1
//! ```
//!
//! Nine operations, the mix included; damping as a subtraction of its own, as in Q31, would be a
//! tenth. The price is that a decay is off by the rounding of κ: 0.15 % at a radius of 0.99999, or
//! 56 dB. A direct form in `f32` keeps 14 dB of a low pole there. The product a b is chosen exact
//! to 10^-9 among neighbours of b, since a frequency that is off by a rounding of `f32` (0.1 cent
//! at 20 kHz) would cost more than the decay.
//!
//! Where g or b is so small that the other scaling were wanted, b is kept at 2^-20 of what g is
//! worth: 120 dB below.
//!
//! Four sections lie in the 32 registers of the chip's FPU ([`kernel`]). Chains become partial
//! fractions as in Q31 ([`dsp_core::biquad::fractions`]); those whose poles (nearly) coincide stay
//! behind one another, in a plain loop.

pub mod bank;
pub mod kernel;
pub mod quad;

pub use bank::FloatBank;
