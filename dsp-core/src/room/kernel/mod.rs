//! The network's hot loops on 16-bit lines: read, mix, write. [`portable`] is the definition of the bits; on a Cortex-M4F the same is done by assembly
//! (`cortex_m4.s`), which tests compare bit for bit on the virtual core (`cargo test -p host-tests --test on_chip room`).

pub(super) mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::{mix, put, take};
#[cfg(not(cortex_m4f))]
pub(super) use portable::{put, take};

/// [`portable::mix`] on 16-bit lines.
#[cfg(not(cortex_m4f))]
pub(super) fn mix(work: &mut super::network::Work, start: usize, sound: &mut [[i32; 2]], turn: [i32; 2]) {
    portable::mix(work, start, sound, turn, <i16 as super::Sample>::HALF_STEP);
}
