//! Fourier transforms of real signals in `f64`, by the crate `realfft`.
//!
//! Its transforms are generic, so that every crate that plans one compiles all of them again, for 20 to 60 seconds. Here they are made for
//! `f64` once; the others call them through their traits.

use std::cell::RefCell;
use std::sync::Arc;

use realfft::RealFftPlanner;
pub use realfft::num_complex::Complex;
pub use realfft::{ComplexToReal, RealToComplex};

thread_local! {
    /// Keeps what it has planned: a length costs its tables once a thread.
    static PLANNER: RefCell<RealFftPlanner<f64>> = RefCell::new(RealFftPlanner::new());
}

/// From `length` samples to `length/2 + 1` bins, `X[k] = Σ x[n] exp(−2πi·kn/length)`.
///
/// Quickest where `length` has small prime factors only. Processing fails for slices of other lengths than the plan's, and for those only.
pub fn forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    PLANNER.with_borrow_mut(|planner| planner.plan_fft_forward(length))
}

/// From `length/2 + 1` bins to `length` samples, without a scale: what [`forward`] gave comes back times `length`.
///
/// Processing fails besides where the first bin, or of an even length the last, is not real; the samples are computed all the same.
pub fn inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    PLANNER.with_borrow_mut(|planner| planner.plan_fft_inverse(length))
}
