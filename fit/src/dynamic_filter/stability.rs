//! The condition under which loops decay round each filter of a path, as the instrument checks it on load.

use std::f64::consts::TAU;

use super::closed_loop::BandPass;
use super::lattice::squared;
use super::response::near_poles;
use super::{Coefficients, Loop, Path, RATE_HZ};

/// `|F| Σ|B_s|` stays below this at every frequency and time: less than 1 by what interpolation between breakpoints may add.
pub const MOST_LOOP_GAIN: f64 = 0.998;
/// Frequencies at which that is looked at ...
const FREQUENCIES: usize = 512;
/// ... and so many on either side of each loop's centre, in parts of its width.
const NEAR: i32 = 64;
const PARTS: f64 = 16.0;

/// Largest `|F| Σ|B_s|` over frequencies and a path's breakpoints and the quarters between them.
pub fn loop_gain(path: &Path, loops: &[Loop]) -> f64 {
    largest_gain(&filters_of(path), loops)
}

/// The same for filters, with the band-passes that the instrument plays.
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

/// Filters of a path where the instrument looks at it.
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

/// Lowers gains until the loops are stable.
pub(crate) fn stabilise(path: &Path, loops: &mut [Loop]) {
    let filters = filters_of(path);
    // Each alone, then all together.
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
