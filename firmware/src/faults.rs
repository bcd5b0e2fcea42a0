//! Faults of the board that are present now, shown by a LED as a number of flashes.

use core::sync::atomic::{AtomicU32, Ordering};

/// Fault, with its number of flashes. If several are present, the lowest number is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Fault {
    /// The kit in the flash sector is refused; the built-in kit plays.
    Kit = 2,
    /// The codec does not answer.
    Codec = 3,
    /// The channel of a piezo is stuck at a rail.
    Piezo = 4,
    /// Sound was interrupted in the last 5 s: a half was late, or the I2S stream was restarted.
    Sound = 5,
    /// The ADC was restarted in the last 5 s.
    Adc = 6,
    /// The crystal does not start.
    Crystal = 7,
}

/// Present faults: bit `n` is set if the fault of `n` flashes is present.
static FAULTS: AtomicU32 = AtomicU32::new(0);

/// Notes that a fault is present, or that it is no longer.
pub fn set(fault: Fault, is_there: bool) {
    let bit = 1 << fault as u32;
    match is_there {
        true => FAULTS.fetch_or(bit, Ordering::Relaxed),
        false => FAULTS.fetch_and(!bit, Ordering::Relaxed),
    };
}

/// Returns the number of flashes to show, 0 if no fault is present.
pub fn flashes() -> u32 {
    match FAULTS.load(Ordering::Relaxed) {
        0 => 0,
        faults => faults.trailing_zeros(),
    }
}
