//! The modified coupled form in single precision, for comparison.

use float_forms::modal::{self, FloatMode};

use crate::wire::slice;

/// Makes `count` modes from three words each: frequency in Hz, decay in 1/s (both `f32`, at 48 kHz)
/// and gain. Gives the bytes of one mode.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn load_float(modes: *mut FloatMode, words: *const [f32; 3], count: usize) -> usize {
    // SAFETY: the host has written `count` triples there.
    let words = unsafe { slice(words, count) };
    for (index, &[frequency_hz, decay_per_s, gain]) in words.iter().enumerate() {
        let mut mode = FloatMode::new(f64::from(frequency_hz), f64::from(decay_per_s), 48_000.0);
        mode.gain = gain;
        // SAFETY: the host leaves room for `count` modes.
        unsafe { modes.add(index).write(mode) }
    }
    size_of::<FloatMode>()
}

/// Adds the sound of a block to `out`. `force` may be null.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".text.exported")]
pub unsafe extern "C" fn render_float(
    modes: *mut FloatMode,
    count: usize,
    force: *const f32,
    out: *mut f32,
    frames: usize,
) {
    // SAFETY: the host has written the modes and leaves room for the output; the three do not
    // overlap.
    let (modes, out) =
        unsafe { (core::slice::from_raw_parts_mut(modes, count), core::slice::from_raw_parts_mut(out, frames)) };
    if force.is_null() {
        modal::free(modes, out);
    } else {
        // SAFETY: the host has written `frames` samples of force there.
        modal::driven(modes, unsafe { slice(force, frames) }, out);
    }
}
