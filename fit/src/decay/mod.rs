//! Exponentials and a floor in the power of a band: how fast a band of sound dies away.
//!
//! The power of a band of noise scatters about its mean like an exponential random variable, that of a single mode does not scatter at all. For
//! both, the mean `m(t)` that makes `Σ ln m + p/m` least is the maximum-likelihood estimate or near it, weighs every stretch of time alike however
//! quiet it is, and needs no logarithm of noise, whose mean lies 2.5 dB too low.

mod blocks;
mod fit;

pub(crate) use blocks::{Block, blocks};
pub(crate) use fit::{Decay, constant_misfit, fit};
