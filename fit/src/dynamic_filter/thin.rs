//! From a filter at many times to the few breakpoints of a table.

use std::f64::consts::TAU;

use super::lattice::squared;
use super::response::BandHearing;
use super::{Breakpoint, Coefficients, Path, RATE_HZ};
use crate::bark::DampingLaw;

/// Most breakpoints of a table.
pub const MOST_BREAKPOINTS: usize = 32;
/// Straight lines between breakpoints keep each band's level this near to what it was, dB, as long as the number of breakpoints allows.
pub const THINNED_WITHIN_DB: f64 = 0.2;
/// The decay of a loop hangs on how little `|F|` takes from it on each way round: there `|F|` is to be so many times nearer.
const NEARER_AT_LOOPS: f64 = 8.0;
/// A band so far below its loudest is not looked at, dB.
const HEARD_DB: f64 = 50.0;

/// What is looked at: levels of the noise in bands, then those of the filter where loops are, dB.
struct Looked<'a> {
    bands: Vec<BandHearing>,
    loops: &'a [f64],
}

impl Looked<'_> {
    fn levels(&self, coefficients: &Coefficients, noise: f64) -> Vec<f64> {
        let squared = squared(coefficients);
        let db = |power: f64| 10.0 * power.max(1e-30).log10();
        let bands = self.bands.iter().map(|band| db(noise * noise * band.power(&squared)));
        let loops = self.loops.iter().map(|frequency| NEARER_AT_LOOPS * db(squared((TAU * frequency / RATE_HZ).cos())));
        bands.chain(loops).collect()
    }
}

/// Breakpoints of filters and levels of the noise at times, the first at 0: starts from both ends and adds the time at which a band is furthest off,
/// or the filter at the frequency (Hz) of a loop, until none is.
pub(crate) fn thin(law: &DampingLaw, times_s: &[f64], filters: &[Coefficients], noise: &[f64], loops: &[f64]) -> Path {
    let looked = Looked { bands: law.bands.iter().map(|band| BandHearing::new(band.bark)).collect(), loops };
    let levels: Vec<Vec<f64>> =
        filters.iter().zip(noise).map(|(filter, noise)| looked.levels(filter, *noise)).collect();
    let count = levels.first().map_or(0, Vec::len);
    let loudest: Vec<f64> =
        (0..count).map(|place| levels.iter().map(|levels| levels[place]).fold(f64::NEG_INFINITY, f64::max)).collect();
    // At a loop every level is heard.
    let heard_db = |place: usize| if place < looked.bands.len() { HEARD_DB } else { f64::INFINITY };
    let last = times_s.len().min(filters.len()).saturating_sub(1);
    let mut kept = vec![0, last];
    kept.dedup();
    while kept.len() < MOST_BREAKPOINTS {
        let mut worst = (THINNED_WITHIN_DB, None);
        for pair in kept.windows(2) {
            let &[from, to] = pair else { continue };
            for at in from + 1..to {
                let part = (times_s[at] - times_s[from]) / (times_s[to] - times_s[from]);
                let level = noise[from] + part * (noise[to] - noise[from]);
                let between = looked.levels(&filters[from].towards(&filters[to], part), level);
                for (place, ((now, meant), loudest)) in between.iter().zip(&levels[at]).zip(&loudest).enumerate() {
                    let error = (now - meant).abs();
                    if *meant > loudest - heard_db(place) && error > worst.0 {
                        worst = (error, Some(at));
                    }
                }
            }
        }
        let (_, Some(at)) = worst else { break };
        kept.push(at);
        kept.sort_unstable();
    }
    let points = kept.into_iter().filter_map(|at| {
        Some(Breakpoint { time_s: *times_s.get(at)?, coefficients: *filters.get(at)?, noise: *noise.get(at)? })
    });
    Path { points: points.collect() }
}
