//! Feedback delay network of one band.

use std::f64::consts::TAU;

use super::plan::{BLOCK_FRAMES, LINES, Plan};

/// Left and right output of a network for an input at the band's own rate. `hz` is the full rate.
///
/// The four delay lines hold pairs. The pairs that leave lines 0 and 2 turn by an angle that moves,
/// those that leave lines 1 and 3 by a fixed one. Pairs of lines 0 and 3 are reflected, those of 1
/// and 2 rotated, and those of 2 and 3 swap their halves. A 4 x 4 Hadamard matrix then mixes the
/// four pairs, and each result is written to the next line.
pub(super) fn render(plan: &Plan, input: &[f64], hz: f64) -> [Vec<f64>; 2] {
    let block = BLOCK_FRAMES / plan.division;
    let mut lines: Vec<Vec<[f64; 2]>> = plan.delays.iter().map(|&delay| vec![[0.0; 2]; delay]).collect();
    let mut out = [Vec::with_capacity(input.len()), Vec::with_capacity(input.len())];
    let fixed = (14_111f64 / 32_768.0).atan2(29_574.0 / 32_768.0).sin_cos();
    // At this angle both sides are equal on average. The energy is that of a pair of equals (x/2).
    let (sine, cosine) = 25f64.to_radians().sin_cos();
    let input_at = (cosine * 0.5f64.sqrt(), sine * 0.5f64.sqrt());
    for (frame, &x) in input.iter().enumerate() {
        let moving = turn(frame / block, frame % block / plan.held * plan.held, block, hz);
        let read = |line: usize| lines[line][frame].map(|value| plan.gains[line] * value);
        let reflected = |[a, b]: [f64; 2], (sine, cosine): (f64, f64)| [cosine * a + sine * b, sine * a - cosine * b];
        let rotated = |[a, b]: [f64; 2], (sine, cosine): (f64, f64)| [cosine * a - sine * b, sine * a + cosine * b];
        let added = |[a, b]: [f64; 2]| [a + input_at.1 * x, b + input_at.0 * x];
        let swapped = |[a, b]: [f64; 2]| [b, a];
        let r = [
            added(reflected(read(0), moving)),
            rotated(read(1), fixed),
            swapped(rotated(read(2), moving)),
            swapped(reflected(read(3), fixed)),
        ];
        for side in 0..2 {
            out[side].push(plan.output * (r[2][side] - r[3][side]));
        }
        const SIGNS: [[f64; 4]; 4] =
            [[1.0, 1.0, 1.0, 1.0], [1.0, -1.0, 1.0, -1.0], [1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0]];
        for (output, signs) in SIGNS.iter().enumerate() {
            let side = |side: usize| 0.5 * signs.iter().zip(&r).map(|(sign, r)| sign * r[side]).sum::<f64>();
            lines[(output + 1) % LINES].push([side(0), side(1)]);
        }
    }
    out
}

/// Sine and cosine of the moving angle at a sample of block `index`, counted from 0.
///
/// The angle swings by ±3 radians 1.9 times a second; sine and cosine are interpolated between half
/// blocks.
fn turn(index: usize, sample: usize, block: usize, hz: f64) -> (f64, f64) {
    let at = |half: usize| {
        let t = half as f64 * BLOCK_FRAMES as f64 / 2.0 / hz;
        (3.0 * (TAU * 1.9 * t).sin()).sin_cos()
    };
    let part = 2.0 * sample as f64 / block as f64;
    let half = part as usize;
    // The first block begins with the angle of half a block after the start.
    let (from, to) = (at(2 * index + half + 1), at(2 * index + half + 2));
    let part = part - half as f64;
    (from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1))
}
