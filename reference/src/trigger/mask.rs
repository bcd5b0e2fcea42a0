//! Mask of a channel: the level to which a strike's own ringing may rise without counting as a
//! strike.

use super::adc::TICK_FRAMES;

/// Delay of the mask behind the envelope in ticks, so that a rising strike does not mask itself.
const LATE_TICKS: usize = 2;
const PAST_TICKS: usize = 7;
/// Number of ticks for which a channel stays loud after its envelope has fallen into the noise.
const LOUD_TICKS: usize = 8;

pub(super) struct Mask {
    /// Decaying peak of the envelope, in counts.
    pub(super) level: f64,
    /// Largest envelope of 2 to 6 ticks ago, in counts.
    pub(super) crest: f64,
    past: Vec<f64>,
    loud_ticks: usize,
}

impl Mask {
    pub(super) fn new() -> Self {
        Self { level: 0.0, crest: 0.0, past: vec![0.0; PAST_TICKS], loud_ticks: 0 }
    }

    pub(super) fn struck(&mut self, envelope: f64) {
        self.level = self.level.max(envelope);
        self.loud_ticks = LOUD_TICKS;
    }

    pub(super) fn is_loud(&self) -> bool {
        self.loud_ticks > 0
    }

    pub(super) fn tick(&mut self, envelope: f64, noise_foot: f64, decay_per_s: f64, rate_hz: f64) {
        self.level *= (-decay_per_s * TICK_FRAMES as f64 / rate_hz).exp();
        self.past.insert(0, envelope);
        self.past.truncate(PAST_TICKS);
        self.loud_ticks = if envelope > noise_foot { LOUD_TICKS } else { self.loud_ticks.saturating_sub(1) };
        self.crest = 0.0;
        if self.is_loud() {
            self.level = self.level.max(self.past[LATE_TICKS]);
            self.crest = self.past[LATE_TICKS..].iter().copied().fold(0.0, f64::max);
        }
    }
}
