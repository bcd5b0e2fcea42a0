//! One band's feedback delay network.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use super::{Plan, TICK_FRAMES};

/// Both outputs of a network for an input at its own rate. `hz` is the full rate.
pub(super) fn render(plan: &Plan, input: &[f64], hz: f64) -> [Vec<f64>; 2] {
    let block = TICK_FRAMES / plan.division;
    let mut lines: Vec<Vec<f64>> = plan.delays.iter().map(|&delay| vec![0.0; delay]).collect();
    let mut out = [Vec::with_capacity(input.len()), Vec::with_capacity(input.len())];
    for (frame, &x) in input.iter().enumerate() {
        let read = |line: usize| plan.gains[line] * lines[line][frame];
        let [sine, cosine] = turn(frame / block, frame % block, block, hz);
        let mut y = [0.0; 8];
        for pair in 0..4 {
            let (a, b) = (read(2 * pair), read(2 * pair + 1));
            (y[2 * pair], y[2 * pair + 1]) = match pair {
                0 | 1 => (cosine * a + sine * b, cosine * b - sine * a),
                _ => ((a + b) * FRAC_1_SQRT_2, (a - b) * FRAC_1_SQRT_2),
            };
        }
        for stride in [2, 4] {
            for i in (0..8).filter(|i| i & stride == 0) {
                let (a, b) = (y[i], y[i + stride]);
                (y[i], y[i + stride]) = ((a + b) * FRAC_1_SQRT_2, (a - b) * FRAC_1_SQRT_2);
            }
        }
        const SIGNS: [f64; 8] = [1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0];
        for (output, y) in y.iter().enumerate() {
            lines[(output + 3) % 8].push(y + SIGNS[output] * x / 16.0);
        }
        out[0].push(plan.output * y[0]);
        out[1].push(plan.output * y[3]);
    }
    out
}

/// Sine and cosine of the mix's angle in a tick counted from 0: a swing of ±6 radians 1.9 times a second, on a straight line between
/// ticks, held for eight samples.
fn turn(tick: usize, sample: usize, block: usize, hz: f64) -> [f64; 2] {
    let at = |tick: usize| {
        let t = tick as f64 * TICK_FRAMES as f64 / hz;
        (6.0 * (TAU * 1.9 * t).sin()).sin_cos()
    };
    let part = (sample / 8 * 8) as f64 / block as f64;
    // The first tick's angle is that of one tick after the start.
    let (from, to) = (at(tick + 1), at(tick + 2));
    [from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1)]
}
