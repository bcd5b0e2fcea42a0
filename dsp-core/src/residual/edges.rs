//! Edges: the distance that a band keeps from an edge that it shares with a weaker one.
//!
//! By the law, noise that sets in at a strike and falls is heard a little beyond its band's edges:
//! the faster it falls, the more. A frame's lines are blurred by its window, always by as much. So
//! a band's outermost line is made just strong enough to leave beyond the edge what the law leaves
//! there. Its strength depends on the place of the edge between two lines, and is settled when the
//! band is loaded.

use crate::fourier::MAX_POINTS;

/// Number of lines per (cycle/sample).
const LINES: f64 = 2.0 * MAX_POINTS as f64;
/// Share of a line's energy beyond a place, by the distance to it in quarters of a line: the power
/// spectrum of a frame's window from there on.
const BEYOND: [f32; 23] = [
    0.5, 0.2875, 0.1295, 0.0469, 0.0213, 0.0190, 0.0167, 0.0104, 0.0049, 0.0029, 0.0028, 0.0023, 0.0013, 0.0007,
    0.0005, 0.0005, 0.0004, 0.0003, 0.0002, 0.0002, 0.0002, 0.0001, 0.0001,
];
const QUARTERS: f32 = 4.0;
/// Share of what the law has beyond an edge that the lines bring. The rest comes by itself, because
/// a strike's own frame begins as abruptly as the law does. (Found with random tables:
/// host-tests/tests/stages/residual.rs.)
const BY_LINES: f64 = 0.5;
/// Least number of lines that are left of a band that keeps away from both of its edges.
const LEFT: f64 = 0.6;
/// Largest distance that a band keeps from an edge, in lines: those further inside leave next to
/// nothing beyond.
const MOST: f64 = 1.3;

/// Distances that a band keeps from its lower and its upper edge if nothing lies beyond them. All
/// in cycles/sample; the decay in dB a sample.
pub(super) fn retreats([lower, upper]: [f64; 2], decay_db: f64) -> [f32; 2] {
    let lines = (upper - lower) * LINES;
    let most = (0.5 * (lines - LEFT)).clamp(0.0, MOST);
    let leak = (BY_LINES * lines_beyond(lines, decay_db * LINES)) as f32;
    // Distance of the first line inside, from -1/2 to 1/2: it has half a line's width on either
    // side.
    let first = |edge: f64| libm::ceil(edge - 0.5) - edge;
    [lower, -upper].map(|edge| (f64::from(retreat(first(edge * LINES) as f32, leak)).min(most) / LINES) as f32)
}

/// Energy that the law has beyond an edge, in lines: noise that falls by e^(-at) has the spectrum
/// of a resonance of half-width a/2π about each frequency of its band.
fn lines_beyond(lines: f64, decay_db: f64) -> f64 {
    let half_width = decay_db * (core::f64::consts::LN_10 / 20.0 / core::f64::consts::TAU);
    if half_width > 0.0 {
        half_width / core::f64::consts::PI * (1.0 + libm::log(1.0 + lines / half_width))
    } else {
        0.0
    }
}

/// Distance in lines to an edge whose first line lies `first` lines inside, such that at most
/// `leak` lines' energy is beyond the edge.
fn retreat(first: f32, leak: f32) -> f32 {
    let mut sum = 0.0;
    for line in [5.0, 4.0, 3.0, 2.0, 1.0, 0.0] {
        let own = beyond(first + line);
        if sum + own > leak {
            let part = ((leak - sum) / own).max(0.0);
            return (first + line + 0.5 - part).max(0.0);
        }
        sum += own;
    }
    0.0
}

/// Share of a line's energy beyond a place that lies `x` lines away from it; on its other side if
/// negative.
fn beyond(x: f32) -> f32 {
    let place = x.abs() * QUARTERS;
    let below = place as usize;
    let at = |index: usize| BEYOND.get(index).copied().unwrap_or(0.0);
    let share = at(below) + (place - below as f32) * (at(below + 1) - at(below));
    if x < 0.0 { 1.0 - share } else { share }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};
    use std::vec::Vec;

    #[test]
    fn the_blur_of_a_line_is_that_of_a_frames_window() {
        const FRAMES: usize = 512;
        let window = |n: usize| {
            let quarters = (n as f64 + 0.5) / FRAMES as f64 * 4.0;
            (PI / 2.0 * quarters.min(4.0 - quarters).min(1.0)).sin()
        };
        let power = |lines: f64| {
            let sum = (0..FRAMES).fold((0.0, 0.0), |(re, im), n| {
                let (sin, cos) = (TAU * lines * n as f64 / FRAMES as f64).sin_cos();
                (re + window(n) * cos, im + window(n) * sin)
            });
            (sum.0 * sum.0 + sum.1 * sum.1) / FRAMES as f64 / (0..FRAMES).map(|n| window(n).powi(2)).sum::<f64>()
        };
        const STEPS: usize = 8;
        let step = 1.0 / f64::from(QUARTERS) / STEPS as f64;
        let powers: Vec<f64> = (0..STEPS * 4 * 16).map(|at| power((at as f64 + 0.5) * step) * step).collect();
        for (quarters, &share) in BEYOND.iter().enumerate() {
            let exact: f64 = powers[quarters * STEPS..].iter().sum();
            assert!((f64::from(share) - exact).abs() < 0.0004, "{quarters} quarters: {share}, exactly {exact:.4}");
        }
    }

    #[test]
    fn a_band_keeps_a_part_of_its_width_and_keeps_the_further_away_the_slower_it_falls() {
        for lines in [0.1, 0.5, 1.0, 1.5, 3.0, 5.3, 50.0] {
            for lower in [0.0, 1.2, 7.5, 8.7] {
                let edges = [lower / LINES, (lower + lines) / LINES];
                let of = |decay_db_per_s: f64| retreats(edges, decay_db_per_s / 48_000.0);
                let mut before = of(0.0);
                for decay_db_per_s in [1.0, 20.0, 100.0, 400.0, 2_000.0] {
                    let now = of(decay_db_per_s);
                    let left = lines / LINES - f64::from(now[0] + now[1]);
                    assert!(left > 0.99 * lines.min(LEFT) / LINES, "{lines} lines: {left}");
                    for (now, before) in now.iter().zip(before) {
                        assert!((0.0..=before).contains(now), "{lines} lines, {decay_db_per_s} dB/s: {now} {before}");
                    }
                    before = now;
                }
            }
        }
    }
}
