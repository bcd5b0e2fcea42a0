//! Decay of a band of sound: exponentials and a floor in its power.
//!
//! The power of a band of noise scatters about its mean like an exponential random variable; that
//! of a single mode does not scatter. For both, the mean `m(t)` that minimises `Σ ln m + p/m` is
//! the maximum-likelihood estimate or near it. It weighs every stretch of time alike however quiet
//! it is, and needs no logarithm of noise, whose mean lies 2.5 dB too low.

mod blocks;
mod fit;

pub(crate) use blocks::blocks;
pub(crate) use fit::{Decay, constant_misfit, fit};
