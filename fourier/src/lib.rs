//! Fourier transforms of real signals in `f64`, by the crate `realfft`.
//!
//! The transforms of `realfft` are generic: every crate that plans one compiles all of them again,
//! for 20 to 60 seconds. This crate compiles them for `f64` once, and the other crates call them
//! through their traits.

use std::cell::RefCell;
use std::sync::Arc;

use realfft::RealFftPlanner;
pub use realfft::num_complex::Complex;
pub use realfft::{ComplexToReal, RealToComplex};

thread_local! {
    /// Planner that keeps its plans, so that each thread makes the tables of a length once.
    static PLANNER: RefCell<RealFftPlanner<f64>> = RefCell::new(RealFftPlanner::new());
}

/// Plans the transform of `length` samples to `length/2 + 1` bins,
/// `X[k] = Σ x[n] exp(−2πi·kn/length)`.
///
/// It is fastest if `length` has small prime factors only. Processing fails only for slices of
/// other lengths than the plan's.
pub fn forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    PLANNER.with_borrow_mut(|planner| planner.plan_fft_forward(length))
}

/// Plans the transform of `length/2 + 1` bins to `length` samples, without a scale: the output of
/// [`forward`] becomes the samples times `length`.
///
/// Processing fails for slices of other lengths than the plan's. It also fails if the first bin is
/// not real, or for an even length the last, but computes the samples all the same.
pub fn inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    PLANNER.with_borrow_mut(|planner| planner.plan_fft_inverse(length))
}
