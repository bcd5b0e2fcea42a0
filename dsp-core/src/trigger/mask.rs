//! Retrigger cancellation: what a strike's own ringing may do without being a strike.
//!
//! ```text
//! level = max(peak of the strike · e^(-mask_decay t),  crest of the envelope 1.3 to 4.3 ms ago)
//! ```
//!
//! A new onset must exceed the level by [`OVER`]. The first term covers beating rings, whose envelope comes back; the second
//! covers rings that outlast the mask: it compares the envelope with its own recent past, over at least half a period of
//! 200 Hz and far enough back for the rise of a strike not to mask itself.

use super::TICK_FRAMES;
use crate::SampleRate;

/// How far the envelope must exceed the mask, in 1/256: 1.4, or 3 dB.
pub(super) const OVER_Q8: i32 = 358;

const PAST_TICKS: usize = 8;
/// The crest looks this many ticks back, and no nearer than the second.
const CREST_TICKS: core::ops::Range<usize> = 2..7;

/// How fast masks decay, by tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct MaskDecay {
    /// `1 - e^(-decay·T)` in Q16.
    loss_q16: i32,
}

impl MaskDecay {
    pub(super) fn new(decay_per_s: f32, rate: SampleRate) -> Self {
        let tick_s = TICK_FRAMES as f64 / rate.hz();
        Self { loss_q16: ((1.0 - libm::exp(-f64::from(decay_per_s) * tick_s)) * 65_536.0) as i32 }
    }
}

/// The mask of one channel, in signal units of the envelope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mask {
    decaying: i32,
    crest: i32,
    past: [i32; PAST_TICKS],
    newest: usize,
    /// Ticks until the past is too quiet to matter.
    loud_ticks: u16,
}

impl Mask {
    pub(super) const UNSET: Self = Self { decaying: 0, crest: 0, past: [0; PAST_TICKS], newest: 0, loud_ticks: 0 };

    /// A strike whose envelope reached `envelope` was decided.
    pub(super) fn struck(&mut self, envelope: i32) {
        self.decaying = self.decaying.max(envelope);
        self.loud_ticks = PAST_TICKS as u16;
    }

    /// What the envelope is measured against.
    pub(super) fn level(&self) -> i32 {
        self.decaying
    }

    /// What rang 1.3 to 4.3 ms ago.
    pub(super) fn crest(&self) -> i32 {
        self.crest
    }

    /// Whether neither the past nor a strike masks anything.
    pub(super) fn is_gone(&self) -> bool {
        self.loud_ticks == 0 && self.decaying == 0
    }

    /// Whether the past is loud enough to matter.
    pub(super) fn is_loud(&self) -> bool {
        self.loud_ticks > 0
    }

    /// The end of a tick with its largest envelope; as long as that is above the noise's foot, the past says what still rings.
    pub(super) fn tick(&mut self, envelope: i32, noise_foot: i32, decay: MaskDecay) {
        if self.is_gone() && envelope <= noise_foot {
            return;
        }
        // Envelopes have 24 bits at most and losses 16: the product is taken in 64.
        let loss = (i64::from(self.decaying) * i64::from(decay.loss_q16)) >> 16;
        self.decaying = self.decaying.wrapping_sub(loss as i32).wrapping_sub(1).max(0);
        self.newest = (self.newest + 1) % PAST_TICKS;
        if let Some(slot) = self.past.get_mut(self.newest) {
            *slot = envelope;
        }
        self.loud_ticks = if envelope > noise_foot { PAST_TICKS as u16 } else { self.loud_ticks.saturating_sub(1) };
        // A strike must not mask its own rise: the follower takes the envelope late.
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
