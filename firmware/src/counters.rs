//! Counters that the audio interrupt writes and the report task logs once a second.

use core::sync::atomic::{AtomicU32, Ordering};

/// Number that an interrupt writes and a task reads: a count, a maximum or a set of bits.
pub struct Counter(AtomicU32);

impl Counter {
    const fn new() -> Self {
        Self(AtomicU32::new(0))
    }

    /// Adds `more`, modulo 2^32.
    pub fn add(&self, more: u32) {
        self.0.fetch_add(more, Ordering::Relaxed);
    }

    /// Sets the counter to `value` if that is larger.
    pub fn keep_larger(&self, value: u32) {
        self.0.fetch_max(value, Ordering::Relaxed);
    }

    /// Sets the bits that are set in `value`.
    pub fn keep_bits(&self, value: u32) {
        self.0.fetch_or(value, Ordering::Relaxed);
    }

    /// Returns the value.
    pub fn get(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }

    /// Returns the value and sets the counter to 0.
    pub fn take(&self) -> u32 {
        self.0.swap(0, Ordering::Relaxed)
    }
}

macro_rules! counters {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => { $($(#[$doc])* pub static $name: Counter = Counter::new();)* };
}

counters! {
    /// Number of halves of the DMA buffer that were rendered, in time or late.
    HALVES,
    /// Number of halves that were heard again because they were not filled in time.
    MISSED_HALVES,
    /// Number of restarts of the I2S stream after a DMA error.
    STREAM_ERRORS,
    /// Number of restarts of the ADC after an overrun or a DMA error.
    ADC_RESTARTS,
    /// Number of frames of the ADC that were overwritten before they were read.
    LOST_ADC_FRAMES,
    /// Number of strikes that were played.
    STRIKES,
    /// Number of strikes that were put off to the next half, since so many were due in one.
    DELAYED_STRIKES,
    /// Number of decisions to leave modes out.
    SHEDS,
    /// Number of residuals, dynamic filters and biquads that strikes did not begin for want of
    /// time.
    REFUSED_STAGES,
    /// Number of events whose frame had already been rendered.
    LATE_EVENTS,
    /// Number of events that were refused: their pad or striker does not exist, too many wait, or
    /// the engine refuses them.
    REFUSED_EVENTS,
    /// Number of USB transfers that were received.
    USB_TRANSFERS,
    /// Number of short MIDI messages that the audio interrupt took.
    MIDI_MESSAGES,
    /// Number of MIDI messages that have no meaning for the board, or were damaged.
    MIDI_UNKNOWN,
    /// Number of short MIDI messages that were received over USB and found no room.
    USB_LOST,
    /// Number of MIDI packets that the USB host did not fetch.
    USB_UNSENT,
    /// Number of lines that are missing from the log because its queue, or the ring that a probe
    /// fetches, was full.
    UNLOGGED_LINES,
    /// Core cycles that the audio interrupt has spent since the last report.
    AUDIO_CYCLES,
    /// Core cycles of the dearest half since the last report.
    WORST_HALF_CYCLES,
    /// Bits set in the magnitude of any sample since the meter last took them.
    ///
    /// The highest set bit is that of the loudest sample. Full scale is 2^23.
    PEAK,
}
