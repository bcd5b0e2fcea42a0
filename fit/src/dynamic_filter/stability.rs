//! Stability of the loops round each filter of a path, as the instrument checks it on load.

use std::f64::consts::TAU;

use super::closed_loop::BandPass;
use super::lattice::squared;
use super::model::{Coefficients, Loop, Path, RATE_HZ};
use super::response::near_poles;

/// Bound on `|F| Σ|B_s|` at every frequency and time.
///
/// It is below 1 by the amount that interpolation between breakpoints may add.
pub const MOST_LOOP_GAIN: f64 = 0.998;
/// Number of frequencies, over the whole spectrum, at which the loop gain is computed.
const FREQUENCIES: usize = 512;
/// Number of frequencies on either side of a loop's centre at which the loop gain is computed.
const NEAR: i32 = 64;
/// Number of those frequencies in a width of the loop.
const PARTS: f64 = 16.0;

/// Largest `|F| Σ|B_s|` over frequencies, at a path's breakpoints and the quarters between them.
pub fn loop_gain(path: &Path, loops: &[Loop]) -> f64 {
    largest_gain(&filters_of(path), loops)
}

/// Largest `|F| Σ|B_s|` over filters and frequencies, with the band-passes that the instrument
/// plays.
fn largest_gain(filters: &[Coefficients], loops: &[Loop]) -> f64 {
    let bands: Vec<(BandPass, f64)> = loops.iter().map(|guide| (BandPass::of(guide), guide.gain)).collect();
    let wide = frequencies(loops).map(|frequency| TAU * frequency / RATE_HZ);
    let near_poles = filters.iter().flat_map(near_poles).filter(|_| !loops.is_empty());
    let gain_at = |angular: f64| {
        let loudest = filters.iter().map(|filter| squared(filter)(angular)).fold(0.0, f64::max).sqrt();
        loudest * bands.iter().map(|(band, gain)| (gain * band.magnitude(angular)).abs()).sum::<f64>()
    };
    wide.chain(near_poles).map(gain_at).fold(0.0, f64::max)
}

/// Filters of a path at which the instrument checks stability: breakpoints, and quarters between
/// them.
pub(crate) fn filters_of(path: &Path) -> Vec<Coefficients> {
    let points = path.points.iter().map(|point| point.coefficients);
    let between = path.points.windows(2).flat_map(|pair| {
        let at = |part| pair[0].coefficients.towards(&pair[1].coefficients, part);
        [0.25, 0.5, 0.75].map(at)
    });
    points.chain(between).collect()
}

fn frequencies(loops: &[Loop]) -> impl Iterator<Item = f64> + '_ {
    let wide = (1..FREQUENCIES).map(|at| 0.5 * RATE_HZ * (at as f64 / FREQUENCIES as f64).powi(2));
    let near = loops
        .iter()
        .flat_map(|guide| (-NEAR..=NEAR).map(|step| guide.frequency_hz + f64::from(step) / PARTS * guide.bandwidth_hz));
    wide.chain(near).filter(|frequency| (0.0..0.5 * RATE_HZ).contains(frequency))
}

/// Lowers the loops' gains until they are stable: each alone, then all together.
pub(crate) fn stabilise(path: &Path, loops: &mut [Loop]) {
    let filters = filters_of(path);
    for guide in loops.iter_mut() {
        let alone = std::slice::from_ref(guide);
        let gain = largest_gain(&filters, alone);
        if gain > MOST_LOOP_GAIN {
            guide.gain *= MOST_LOOP_GAIN / gain;
        }
    }
    let gain = largest_gain(&filters, loops);
    if gain > MOST_LOOP_GAIN {
        loops.iter_mut().for_each(|guide| guide.gain *= MOST_LOOP_GAIN / gain);
    }
}
