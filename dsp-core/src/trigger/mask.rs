//! Retrigger cancellation: the level that a strike's own ring may reach without being a strike.
//!
//! ```text
//! level = max(peak of the strike · e^(-mask_decay t),  crest of the envelope 1.3 to 4.3 ms ago)
//! ```
//!
//! A new onset must exceed the level by 3 dB. The first term covers beating rings, whose envelope
//! comes back. The second term covers rings that outlast the mask: it compares the envelope with
//! its own recent past. That past is at least half a period of 200 Hz long, and lies far enough
//! back that the rise of a strike does not mask itself.

use super::units::scale_q8;
use crate::SampleRate;
use crate::exponential;
use crate::time::TICK_FRAMES;

/// Envelope of an onset, in 1/256 of the mask's level: 1.4, or 3 dB.
const ONSET_Q8: i32 = 358;
/// Envelope to which an onset in a long ring is dated back, in 1/256 of the crest: 1.06.
const FOOT_Q8: i32 = 272;

/// Number of ticks whose envelopes are remembered.
const PAST_TICKS: usize = 8;
/// Ticks back from the present one whose largest envelope is the crest.
const CREST_TICKS: core::ops::Range<usize> = 2..7;

/// Decay of a mask in a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct MaskDecay {
    /// `1 - e^(-decay·T)` in Q16.
    loss_q16: i32,
}

impl MaskDecay {
    pub(super) fn new(decay_per_s: f32, rate: SampleRate) -> Self {
        let tick_s = TICK_FRAMES as f64 / rate.hz();
        Self { loss_q16: ((1.0 - exponential::exp(-f64::from(decay_per_s) * tick_s)) * 65_536.0) as i32 }
    }
}

/// Mask of one channel, in signal units of the envelope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mask {
    decaying: i32,
    crest: i32,
    past: [i32; PAST_TICKS],
    newest: usize,
    /// Ticks until the remembered envelopes are all within the noise.
    loud_ticks: u16,
}

impl Mask {
    pub(super) const UNSET: Self = Self { decaying: 0, crest: 0, past: [0; PAST_TICKS], newest: 0, loud_ticks: 0 };

    /// Masks the ring of a strike whose envelope reached `envelope`.
    pub(super) fn struck(&mut self, envelope: i32) {
        self.decaying = self.decaying.max(envelope);
        self.loud_ticks = PAST_TICKS as u16;
    }

    /// Envelope above which a new onset is noticed.
    pub(super) fn onset_level(&self) -> i32 {
        scale_q8(self.decaying, ONSET_Q8)
    }

    /// Envelope to which a new onset is dated back, from the crest 1.3 to 4.3 ms ago.
    pub(super) fn foot_level(&self) -> i32 {
        scale_q8(self.crest, FOOT_Q8)
    }

    /// True if neither the past nor a strike masks anything.
    pub(super) fn is_gone(&self) -> bool {
        self.loud_ticks == 0 && self.decaying == 0
    }

    /// True if one of the remembered envelopes is above the noise.
    pub(super) fn is_loud(&self) -> bool {
        self.loud_ticks > 0
    }

    /// Takes a tick's largest envelope at its end. As long as the envelope is above the noise's
    /// foot, the mask follows the past.
    pub(super) fn tick(&mut self, envelope: i32, noise_foot: i32, decay: MaskDecay) {
        if self.is_gone() && envelope <= noise_foot {
            return;
        }
        // Envelopes have up to 24 bits and losses 16: the product is taken in 64.
        let loss = (i64::from(self.decaying) * i64::from(decay.loss_q16)) >> 16;
        self.decaying = self.decaying.wrapping_sub(loss as i32).wrapping_sub(1).max(0);
        self.newest = (self.newest + 1) % PAST_TICKS;
        if let Some(slot) = self.past.get_mut(self.newest) {
            *slot = envelope;
        }
        self.loud_ticks = if envelope > noise_foot { PAST_TICKS as u16 } else { self.loud_ticks.saturating_sub(1) };
        // The envelope is taken late, so that a strike does not mask its own rise.
        let late = self.past.get(self.newest.wrapping_sub(CREST_TICKS.start) % PAST_TICKS).copied().unwrap_or(0);
        if self.loud_ticks > 0 {
            self.decaying = self.decaying.max(late);
        }
        self.crest = 0;
        if self.loud_ticks > 0 {
            for back in CREST_TICKS {
                let slot = self.newest.wrapping_sub(back) % PAST_TICKS;
                self.crest = self.crest.max(self.past.get(slot).copied().unwrap_or(0));
            }
        }
    }
}
