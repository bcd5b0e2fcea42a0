//! Whether the loops round a path decay.

use core::f64::consts::{PI, TAU};

use super::path;
use super::settings::Breakpoint;
use crate::SampleRate;
use crate::waveguide::{LoopError, Tuned};

/// Points of each piece at which the loops are looked at.
const PARTS: u32 = 4;
/// A little below 1 for what rounding does to multipliers.
const BELOW_ONE: f64 = 1.0 - 1e-7;

/// `|F(ω)| Σ |B_s(ω)| < 1` at four points of each piece, at angles all over the circle and close by each band. `largest_gain` is what |F| nowhere exceeds: where the
/// loops pass too little even for that, as at most angles, the path need not be walked.
pub(super) fn check(
    order: u8,
    largest_gain: f64,
    breakpoints: impl Iterator<Item = Breakpoint> + Clone,
    loops: &[Tuned],
    rate: SampleRate,
) -> Result<(), LoopError> {
    let holds = |omega: f64| {
        let w = (libm::cos(omega), libm::sin(omega));
        let of_loops: f64 = loops.iter().map(|tuned| tuned.magnitude(w)).sum();
        if largest_gain * of_loops < BELOW_ONE {
            return Ok(());
        }
        let mut largest = 0.0f64;
        let mut following = breakpoints.clone().skip(1);
        for here in breakpoints.clone() {
            let next = following.next();
            let parts = if next.is_some() { PARTS } else { 1 };
            for part in 0..parts {
                let part = f64::from(part) / f64::from(PARTS);
                largest = largest.max(path::magnitude(order, &here, &next.unwrap_or(here), part, w));
            }
        }
        let gain = largest * of_loops;
        let frequency_hz = omega * rate.hz() / TAU;
        if gain < BELOW_ONE { Ok(()) } else { Err(LoopError::Unstable { frequency_hz, gain }) }
    };
    for tuned in loops {
        let (angle, distance) = tuned.pole();
        for step in -8i32..=8 {
            holds((angle + f64::from(step) / 4.0 * distance).clamp(0.0, PI))?;
        }
    }
    let grid = if loops.is_empty() { 0 } else { 256u32 };
    (0..grid).try_for_each(|step| holds((f64::from(step) + 0.5) / f64::from(grid) * PI))
}
