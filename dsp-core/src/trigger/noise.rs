//! How much a quiet channel moves.

/// The mean of the envelope while nothing is struck. Falls at once, rises only when no strike has rung for a while, so that a roll is
/// not mistaken for noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoiseFloor {
    mean_q12: i32,
    quiet_ticks: u16,
}

/// Ticks without an onset before the floor may rise: about 0.15 s.
const QUIET_TICKS: u16 = 225;
/// Time constant, 2^6 ticks or 43 ms.
const SHIFT: u32 = 6;
/// The same while a channel warms up.
const FAST_SHIFT: u32 = 3;

impl NoiseFloor {
    pub(super) const UNSET: Self = Self { mean_q12: 0, quiet_ticks: QUIET_TICKS };

    /// The mean envelope in signal units.
    pub(super) fn mean(&self) -> i32 {
        self.mean_q12 >> 4
    }

    /// A strike begins.
    pub(super) fn struck(&mut self) {
        self.quiet_ticks = 0;
    }

    /// The end of a tick at rest with its samples' mean magnitude. Nothing rings: the floor goes where the noise goes.
    pub(super) fn rest(&mut self, magnitude: i32) {
        self.quiet_ticks = self.quiet_ticks.saturating_add(1);
        self.mean_q12 = self.mean_q12.wrapping_add((magnitude << 4).wrapping_sub(self.mean_q12) >> SHIFT);
    }

    /// The end of a tick with its envelope in signal units.
    pub(super) fn tick(&mut self, envelope: i32, warming_up: bool) {
        self.quiet_ticks = self.quiet_ticks.saturating_add(1);
        let error = (envelope << 4).wrapping_sub(self.mean_q12);
        if error < 0 || self.quiet_ticks > QUIET_TICKS {
            let shift = if warming_up { FAST_SHIFT } else { SHIFT };
            self.mean_q12 = self.mean_q12.wrapping_add(error >> shift);
        }
    }
}
