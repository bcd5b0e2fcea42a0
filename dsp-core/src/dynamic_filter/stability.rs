//! Whether the loops round a path decay.

use core::f64::consts::{PI, TAU};

use super::path;
use super::settings::Breakpoint;
use crate::SampleRate;
use crate::waveguide::{LoopError, Tuned};

/// Points of each piece at which the loops are looked at.
const PARTS: u32 = 4;
/// Angles all over the circle.
const GRID: u32 = 256;
/// A little below 1 for what rounding does to multipliers.
const BELOW_ONE: f64 = 1.0 - 1e-7;

/// `|F(ω)| Σ |B_s(ω)| < 1` at four points of each piece: at angles all over the circle, close by each band, and close by the pole of each point of the path.
/// `largest_gain` is what |F| nowhere exceeds: where the loops pass too little even for that, as at most angles, the path need not be walked.
pub(super) fn check(
    order: u8,
    largest_gain: f64,
    breakpoints: impl Iterator<Item = Breakpoint> + Clone,
    loops: &[Tuned],
    rate: SampleRate,
) -> Result<(), LoopError> {
    let at = |omega: f64| (libm::cos(omega), libm::sin(omega));
    let of_loops = |omega: f64| loops.iter().map(|tuned| tuned.magnitude(at(omega))).sum::<f64>();
    let refuse_above = |gain: f64, omega: f64| {
        let frequency_hz = omega * rate.hz() / TAU;
        if gain < BELOW_ONE { Ok(()) } else { Err(LoopError::Unstable { frequency_hz, gain }) }
    };
    let holds = |omega: f64| {
        let of_loops = of_loops(omega);
        if largest_gain * of_loops < BELOW_ONE {
            return Ok(());
        }
        let mut largest = 0.0f64;
        walk(breakpoints.clone(), |here, next, part| {
            largest = largest.max(path::magnitude(order, here, next, part, at(omega)));
            Ok(())
        })?;
        refuse_above(largest * of_loops, omega)
    };
    if loops.is_empty() {
        return Ok(());
    }
    loops.iter().map(Tuned::pole).flat_map(around).try_for_each(holds)?;
    (0..GRID).try_for_each(|step| holds((f64::from(step) + 0.5) / f64::from(GRID) * PI))?;
    walk(breakpoints.clone(), |here, next, part| {
        path::poles(order, here, next, part).into_iter().flat_map(around).try_for_each(|omega| {
            let of_loops = of_loops(omega);
            let is_safe = largest_gain * of_loops < BELOW_ONE;
            let of_filter = if is_safe { 0.0 } else { path::magnitude(order, here, next, part, at(omega)) };
            refuse_above(of_filter * of_loops, omega)
        })
    })
}

/// Angles close by a pole, given by its own angle and its distance from the circle.
fn around((angle, distance): (f64, f64)) -> impl Iterator<Item = f64> {
    (-8i32..=8).map(move |step| (angle + f64::from(step) / 4.0 * distance).clamp(0.0, PI))
}

/// Visits points of each piece, given by its ends and how far along they are.
fn walk(
    breakpoints: impl Iterator<Item = Breakpoint> + Clone,
    mut visit: impl FnMut(&Breakpoint, &Breakpoint, f64) -> Result<(), LoopError>,
) -> Result<(), LoopError> {
    let mut following = breakpoints.clone().skip(1);
    for here in breakpoints {
        let next = following.next();
        let parts = if next.is_some() { PARTS } else { 1 };
        for part in 0..parts {
            visit(&here, &next.unwrap_or(here), f64::from(part) / f64::from(PARTS))?;
        }
    }
    Ok(())
}
