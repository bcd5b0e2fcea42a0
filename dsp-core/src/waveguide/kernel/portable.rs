//! The loops' band-passes in plain Rust: the definition of the bits.

use super::super::resonance::Resonance;
use crate::fixed::qadd;
#[cfg(not(cortex_m4f))]
use crate::fixed::smmlar;
#[cfg(not(cortex_m4f))]
use crate::noise::White;

/// Adds the output of the bands to `frames` sums, which lie on the line from `place` on, where s
/// will be written.
///
/// A band reads the line as many frames before the sums as its delay has. Behind the line's end it
/// goes on at the start. A delay has at least `frames` frames, and at most `frames` less than the
/// line. Gives true if a state is to be scaled anew.
#[cfg(not(cortex_m4f))]
pub(crate) fn run(bands: &mut [Resonance], line: &mut [i32], place: usize, frames: usize) -> bool {
    through(bands, line, place, frames, |band, sum, v| smmlar(sum, v, band.scale))
}

/// Fills the sums with noise of a level, which `draw` draws, and adds the bands' output as [`run`]
/// does.
#[cfg(not(cortex_m4f))]
pub(crate) fn run_on_noise(
    noise: &mut White,
    level: i32,
    bands: &mut [Resonance],
    line: &mut [i32],
    place: usize,
    frames: usize,
    draw: impl Fn(&mut White, i32, &mut [i32]),
) -> bool {
    draw(noise, level, line.get_mut(place..place + frames).unwrap_or(&mut []));
    run(bands, line, place, frames)
}

/// Does what `run` does, with saturating sums.
pub(crate) fn run_loud(bands: &mut [Resonance], line: &mut [i32], place: usize, frames: usize) -> bool {
    through(bands, line, place, frames, |band, sum, v| qadd(sum, band.of_sum(v)))
}

#[inline(always)]
fn through(
    bands: &mut [Resonance],
    line: &mut [i32],
    place: usize,
    frames: usize,
    add: impl Fn(&Resonance, i32, i32) -> i32,
) -> bool {
    let (length, mut changes) = (line.len(), false);
    for band in bands {
        let mut from = if place >= band.delay { place - band.delay } else { place + length - band.delay };
        for at in place..place + frames {
            let Some(&x) = line.get(from) else { break };
            let Some(sum) = line.get_mut(at) else { break };
            let v = band.step(x);
            *sum = add(band, *sum, v);
            from = if from + 1 == length { 0 } else { from + 1 };
        }
        changes |= band.changes();
    }
    changes
}
