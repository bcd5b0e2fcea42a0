//! The kernels for a Cortex-M4F: `cortex_m4.s`, bit for bit what [`super::portable`] does.
#![allow(unsafe_code)] // assembly

use super::super::network::{LINES, Work};
use crate::resonator::TICK_FRAMES;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// What cortex_m4.s counts on.
const _: () = assert!(TICK_FRAMES == 32 && LINES == 8 && size_of::<Work>() == 1024);

unsafe extern "C" {
    fn malleus_room_take(line: *const i16, gain: i32, work: *mut i32, count: usize);
    fn malleus_room_put(work: *const i32, line: *mut i16, count: usize) -> u32;
    fn malleus_room_mix(work: *mut i32, sound: *mut [i32; 2], count: usize, sine: i32, cosine: i32);
}

/// As [`super::portable::take`].
pub(in crate::room) fn take(line: &[i16], gain: i32, work: &mut [i32]) {
    let count = line.len().min(work.len());
    // SAFETY: both slices hold `count` elements.
    unsafe { malleus_room_take(line.as_ptr(), gain, work.as_mut_ptr(), count) }
}

/// As [`super::portable::put`].
pub(in crate::room) fn put(work: &[i32], line: &mut [i16]) -> u32 {
    let count = line.len().min(work.len());
    // SAFETY: both slices hold `count` elements; the core stores words at any address.
    let sizes = unsafe { malleus_room_put(work.as_ptr(), line.as_mut_ptr(), count) };
    31 - ((sizes | sizes >> 16) & 0xffff | 1).leading_zeros()
}

/// As [`super::portable::mix`], on 16-bit lines.
pub(in crate::room) fn mix(work: &mut Work, start: usize, sound: &mut [[i32; 2]], [sine, cosine]: [i32; 2]) {
    if sound.is_empty() || start + sound.len() > TICK_FRAMES {
        return;
    }
    // SAFETY: `start` and the frames behind it lie within each line of `work`, so that the last line's end is not passed.
    unsafe {
        let work = work.as_mut_ptr().cast::<i32>().add(start);
        malleus_room_mix(work, sound.as_mut_ptr(), sound.len(), sine, cosine);
    }
}
