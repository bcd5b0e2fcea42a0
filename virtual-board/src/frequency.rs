//! Frequencies as exact ratios, and times of periodic events in core cycles, whose rounding does
//! not add up.

use std::cmp::Ordering;
use std::fmt;

/// Frequency in Hz as a reduced ratio, so that the division of a crystal stays exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Frequency {
    numerator: u64,
    denominator: u64,
}

impl Frequency {
    /// Makes a frequency of a whole number of Hz.
    pub const fn hz(hz: u64) -> Frequency {
        Frequency { numerator: hz, denominator: 1 }
    }

    /// Returns `self * numerator / denominator`.
    ///
    /// A denominator of 0, which no register can hold after its check, counts as 1.
    pub fn scaled(self, numerator: u64, denominator: u64) -> Frequency {
        let (numerator, denominator) = (self.numerator * numerator, self.denominator * denominator.max(1));
        let divisor = greatest_common_divisor(numerator, denominator).max(1);
        Frequency { numerator: numerator / divisor, denominator: denominator / divisor }
    }

    /// Returns the numerator of the reduced ratio.
    pub fn numerator(self) -> u64 {
        self.numerator
    }

    /// Returns the denominator of the reduced ratio.
    pub fn denominator(self) -> u64 {
        self.denominator
    }

    /// Returns the frequency in Hz as a float.
    pub fn as_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// Returns the pace of events of this frequency in cycles of `core`.
    pub(crate) fn for_each(self, core: Frequency) -> Pace {
        let pace = self.scaled(core.denominator, core.numerator);
        Pace { events: pace.numerator, cycles: pace.denominator }
    }
}

impl PartialOrd for Frequency {
    fn partial_cmp(&self, other: &Frequency) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Frequency {
    fn cmp(&self, other: &Frequency) -> Ordering {
        let product = |a: u64, b: u64| u128::from(a) * u128::from(b);
        product(self.numerator, other.denominator).cmp(&product(other.numerator, self.denominator))
    }
}

impl fmt::Display for Frequency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.denominator == 1 {
            write!(f, "{} Hz", self.numerator)
        } else {
            write!(f, "{}/{} Hz", self.numerator, self.denominator)
        }
    }
}

fn greatest_common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// Pace of periodic events: `events` in `cycles` core cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pace {
    events: u64,
    cycles: u64,
}

impl Pace {
    /// Returns the number of events in the first `cycles` cycles. An event at cycle 0 is not
    /// counted.
    pub(crate) fn events_in(self, cycles: u64) -> u64 {
        // Division of 128 bits takes several times as long.
        if let Some(product) = cycles.checked_mul(self.events) {
            return product / self.cycles;
        }
        (u128::from(cycles) * u128::from(self.events) / u128::from(self.cycles)) as u64
    }

    /// Returns the first cycle at which `event` events have happened.
    pub(crate) fn cycle_of(self, event: u64) -> u64 {
        if let Some(product) = event.checked_mul(self.cycles) {
            return product.div_ceil(self.events);
        }
        (u128::from(event) * u128::from(self.cycles)).div_ceil(u128::from(self.events)) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_i2s_rate_of_the_discovery_board_is_exact() {
        let crystal = Frequency::hz(8_000_000);
        let rate = crystal.scaled(258, 8).scaled(1, 3).scaled(1, 256 * 7);
        assert_eq!(rate, Frequency::hz(86_000_000).scaled(1, 1792));
        assert!((rate.as_f64() - 47_991.071).abs() < 1e-3);
    }

    #[test]
    fn events_do_not_drift_against_the_core() {
        let core = Frequency::hz(168_000_000);
        let rate = Frequency::hz(86_000_000).scaled(1, 1792);
        let pace = rate.for_each(core);
        let hour = 3600 * 168_000_000;
        let events = pace.events_in(hour);
        assert_eq!(events, (3600.0 * 86e6 / 1792.0) as u64);
        for event in [1, 2, 1000, events] {
            let cycle = pace.cycle_of(event);
            assert_eq!((pace.events_in(cycle - 1), pace.events_in(cycle)), (event - 1, event));
        }
    }

    #[test]
    fn frequencies_compare_by_value() {
        assert!(Frequency::hz(47_991) < Frequency::hz(86_000_000).scaled(1, 1792));
        assert_eq!(Frequency::hz(96_000_000).scaled(1, 2), Frequency::hz(48_000_000));
    }
}
