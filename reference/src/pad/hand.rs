//! A hand that chokes a pad's filters (biquads, dynamic filter): it damps their states after each
//! sample.
//!
//! A filter that falls by d nepers a second by itself keeps `e^{-max(0, d_c - d)/fs}` of its state
//! at each sample, with `d_c = ln(1000)/choke_t60_s`. So the faster of the two decays is heard, and
//! a ringing filter goes on without a step. A strike under the hand decays like the sound that
//! rings already.

use crate::rate::SampleRate;

/// Number of samples of a block, with which a [`BlockHand`] comes and goes.
pub(crate) const BLOCK_SAMPLES: u64 = 256;

/// Share of a dynamic filter's sound below which a hand ends it for good: -120 dB.
const MUTE: f64 = 1.0 / 1_048_576.0;

/// Decay that a hand imposes, and its effect so far on the dynamic filter.
pub(crate) struct Hand {
    per_sample: f64,
    left: f64,
    /// True from the time at which the dynamic filter was silenced to the next strike.
    spent: bool,
}

impl Hand {
    pub(crate) const AWAY: Self = Self { per_sample: 1.0, left: 1.0, spent: false };

    /// Lays the hand on: sound falls by 60 dB in `t60_s` seconds. Strikes to come do so as well.
    pub(crate) fn choke(&mut self, t60_s: f64, rate: SampleRate) {
        self.per_sample = (-1000f64.ln() / (t60_s * rate.hz())).exp();
    }

    /// Lifts the hand.
    pub(crate) fn release(&mut self) {
        *self = Self::AWAY;
    }

    /// Begins a new decay at a strike.
    pub(crate) fn begin(&mut self) {
        (self.left, self.spent) = (1.0, false);
    }

    /// True while the hand lies on the pad.
    pub(crate) fn is_here(&self) -> bool {
        self.per_sample < 1.0
    }

    /// Factor on the state of a filter whose sound falls by the factor `own` in this sample.
    pub(crate) fn keeps(&self, own: f64) -> f64 {
        if own > self.per_sample { self.per_sample / own } else { 1.0 }
    }

    /// Factor of [`Self::keeps`] for the dynamic filter, which is also added to its decay so far.
    /// The factor is 1 once the filter is silent.
    pub(crate) fn take(&mut self, own: f64) -> f64 {
        let kept = if self.spent { 1.0 } else { self.keeps(own) };
        self.left *= kept;
        kept
    }

    /// True once, when the dynamic filter has fallen below -120 dB.
    pub(crate) fn has_muted(&mut self) -> bool {
        let is_mute = self.left < MUTE;
        if is_mute {
            (self.left, self.spent) = (1.0, true);
        }
        is_mute
    }
}

/// A hand on the modes of an object in frames: it comes and goes with the block behind the next one
/// that begins, and rates add. A mode that falls by d falls by `d + d_c` under it.
#[derive(Clone, Copy, Default)]
pub(crate) struct BlockHand {
    is_wanted: bool,
    lies_next: bool,
    lies: bool,
}

impl BlockHand {
    pub(crate) fn lay(&mut self, is_wanted: bool) {
        self.is_wanted = is_wanted;
    }

    /// Begins a block.
    pub(crate) fn begin_block(&mut self) {
        self.lies = self.lies_next;
        self.lies_next = self.is_wanted;
    }

    /// Share of the sound that is left after each sample from 0 on; `None` without the hand.
    pub(crate) fn shares(&self, t60_s: f64, rate: SampleRate) -> Option<impl Iterator<Item = f64> + use<>> {
        let nepers = 1000f64.ln() / (t60_s * rate.hz());
        self.lies.then(|| (0u32..).map(move |n| (-nepers * f64::from(n)).exp()))
    }
}
