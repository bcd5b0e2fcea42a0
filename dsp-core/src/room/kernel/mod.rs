//! The room's hot loops: splits, networks of 16-bit lines, doubled rates. [`portable`] is the definition of the bits; on a Cortex-M4F the same is done by assembly
//! (`cortex_m4.s`), which tests compare bit for bit on the virtual core (`cargo test -p host-tests --test on_chip room`).

pub(super) mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::{double, exchange, pass, pass_between, prepare, radiate, split};
#[cfg(not(cortex_m4f))]
pub(super) use portable::{double, exchange, pass, pass_between, prepare, radiate, split};

use super::network::LINES;
use super::storage::Sample;

/// Each line's angle (of [moving, fixed]) so lowered that its samples come out raised by so many bits: where that is 1 for any, all are to be doubled.
#[inline(always)]
pub(super) fn lowered<T: Sample>([moving, fixed]: [T::Turn; 2], rises: [i32; LINES]) -> (bool, [T::Turn; LINES]) {
    let double = rises.contains(&1);
    let lower = |turn: &T::Turn, rise: i32| T::lower(turn, (i32::from(double) - rise).max(0).unsigned_abs());
    let [rise0, rise1, rise2, rise3] = rises;
    (double, [lower(&moving, rise0), lower(&fixed, rise1), lower(&moving, rise2), lower(&fixed, rise3)])
}
