//! The check on load that the loops round a path decay.
//!
//! In software `f64` a Cortex-M4 would take seconds for ten loops round a long path. So each angle
//! is first judged by bounds in `f32` ([`bound`]), which the FPU computes. Only an angle that the
//! bounds leave open is judged in `f64`. The bounds do not change which loops are refused.

use core::f64::consts::{PI, TAU};

use super::bound::{self, Angle};
use super::point::Point;
use super::settings::Breakpoint;
use crate::SampleRate;
use crate::sine;
use crate::table::range;
use crate::waveguide::{LoopError, Tuned};

/// Number of points of each piece at which the loops are checked.
const PARTS: u32 = 4;
/// Number of angles in the grid from 0 to π.
const GRID: u32 = 256;
/// Gain at which loops are refused: a little below 1, because multipliers are rounded.
const BELOW_ONE: f64 = 1.0 - 1e-7;
/// Limit below which a product of bounds is certain to be stable. In `f32` each bound is within
/// 1e-4 of one that holds.
const CERTAIN: f32 = 0.9995;
/// Number of angles that are judged in one walk along the path.
const TOGETHER: usize = 16;

/// An angle at which the loops would be unstable if the filter had its largest gain there.
#[derive(Clone, Copy)]
struct Suspect {
    omega: f64,
    angle: Angle,
    /// Upper bound of `Σ |B_s|` at the angle.
    loops: f32,
    /// Largest |F| over the points of the path that the bounds leave open.
    filter: f64,
}

/// Checks that `|F(ω)| Σ |B_s(ω)| < 1` holds at four points of each piece.
///
/// It is checked at angles all over the circle, close to each band, and close to the poles of each
/// point. |F| nowhere exceeds `largest_gain`. If the loops are stable even with that gain, as at
/// most angles, the path is not walked.
pub(super) fn check(
    order: u8,
    largest_gain: f64,
    breakpoints: impl Iterator<Item = Breakpoint> + Clone,
    loops: &[Tuned],
    rate: SampleRate,
) -> Result<(), LoopError> {
    let Some(first) = loops.first() else { return Ok(()) };
    let mut bounds = [bound::Loop::new(first); range::LOOPS];
    bounds.iter_mut().zip(loops).for_each(|(bound, tuned)| *bound = bound::Loop::new(tuned));
    let bounds = bounds.get(..loops.len()).unwrap_or(&[]);
    let at_most = |omega: f64| match bounds.is_empty() {
        true => f32::INFINITY,
        false => bounds.iter().map(|bound| bound.at_most(omega)).sum::<f32>(),
    };
    let gain_at_most = largest_gain as f32;

    let at = |omega: f64| (sine::cos(omega), sine::sin(omega));
    let of_loops = |omega: f64| loops.iter().map(|tuned| tuned.magnitude(at(omega))).sum::<f64>();
    let refuse_above = |gain: f64, omega: f64| {
        let frequency_hz = omega * rate.hz() / TAU;
        if gain < BELOW_ONE { Ok(()) } else { Err(LoopError::Unstable { frequency_hz, gain }) }
    };
    let judge = |suspects: &mut [Suspect]| {
        walk(breakpoints.clone(), |here, next, part| {
            let point = Point::between(order, here, next, part);
            for suspect in suspects.iter_mut() {
                let bound = point.as_ref().map_or(f32::INFINITY, |point| bound::of_filter(point, &suspect.angle));
                let is_certain = bound * suspect.loops < CERTAIN;
                if !is_certain {
                    let exact = point.as_ref().map_or(f64::INFINITY, |point| point.magnitude(at(suspect.omega)));
                    suspect.filter = suspect.filter.max(exact);
                }
            }
            Ok(())
        })?;
        let mut open = suspects.iter().filter(|suspect| suspect.filter > 0.0);
        open.try_for_each(|suspect| refuse_above(suspect.filter * of_loops(suspect.omega), suspect.omega))
    };

    let close_by = loops.iter().map(Tuned::pole).flat_map(around);
    let grid = (0..GRID).map(|step| (f64::from(step) + 0.5) / f64::from(GRID) * PI);
    let nobody = Suspect { omega: 0.0, angle: Angle::new(0.0), loops: 0.0, filter: 0.0 };
    let (mut suspects, mut count) = ([nobody; TOGETHER], 0);
    for omega in close_by.chain(grid) {
        let loops = at_most(omega);
        if gain_at_most * loops < CERTAIN {
            continue;
        }
        if let Some(suspect) = suspects.get_mut(count) {
            *suspect = Suspect { omega, angle: Angle::new(omega), loops, filter: 0.0 };
        }
        count += 1;
        if count == TOGETHER {
            judge(&mut suspects)?;
            count = 0;
        }
    }
    judge(suspects.get_mut(..count).unwrap_or(&mut []))?;

    walk(breakpoints.clone(), |here, next, part| {
        let Some(point) = Point::between(order, here, next, part) else { return refuse_above(f64::INFINITY, 0.0) };
        point.poles().into_iter().flat_map(around).try_for_each(|omega| {
            let loops = at_most(omega);
            if gain_at_most * loops < CERTAIN || bound::of_filter(&point, &Angle::new(omega)) * loops < CERTAIN {
                return Ok(());
            }
            refuse_above(point.magnitude(at(omega)) * of_loops(omega), omega)
        })
    })
}

/// Angles close to a pole, which is given by its own angle and its distance from the circle.
fn around((angle, distance): (f64, f64)) -> impl Iterator<Item = f64> {
    (-8i32..=8).map(move |step| (angle + f64::from(step) / 4.0 * distance).clamp(0.0, PI))
}

/// Visits points of each piece. A point is given by the breakpoints at both ends of its piece, and
/// by the fraction of the way between them.
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
