//! Fourier transforms of real signals in `f64`, by the crate `realfft`.
//!
//! The transforms of `realfft` are generic: every crate that plans one compiles all of them again,
//! for 20 to 60 seconds. This crate compiles them for `f64` once, and the other crates call them
//! through their traits.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use realfft::RealFftPlanner;
pub use realfft::num_complex::Complex;
pub use realfft::{ComplexToReal, RealToComplex};

thread_local! {
    /// Plans by length, so that each thread makes the tables of a length once.
    static FORWARD: RefCell<BTreeMap<usize, Arc<dyn RealToComplex<f64>>>> = const { RefCell::new(BTreeMap::new()) };
    /// Plans of the inverse transforms by length.
    static INVERSE: RefCell<BTreeMap<usize, Arc<dyn ComplexToReal<f64>>>> = const { RefCell::new(BTreeMap::new()) };
}

// A new planner makes each plan. A planner that is kept builds a plan out of its earlier ones, and
// the last bits of a spectrum would depend on the lengths that the thread had planned before.

/// Plans the transform of `length` samples to `length/2 + 1` bins,
/// `X[k] = Σ x[n] exp(−2πi·kn/length)`.
///
/// It is fastest if `length` has small prime factors only. Processing fails only for slices of
/// other lengths than the plan's.
pub fn forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    FORWARD.with_borrow_mut(|plans| {
        plans.entry(length).or_insert_with(|| RealFftPlanner::new().plan_fft_forward(length)).clone()
    })
}

/// Plans the transform of `length/2 + 1` bins to `length` samples, without a scale: the output of
/// [`forward`] becomes the samples times `length`.
///
/// Processing fails for slices of other lengths than the plan's. It also fails if the first bin is
/// not real, or for an even length the last, but computes the samples all the same.
pub fn inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    INVERSE.with_borrow_mut(|plans| {
        plans.entry(length).or_insert_with(|| RealFftPlanner::new().plan_fft_inverse(length)).clone()
    })
}
