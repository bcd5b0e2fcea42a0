//! Strikes that wait for the end of the sound before them.

use crate::event::Event;

/// Maximum number of strikes that wait for the end of a sound; more displace the oldest.
const WAITING: usize = 8;

/// Strikes that wait until the sound before them has ended, at most 5 ms.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    strikes: [Event; WAITING],
    count: usize,
}

impl Held {
    /// No strikes.
    pub(super) const NONE: Self = Self { strikes: [Event::NOTHING; WAITING], count: 0 };

    /// Lets a strike wait.
    pub(super) fn push(&mut self, strike: &Event) {
        // All begin in one frame, so their order does not matter.
        if let Some(place) = self.strikes.get_mut(self.count % WAITING) {
            *place = *strike;
            self.count += 1;
        }
    }

    /// Strikes that wait.
    pub(super) fn strikes(&self) -> &[Event] {
        self.strikes.get(..self.count.min(WAITING)).unwrap_or(&[])
    }

    /// True if no strike waits.
    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }
}
