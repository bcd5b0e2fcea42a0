//! The loops for a Cortex-M4F: `cortex_m4.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this folder

use super::super::twiddles::{Complex, Factors};

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// The sizes that cortex_m4.s uses.
const _: () = assert!(size_of::<Complex>() == 8 && size_of::<Factors>() == 24);

unsafe extern "C" {
    fn malleus_fourier_pass(data: *mut Complex, row: usize, first: usize, count: usize, factors: *const Factors);
    fn malleus_fourier_last_pass(data: *mut Complex, count: usize);
}

/// Computes butterflies of a pass as [`super::portable::pass`] does.
///
/// Cost, counted from the code: 66 cycles a butterfly, 13 a block.
pub(in super::super) fn pass(data: &mut [Complex], factors: &[Factors], first: usize, count: usize) {
    let row = factors.len();
    if row == 0 || count == 0 || !data.len().is_multiple_of(4 * row) || first + count > data.len() / 4 {
        return;
    }
    let (block, first) = (first / row, first % row);
    let Some(data) = data.get_mut(block * 4 * row..) else { return };
    // SAFETY: the data are whole blocks from this one on, with at least as many butterflies; there
    // is a factor for each butterfly of a block.
    unsafe { malleus_fourier_pass(data.as_mut_ptr(), row, first, count, factors.as_ptr()) }
}

/// Computes butterflies of the last pass as [`super::portable::last_pass`] does.
///
/// Cost, counted from the code: 38 cycles a butterfly.
pub(in super::super) fn last_pass(data: &mut [Complex], first: usize, count: usize) {
    if let Some(data) = data.get_mut(4 * first..4 * (first + count))
        && count > 0
    {
        // SAFETY: there are four points for each of the butterflies, at least one.
        unsafe { malleus_fourier_last_pass(data.as_mut_ptr(), count) }
    }
}
