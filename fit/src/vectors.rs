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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn sums_have_the_same_bits_with_vectors_of_any_width() {
        let mut random = SplitMix64(7);
        for length in [0, 1, 7, 8, 9, 64, 1023] {
            let [a, b] = [0; 2].map(|_| (0..length).map(|_| random.normal() as f32).collect::<Vec<f32>>());
            let wide = vectorized(
                #[inline(always)]
                || [sum(&a), dot(&a, &b)],
            );
            let plain: f64 = a.iter().zip(&b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum();
            assert_eq!(wide.map(f32::to_bits), [sum(&a), dot(&a, &b)].map(f32::to_bits), "{length}");
            assert!((f64::from(wide[1]) - plain).abs() < 1e-4, "{length}: {wide:?} for {plain}");
        }
    }
}
