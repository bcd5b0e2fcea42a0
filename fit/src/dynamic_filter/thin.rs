//! Thinning: from a filter at many times to the few breakpoints of a table.

use super::lattice::squared;
use super::model::{Breakpoint, Coefficients, Path};
use super::response::NoiseBand;

/// Maximum number of breakpoints of a table.
pub const MOST_BREAKPOINTS: usize = 32;
/// Largest error in dB of a band's level between breakpoints, if their number allows.
pub const THINNED_WITHIN_DB: f64 = 0.2;
/// Distance in dB below a band's loudest level from which its errors are ignored.
const HEARD_DB: f64 = 50.0;

/// Breakpoints of filters at times, of which the first is 0.
///
/// Starts from both ends, and adds the time with the largest error of a band's level until every
/// error is small.
pub(crate) fn thin(times_s: &[f64], filters: &[Coefficients], bands: &[NoiseBand]) -> Path {
    let level = |coefficients: &Coefficients| -> Vec<f64> {
        let squared = squared(coefficients);
        bands.iter().map(|band| 10.0 * band.power(&squared).max(1e-30).log10()).collect()
    };
    let levels: Vec<Vec<f64>> = filters.iter().map(level).collect();
    let loudest: Vec<f64> = (0..bands.len())
        .map(|band| levels.iter().map(|levels| levels[band]).fold(f64::NEG_INFINITY, f64::max))
        .collect();
    let last = times_s.len().min(filters.len()).saturating_sub(1);
    let mut kept = vec![0, last];
    kept.dedup();
    while kept.len() < MOST_BREAKPOINTS {
        let mut worst = (THINNED_WITHIN_DB, None);
        for pair in kept.windows(2) {
            let &[from, to] = pair else { continue };
            for at in from + 1..to {
                let part = (times_s[at] - times_s[from]) / (times_s[to] - times_s[from]);
                let between = level(&filters[from].towards(&filters[to], part));
                for ((now, meant), loudest) in between.iter().zip(&levels[at]).zip(&loudest) {
                    let error = (now - meant).abs();
                    if *meant > loudest - HEARD_DB && error > worst.0 {
                        worst = (error, Some(at));
                    }
                }
            }
        }
        let (_, Some(at)) = worst else { break };
        kept.push(at);
        kept.sort_unstable();
    }
    let points = kept
        .into_iter()
        .filter_map(|at| Some(Breakpoint { time_s: *times_s.get(at)?, coefficients: *filters.get(at)?, noise: 1.0 }));
    Path { points: points.collect() }
}
