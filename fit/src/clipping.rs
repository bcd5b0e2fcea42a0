//! Values at which a sound is cut off where it is clipped, and the flat tops that clipping leaves.

use std::ops::Range;

/// Least size of a sound's smaller extreme relative to its larger one for it to be a limit, too.
/// Both limits lie equally far from 0 unless an offset was taken off, which is less than a third.
const OTHER_SIDE: f64 = 0.5;
/// Least number of equal samples in a flat top.
const FLAT: usize = 3;
/// Share of a limit from which on samples may be in a flat top.
const AT_LIMIT: f64 = 0.9999;
/// Least fall behind or before a flat top, in steps of the recording's resolution.
///
/// A round top of `n` equal samples falls by less than `((n + 1)/(n - 1))^2` steps to the sample
/// beside it, 4 for three samples: slow and quiet sounds in few bits are no clipped ones.
const LEAST_FALL: f64 = 4.0;

/// Extremes of a sound, at each of which it may be clipped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    low: f64,
    high: f64,
}

impl Limits {
    /// Limits of a sound: its lowest and its highest value, or one of them if the other one is less
    /// than half as large.
    pub(crate) fn of(samples: &[f64]) -> Self {
        let [low, high] = samples.iter().fold([0.0f64; 2], |[low, high], x| [low.min(*x), high.max(*x)]);
        let is_limit = |extreme: f64, other: f64| extreme.abs() >= OTHER_SIDE * other.abs();
        Self {
            low: if is_limit(low, high) { low } else { f64::NEG_INFINITY },
            high: if is_limit(high, low) { high } else { f64::INFINITY },
        }
    }

    /// True if a value has reached a share of one of the limits.
    pub(crate) fn are_reached(self, x: f64, share: f64) -> bool {
        x >= share * self.high || x <= share * self.low
    }
}

/// Flat tops of a sound: runs of three or more equal samples at one of its limits.
///
/// A round top that only looks flat in the sound's resolution is left out. The resolution is the
/// least difference between neighbouring samples.
pub(crate) fn flat_tops(samples: &[f64]) -> Vec<Range<usize>> {
    let limits = Limits::of(samples);
    let differences = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let step = differences.filter(|difference| *difference > 0.0).fold(f64::INFINITY, f64::min);
    let mut tops = Vec::new();
    let mut from = 0;
    for run in samples.chunk_by(|a, b| a == b) {
        let top = from..from + run.len();
        from = top.end;
        if run.len() < FLAT || !limits.are_reached(run[0], AT_LIMIT) {
            continue;
        }
        let beside = [top.start.checked_sub(1).and_then(|at| samples.get(at)), samples.get(top.end)];
        if beside.into_iter().flatten().any(|x| (x - run[0]).abs() > LEAST_FALL * step) {
            tops.push(top);
        }
    }
    tops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_tops_of_few_bits_are_not_flat_and_clipped_ones_are() {
        let sounds = [(30.0, 0.01, 2.0), (300.0, 0.02, 2.0), (300.0, 0.1, 0.9), (300.0, 0.1, -0.97)];
        for (steps, step_per_sample, top) in sounds {
            let sine = |n: u32| 0.5 * (step_per_sample * f64::from(n)).sin();
            let clipped = |x: f64| if top < 0.0 { x.max(0.5 * top) } else { x.min(0.5 * top) };
            let sound: Vec<f64> = (0..2_000).map(|n| (clipped(sine(n)) * 2.0 * steps).round() / steps).collect();
            let tops = flat_tops(&sound);
            assert_eq!(!tops.is_empty(), top < 1.0, "{steps} {top}: {tops:?}");
            assert!(tops.iter().all(|top| top.len() >= 3 && sound[top.clone()].iter().all(|x| *x == sound[top.start])));
        }
    }

    #[test]
    fn both_extremes_are_limits_also_where_an_offset_was_taken_off() {
        for offset in [0.0, 0.1, -0.3] {
            let limits = Limits::of(&[0.0, 1.0 - offset, -1.0 - offset, 0.3]);
            for (x, expected) in [(1.0 - offset, true), (-1.0 - offset, true), (0.9 - offset, false), (0.0, false)] {
                assert_eq!(limits.are_reached(x, 0.999), expected, "{x} with {offset}");
            }
        }
    }

    #[test]
    fn an_extreme_less_than_half_as_large_as_the_other_is_none() {
        let limits = Limits::of(&[0.9, -0.4, 0.1]);
        assert!(limits.are_reached(0.9, 0.999) && !limits.are_reached(-0.4, 0.999));
    }
}
