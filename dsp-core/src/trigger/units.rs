//! Units of a channel's samples.
//!
//! The ADC gives 12-bit counts. Inside the trigger a signal is in signal units of 1/256 of a count.

/// One ADC count in signal units.
pub(super) const COUNT: i32 = 256;
/// Half the ADC's range in counts.
pub(super) const FULL_COUNTS: f32 = 2048.0;
/// Half the ADC's range in signal units.
pub(super) const FULL_UNITS: i32 = 2048 * COUNT;
/// Largest 12-bit count.
pub(super) const LAST_COUNT: u16 = 4095;

/// Product `value · factor / 256`. Levels have up to 24 bits, so that it is taken in 64.
pub(super) fn scale_q8(value: i32, factor_q8: i32) -> i32 {
    ((i64::from(value) * i64::from(factor_q8)) >> 8) as i32
}
