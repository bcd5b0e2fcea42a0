//! A hand on what a pad sounds by filters: after each sample it takes a share of all that they hold.
//!
//! A part of the pad that falls by d nepers a second by itself keeps `e^{-max(0, d_c - d)/fs}` of what it holds, `d_c = ln(1000)/choke_t60_s`: so the faster of both decays
//! is heard, what rings goes on without a step, and what is struck under the hand is treated as what rings.

use crate::rate::SampleRate;

/// At 120 dB below nothing is left of a dynamic filter: it ends for good.
const MUTE: f64 = 1.0 / 1_048_576.0;

/// What the hand wants left after a sample, and has left of a dynamic filter's sound.
pub(crate) struct Hand {
    per_sample: f64,
    left: f64,
    /// Whether it has taken all, until it begins anew.
    spent: bool,
}

impl Hand {
    pub(crate) const AWAY: Self = Self { per_sample: 1.0, left: 1.0, spent: false };

    /// Comes: sound is to fall by 60 dB in `t60_s` from now on, and from each strike on.
    pub(crate) fn choke(&mut self, t60_s: f64, rate: SampleRate) {
        self.per_sample = (-1000f64.ln() / (t60_s * rate.hz())).exp();
    }

    /// Goes.
    pub(crate) fn release(&mut self) {
        *self = Self::AWAY;
    }

    /// Begins anew, at a strike.
    pub(crate) fn begin(&mut self) {
        (self.left, self.spent) = (1.0, false);
    }

    /// Whether it lies there.
    pub(crate) fn is_here(&self) -> bool {
        self.per_sample < 1.0
    }

    /// What it leaves after this sample of a part of which `own` is left by itself.
    pub(crate) fn keeps(&self, own: f64) -> f64 {
        if own > self.per_sample { self.per_sample / own } else { 1.0 }
    }

    /// The same of a dynamic filter, while there is anything to take.
    pub(crate) fn take(&mut self, own: f64) -> f64 {
        let kept = if self.spent { 1.0 } else { self.keeps(own) };
        self.left *= kept;
        kept
    }

    /// Whether it has just left nothing.
    pub(crate) fn has_muted(&mut self) -> bool {
        let is_mute = self.left < MUTE;
        if is_mute {
            (self.left, self.spent) = (1.0, true);
        }
        is_mute
    }
}
