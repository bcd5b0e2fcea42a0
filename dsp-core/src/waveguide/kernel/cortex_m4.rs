//! The kernel for a Cortex-M4F, in `cortex_m4.s`. Its bits equal those of [`super::portable`].
#![allow(unsafe_code)] // assembly

use core::mem::offset_of;

use super::super::resonance::Resonance;
use crate::noise::White;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// The assembly relies on these offsets.
const _: () = {
    assert!(offset_of!(Resonance, u) == 0 && offset_of!(Resonance, v) == 4 && offset_of!(Resonance, turn) == 8);
    assert!(offset_of!(Resonance, damp) == 12 && offset_of!(Resonance, gain_u) == 16);
    assert!(offset_of!(Resonance, gain_v) == 20 && offset_of!(Resonance, scale) == 24);
    assert!(offset_of!(Resonance, shift) == 28 && offset_of!(Resonance, delay) == 32);
    assert!(
        offset_of!(Resonance, least_zeros) == 36
            && offset_of!(Resonance, most_zeros) == 40
            && size_of::<Resonance>() == 88
    );
};

unsafe extern "C" {
    fn malleus_loops(
        bands: *mut Resonance,
        count: usize,
        line: *const i32,
        line_end: *const i32,
        sums: *mut i32,
        frames: usize,
    ) -> u32;
    fn malleus_loops_on_noise(
        bands: *mut Resonance,
        count: usize,
        line: *const i32,
        line_end: *const i32,
        sums: *mut i32,
        frames: usize,
        noise: u32,
        level: i32,
    ) -> u64;
}

/// Does what [`super::portable::run`] does.
pub(crate) fn run(bands: &mut [Resonance], line: &mut [i32], place: usize, frames: usize) -> bool {
    if bands.is_empty() || frames == 0 || place + frames > line.len() {
        return false;
    }
    let range = line.as_mut_ptr_range();
    // SAFETY: bands and line are borrowed mutably, and the sums lie on the line. A band's delay is
    // below the line's length, as `Tuned::new` and `Loops` see to, so that it reads within the
    // line. The assembly keeps the procedure call standard.
    unsafe {
        malleus_loops(bands.as_mut_ptr(), bands.len(), range.start, range.end, range.start.add(place), frames) != 0
    }
}

/// Does what [`super::portable::run_on_noise`] does.
pub(crate) fn run_on_noise(
    noise: &mut White,
    level: i32,
    bands: &mut [Resonance],
    line: &mut [i32],
    place: usize,
    frames: usize,
    draw: impl Fn(&mut White, i32, &mut [i32]),
) -> bool {
    if bands.first().is_none_or(|first| first.shift > 0) || frames == 0 || place + frames > line.len() {
        let sums = line.get_mut(place..place + frames).unwrap_or(&mut []);
        draw(noise, level, sums);
        return run(bands, line, place, frames);
    }
    let range = line.as_mut_ptr_range();
    let (count, sums, word) = (bands.len(), range.start.wrapping_add(place), noise.word());
    // SAFETY: as for `run`.
    let result =
        unsafe { malleus_loops_on_noise(bands.as_mut_ptr(), count, range.start, range.end, sums, frames, word, level) };
    *noise = White::from_word((result >> 32) as u32);
    result as u32 != 0
}
