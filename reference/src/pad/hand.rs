//! A hand on what a pad sounds by filters: a gain that falls.

use crate::rate::SampleRate;

/// At 120 dB below nothing is left: the sound ends for good.
const MUTE: f64 = 1.0 / 1_048_576.0;

/// What the hand has left of the amplitude, and leaves of it after a sample.
pub(crate) struct Hand {
    left: f64,
    per_sample: f64,
}

impl Hand {
    pub(crate) const AWAY: Self = Self { left: 1.0, per_sample: 1.0 };

    /// Comes: the sound falls by 60 dB in `t60_s` from now on, and from each strike on.
    pub(crate) fn choke(&mut self, t60_s: f64, rate: SampleRate) {
        self.per_sample = (-1000f64.ln() / (t60_s * rate.hz())).exp();
    }

    /// Goes. What it has left stays until [`lift`](Self::lift).
    pub(crate) fn release(&mut self) {
        self.per_sample = 1.0;
    }

    /// Begins anew; gives what it had left.
    pub(crate) fn lift(&mut self) -> f64 {
        std::mem::replace(&mut self.left, 1.0)
    }

    /// What of a sample is left now.
    pub(crate) fn fade(&mut self, x: f64) -> f64 {
        let now = self.left;
        self.left *= self.per_sample;
        now * x
    }

    /// Whether it lets nothing through.
    pub(crate) fn is_mute(&self) -> bool {
        self.left < MUTE
    }
}
