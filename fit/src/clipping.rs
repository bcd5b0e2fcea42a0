//! Values at which a sound is cut off where it is clipped.

/// Least size of a sound's smaller extreme relative to its larger one for it to be a limit, too.
/// Both limits lie equally far from 0 unless an offset was taken off, which is less than a third.
const OTHER_SIDE: f64 = 0.5;

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

#[cfg(test)]
mod tests {
    use super::*;

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
