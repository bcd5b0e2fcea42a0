//! The kernels for a Cortex-M4F, in `cortex_m4*.s`. Their bits equal those of [`super::portable`],
//! [`super::two_poles`] and [`super::section`].
#![allow(unsafe_code)] // assembly

use core::mem::offset_of;

use super::super::path::PARAMETERS;
use super::super::walk::Line;
use super::section::{Response, Section};
use super::two_poles::TwoPoles;
use super::{OnePole, SumsKind, portable};
use crate::noise::{MULTIPLIER, White};

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));
core::arch::global_asm!(include_str!("cortex_m4_input.s"), options(raw));
core::arch::global_asm!(include_str!("cortex_m4_section.s"), options(raw));
core::arch::global_asm!(include_str!("cortex_m4_two_poles.s"), options(raw));

// The assembly relies on these offsets and numbers.
const _: () = {
    assert!(offset_of!(OnePole, state) == 0 && offset_of!(OnePole, last) == 8 && offset_of!(OnePole, noise) == 12);
    assert!(offset_of!(OnePole, level) == 16 && offset_of!(OnePole, shift) == 20 && offset_of!(OnePole, lines) == 24);
    assert!(MULTIPLIER == 0x93d7_65dd);
    assert!(offset_of!(Section, c) == 0 && offset_of!(Section, left) == 8 && offset_of!(Section, less_m) == 16);
    assert!(offset_of!(Section, p) == 20 && offset_of!(Section, less_p) == 24 && offset_of!(Section, less_n) == 28);
    assert!(offset_of!(Section, input) == 32 && offset_of!(Section, k) == 40);
    assert!(size_of::<Line>() == 8 && PARAMETERS == 5);
};

