//! Loops for the vector units that the processor has.

use pulp::Arch;

/// Number of values that are added up side by side, so that a sum has the same bits with vectors
/// of any width.
pub(crate) const LANES: usize = 8;

/// Runs a calculation as it is compiled for the widest vectors that this processor has.
///
/// The calculation must be marked `#[inline(always)]`, and so must be what it calls. Products and
/// sums are rounded apart: no bit depends on the processor.
pub(crate) fn vectorized<R>(calculation: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(calculation)
}

/// Sum of values.
#[inline(always)]
pub(crate) fn sum(values: &[f32]) -> f32 {
    let (groups, rest) = values.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for group in groups {
        sums.iter_mut().zip(group).for_each(|(sum, value)| *sum += value);
    }
    sums.iter_mut().zip(rest).for_each(|(sum, value)| *sum += value);
    sums.iter().sum()
}

/// Sum of products, as far as both slices go.
#[inline(always)]
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let length = a.len().min(b.len());
    let ((a, a_rest), (b, b_rest)) = (a[..length].as_chunks::<LANES>(), b[..length].as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter_mut().zip(a_rest.iter().zip(b_rest)).for_each(|(sum, (a, b))| *sum += a * b);
    sums.iter().sum()
}
