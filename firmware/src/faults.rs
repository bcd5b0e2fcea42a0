//! What is wrong with the board at present, shown by a LED as a number of flashes.

use core::sync::atomic::{AtomicU32, Ordering};

/// A fault and its number of flashes. Where there are several the lowest number is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Fault {
    /// The kit in the flash sector is refused; the built-in kit plays.
    Kit = 2,
    /// The codec does not answer.
    Codec = 3,
    /// A piezo's channel is stuck at a rail.
    Piezo = 4,
    /// Sound was interrupted within the last seconds: a half came too late, or the stream began anew.
    Sound = 5,
    /// The ADC had to be started anew within the last seconds.
    Adc = 6,
}

static FAULTS: AtomicU32 = AtomicU32::new(0);

/// Says that a fault is there, or not.
pub fn set(fault: Fault, is_there: bool) {
    let bit = 1 << fault as u32;
    match is_there {
        true => FAULTS.fetch_or(bit, Ordering::Relaxed),
        false => FAULTS.fetch_and(!bit, Ordering::Relaxed),
    };
}

/// Flashes to show: 0 where all is well.
pub fn flashes() -> u32 {
    match FAULTS.load(Ordering::Relaxed) {
        0 => 0,
        faults => faults.trailing_zeros(),
    }
}