unsafe extern "C" {
    fn malleus_conjugate_near(poles: *mut TwoPoles, lines: *mut Line, buffer: *mut i32, out: *mut i32, frames: usize);
    fn malleus_conjugate_loud(poles: *mut TwoPoles, lines: *mut Line, buffer: *mut i32, out: *mut i32, frames: usize);
    fn malleus_real_near(poles: *mut TwoPoles, lines: *mut Line, buffer: *mut i32, out: *mut i32, frames: usize);
    fn malleus_real_loud(poles: *mut TwoPoles, lines: *mut Line, buffer: *mut i32, out: *mut i32, frames: usize);
    fn malleus_section_band(section: *mut Section, words: *mut i32, frames: usize);
    fn malleus_section_low(section: *mut Section, words: *mut i32, frames: usize);
    fn malleus_section_high(section: *mut Section, words: *mut i32, frames: usize);
    fn malleus_noise(noise: u32, level: i32, words: *mut i32, frames: usize) -> u32;
    fn malleus_from_noise_equal_near(filter: *mut OnePole, out: *mut i32, frames: usize);
    fn malleus_from_noise_equal_loud(filter: *mut OnePole, out: *mut i32, frames: usize);
    fn malleus_from_noise_equal_far(filter: *mut OnePole, out: *mut i32, frames: usize);
    fn malleus_from_noise_two_far(filter: *mut OnePole, out: *mut i32, frames: usize);
    fn malleus_from_noise_two_near(filter: *mut OnePole, out: *mut i32, frames: usize);
    fn malleus_from_noise_two_loud(filter: *mut OnePole, out: *mut i32, frames: usize);
    fn malleus_from_buffer_equal_asr(filter: *mut OnePole, buffer: *mut i32, out: *mut i32, frames: usize);
    fn malleus_from_buffer_equal_lsl(filter: *mut OnePole, buffer: *mut i32, out: *mut i32, frames: usize);
    fn malleus_from_buffer_two_asr(filter: *mut OnePole, buffer: *mut i32, out: *mut i32, frames: usize);
    fn malleus_from_buffer_two_lsl(filter: *mut OnePole, buffer: *mut i32, out: *mut i32, frames: usize);
    fn malleus_from_sums_equal_fine_near(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_equal_fine_lsl(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_equal_fine_far(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_equal_coarse_near(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_equal_coarse_lsl(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_equal_coarse_far(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_two_fine_near(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_two_fine_lsl(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_two_fine_far(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_two_coarse_near(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_two_coarse_lsl(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
    fn malleus_from_sums_two_coarse_far(filter: *mut OnePole, sums: *mut i32, out: *mut i32, frames: usize) -> u32;
}

/// Does what [`portable::from_noise`] does.
#[inline(always)]
pub fn from_noise<const EQUAL: bool>(filter: &mut OnePole, out: &mut [i32]) {
    if out.is_empty() || filter.whole {
        return portable::from_noise::<EQUAL>(filter, out);
    }
    let kernel = match (EQUAL, filter.shift) {
        // The usual case comes first, and always fits.
        (true, 0) => malleus_from_noise_equal_near,
        (false, 0) => malleus_from_noise_two_near,
        _ if !fits::<0>(filter, out.len()) => return portable::from_noise::<EQUAL>(filter, out),
        (true, -2) => malleus_from_noise_equal_loud,
        (false, -2) => malleus_from_noise_two_loud,
        (true, ..=-3) => malleus_from_noise_equal_far,
        (false, ..=-3) => malleus_from_noise_two_far,
        // No path has another scale if noise goes straight into its filter.
        _ => return portable::from_noise::<EQUAL>(filter, out),
    };
    // SAFETY: `out` is borrowed mutably and holds as many words as are given; the assembly keeps
    // the procedure call standard.
    unsafe { kernel(filter, out.as_mut_ptr(), out.len()) }
}

/// Does what [`portable::from_buffer`] does.
pub fn from_buffer<const EQUAL: bool>(filter: &mut OnePole, buffer: &mut [i32], out: &mut [i32]) {
    let frames = buffer.len().min(out.len());
    if frames == 0 || filter.whole || filter.is_far() {
        return portable::from_buffer::<EQUAL>(filter, buffer, out);
    }
    let kernel = match (EQUAL, filter.shift >= 0) {
        (true, true) => malleus_from_buffer_equal_asr,
        (true, false) => malleus_from_buffer_equal_lsl,
        (false, true) => malleus_from_buffer_two_asr,
        (false, false) => malleus_from_buffer_two_lsl,
    };
    // SAFETY: both are borrowed mutably and hold at least `frames` words; the assembly keeps the
    // procedure call standard.
    unsafe { kernel(filter, buffer.as_mut_ptr(), out.as_mut_ptr(), frames) }
}

/// Does what [`portable::noise`] does.
pub fn noise(noise: &mut White, level: i32, words: &mut [i32]) {
    // SAFETY: `words` is borrowed mutably and holds as many words as are given; the assembly keeps
    // the procedure call standard.
    *noise = White::from_word(unsafe { malleus_noise(noise.word(), level, words.as_mut_ptr(), words.len()) });
}

/// Does what [`super::two_poles::two_poles`] does.
pub fn two_poles(
    poles: &mut TwoPoles,
    real: bool,
    lines: &mut [Line; PARAMETERS],
    buffer: &mut [i32],
    out: &mut [i32],
) {
    let frames = buffer.len().min(out.len());
    let kernel = match (real, poles.is_loud()) {
        (false, false) => malleus_conjugate_near,
        (false, true) => malleus_conjugate_loud,
        (true, false) => malleus_real_near,
        (true, true) => malleus_real_loud,
    };
    // SAFETY: all are borrowed mutably, buffer and out hold at least `frames` words; the assembly
    // keeps the procedure call standard.
    unsafe { kernel(poles, lines.as_mut_ptr(), buffer.as_mut_ptr(), out.as_mut_ptr(), frames) }
}

/// Does what [`super::section::section`] does.
pub fn section(section: &mut Section, response: Response, words: &mut [i32]) {
    let kernel = match response {
        Response::Band => malleus_section_band,
        Response::Low => malleus_section_low,
        Response::High => malleus_section_high,
    };
    // SAFETY: both are borrowed mutably, and as many words are given as there are; the assembly
    // keeps the procedure call standard.
    unsafe { kernel(section, words.as_mut_ptr(), words.len()) }
}

type FromSums = unsafe extern "C" fn(*mut OnePole, *mut i32, *mut i32, usize) -> u32;

/// Kernels by [`SumsKind`]. There is none for a filter whose damping multiplies all bits.
static FROM_SUMS: [FromSums; 12] = [
    malleus_from_sums_equal_fine_near,
    malleus_from_sums_equal_fine_lsl,
    malleus_from_sums_equal_fine_far,
    malleus_from_sums_equal_coarse_near,
    malleus_from_sums_equal_coarse_lsl,
    malleus_from_sums_equal_coarse_far,
    malleus_from_sums_two_fine_near,
    malleus_from_sums_two_fine_lsl,
    malleus_from_sums_two_fine_far,
    malleus_from_sums_two_coarse_near,
    malleus_from_sums_two_coarse_lsl,
    malleus_from_sums_two_coarse_far,
];

/// Does what [`portable::from_sums`] does.
#[inline(always)]
pub fn from_sums(filter: &mut OnePole, kind: SumsKind, sums: &mut [i32], out: &mut [i32]) -> u32 {
    let frames = sums.len().min(out.len());
    match FROM_SUMS.get(usize::from(kind.0)) {
        // SAFETY: both are borrowed mutably and hold at least `frames` words; the assembly keeps
        // the procedure call standard.
        Some(kernel) if fits::<1>(filter, frames) => unsafe {
            kernel(filter, sums.as_mut_ptr(), out.as_mut_ptr(), frames)
        },
        _ => portable::from_sums(filter, kind, sums, out),
    }
}

/// True if the shift to the bus needs no saturation, because it keeps the high word's leading bits
/// and leaves `BITS_LEFT` bits free.
///
/// The high word is always below 2^29, and in each of these frames it changes by no more than
/// `growth`.
#[inline(always)]
fn fits<const BITS_LEFT: i32>(filter: &OnePole, frames: usize) -> bool {
    filter.shift >= -2 || {
        let high = ((filter.state >> 32) as i32).unsigned_abs();
        // The shift is below 32, so that a saturated number does not fit.
        let most = high.saturating_add(filter.growth.saturating_mul(frames as u32));
        most >> (31 - BITS_LEFT + filter.shift.max(-30)) == 0
    }
}
