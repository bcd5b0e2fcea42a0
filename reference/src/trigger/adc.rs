//! Constants of the ADC and of the tick.

/// Number of frames in a tick, after which offset, hum, noise and mask are updated.
pub const TICK_FRAMES: usize = 32;
/// Half the range of a 12-bit ADC, in counts.
pub const HALF_RANGE_COUNTS: f64 = 2048.0;
/// Largest count of a 12-bit ADC.
pub const LAST_COUNT: u16 = 4095;
