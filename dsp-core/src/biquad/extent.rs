//! Bounds of the states of coupled parts within a tick.

use super::fractions::{Part, Realised};
use super::pole::{Form, Pole};
use crate::time::TICK_FRAMES;

/// Bounds of `max(|u| 2^k, |v|)` over a tick, for all parts of a unit and all intermediate results.
pub(super) struct Extent {
    /// Bound for states of size 1 at the tick's start.
    pub(super) growth: f64,
    /// Bound for inputs whose sizes add up to 1.
    pub(super) of_input: f64,
    /// Bound for an input of size 1 that never ends.
    pub(super) reach: f64,
}

impl Extent {
    /// Finds the bounds by stepping the parts of a row in `f64`.
    pub(super) fn of(parts: &[Part<Pole>]) -> Self {
        // Growth is linear: the sum of the growths from the unit vectors bounds all starts in the
        // unit cube.
        let mut growths = [0.0; 4];
        for start in 0..parts.len() {
            for on_u in [true, false] {
                let mut states = [[0.0; 2]; 4];
                if let (Some(state), Some(part)) = (states.get_mut(start), parts.get(start)) {
                    *state = if on_u { [1.0 / unit(part), 0.0] } else { [0.0, 1.0] };
                }
                growths.iter_mut().zip(walk(parts, states)).for_each(|(sum, size)| *sum += size);
            }
        }
        let mut injected = [[0.0; 2]; 4];
        injected.iter_mut().zip(parts).for_each(|(state, part)| *state = part.gains);
        let of_input = walk(parts, injected);
        let mut reach = 0.0;
        for (part, growth) in parts.iter().zip(growths) {
            let [u, v] = part.gains;
            let size = (u * unit(part)).abs().max(v.abs()) + reach * couple(part) * unit(part);
            reach = growth * size / (1.0 - libm::sqrt(1.0 - part.pole.delta()));
        }
        let largest = |sizes: [f64; 4]| sizes.into_iter().fold(0.0, f64::max);
        Self { growth: largest(growths), of_input: largest(of_input), reach }
    }
}

/// Largest size of each part over a tick that begins with these states.
fn walk(parts: &[Part<Pole>], mut states: [[f64; 2]; 4]) -> [f64; 4] {
    let mut sizes = [0.0f64; 4];
    for frame in 0..=TICK_FRAMES {
        let mut from_before = 0.0;
        for ((part, [u, v]), largest) in parts.iter().zip(&mut states).zip(&mut sizes) {
            let size = |u: f64, v: f64| (u * unit(part)).abs().max(v.abs());
            let sounding = *v;
            *largest = largest.max(size(*u, *v));
            if frame > 0 {
                let turn = part.pole.turn();
                *u -= turn * *v;
                *v += if part.pole.form == Form::Coupled { turn * *u } else { unit(part) * *u };
                *largest = largest.max(size(*u, *v));
                *u *= 1.0 - part.pole.delta();
                *largest = largest.max(size(*u, *v));
                *u += from_before * couple(part);
                *largest = largest.max(size(*u, *v));
            }
            from_before = sounding;
        }
    }
    sizes
}

fn unit(part: &Part<Pole>) -> f64 {
    f64::from(1u32 << part.pole.form.shift())
}

fn couple(part: &Part<Pole>) -> f64 {
    part.handed / part.pole.entry()
}
