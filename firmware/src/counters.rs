//! What is counted: written in the audio interrupt, told over defmt once a second.

use core::sync::atomic::{AtomicU32, Ordering};

/// A count since the start, or a maximum.
pub struct Counter(AtomicU32);

impl Counter {
    const fn new() -> Self {
        Self(AtomicU32::new(0))
    }

    /// Adds; wraps after 2^32.
    pub fn add(&self, more: u32) {
        self.0.fetch_add(more, Ordering::Relaxed);
    }

    /// Keeps the larger value.
    pub fn keep_larger(&self, value: u32) {
        self.0.fetch_max(value, Ordering::Relaxed);
    }

    /// Adds the bits that a value has.
    pub fn keep_bits(&self, value: u32) {
        self.0.fetch_or(value, Ordering::Relaxed);
    }

    /// The value.
    pub fn get(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }

    /// The value, and 0 from now on.
    pub fn take(&self) -> u32 {
        self.0.swap(0, Ordering::Relaxed)
    }
}

macro_rules! counters {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => { $($(#[$doc])* pub static $name: Counter = Counter::new();)* };
}

counters! {
    /// Halves that were rendered in time or late.
    HALVES,
    /// Halves that were heard again because they were not filled in time.
    MISSED_HALVES,
    /// Restarts of the I2S stream after a DMA error.
    STREAM_ERRORS,
    /// Times that the ADC had stopped, by an overrun or a DMA error, and was started again.
    ADC_RESTARTS,
    /// Frames of the ADC that were overwritten before they were read.
    LOST_ADC_FRAMES,
    /// Strikes that were played.
    STRIKES,
    /// Decisions to leave modes out.
    SHEDS,
    /// Residuals, dynamic filters and biquads that strikes did not begin for want of time.
    REFUSED_STAGES,
    /// Events whose frame had passed.
    LATE_EVENTS,
    /// Events that could not be: no such pad, too many at once.
    REFUSED_EVENTS,
    /// Lines that are missing from the log, because it was full.
    UNLOGGED_LINES,
    /// Cycles of the audio interrupt since the last report.
    AUDIO_CYCLES,
    /// The dearest half since the last report, cycles.
    WORST_HALF_CYCLES,
    /// The bits of the samples since it was last shown: its highest is that of the loudest, of 23.
    PEAK,
}
