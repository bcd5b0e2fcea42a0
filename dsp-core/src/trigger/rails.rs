//! Rails: the ends of the ADC's range, at which a channel with a broken piezo or wire lies.

use super::report::Fault;

/// Ticks at a rail after which a channel counts as stuck: 20 ms at 48 kHz, see
/// [`STUCK_S`](super::STUCK_S).
const STUCK_TICKS: u16 = 30;
/// Ticks away from the rails after which a stuck channel counts as well: 100 ms at 48 kHz.
const WELL_TICKS: u16 = 150;
/// Largest sum of a tick's samples, in counts, all of which were at the lower rail.
const LOW_RAIL: i32 = 32 * 15;
/// Smallest sum of a tick's samples, in counts, all of which were at the upper rail.
const HIGH_RAIL: i32 = 32 * 4080;

/// Change in a channel's health.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// The channel is stuck at a rail.
    Failed(Fault),
    /// The channel has left the rail.
    Recovered,
}

/// Watch over the rails of one channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rails {
    /// Fault of the channel; `None` if the channel is well.
    pub(super) fault: Option<Fault>,
    /// Number of successive ticks that speak against the present state.
    ticks: u16,
}

impl Rails {
    pub(super) const UNSET: Self = Self { fault: None, ticks: 0 };

    /// Takes the sum of a tick's 32 samples in counts.
    ///
    /// After a recovery the caller starts the channel afresh, this watch included.
    pub(super) fn watch(&mut self, sum: i32) -> Option<Change> {
        let rail = match sum {
            ..=LOW_RAIL => Some(Fault::StuckLow),
            HIGH_RAIL.. => Some(Fault::StuckHigh),
            _ => None,
        };
        self.ticks = if rail.is_some() == self.fault.is_some() { 0 } else { self.ticks.saturating_add(1) };
        match (self.fault, rail) {
            (None, Some(fault)) if self.ticks >= STUCK_TICKS => {
                *self = Self { fault: Some(fault), ticks: 0 };
                Some(Change::Failed(fault))
            }
            (Some(_), None) if self.ticks >= WELL_TICKS => Some(Change::Recovered),
            _ => None,
        }
    }

    /// Does the work of [`watch`](Self::watch) for a channel that is well and away from the rails.
    pub(super) fn clear(&mut self) {
        self.ticks = 0;
    }
}

/// True if the sum of a tick's samples, in counts, is away from both rails.
pub(super) fn are_far(sum: i32) -> bool {
    (LOW_RAIL + 1..HIGH_RAIL).contains(&sum)
}
