//! The end: silence, a word about why, and a fresh start.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use embassy_stm32::pac::RCC;

use crate::{audio, board};

/// Why the chip started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Cause {
    /// Power came.
    PowerOn,
    /// The reset pin, or a programmer.
    Pin,
    /// The watchdog: sound had stopped.
    Watchdog,
    /// The program itself, after a panic or a fault.
    Program,
}

impl Cause {
    /// Reads and clears the chip's reset flags.
    pub fn take() -> Self {
        let flags = RCC.csr().read();
        RCC.csr().modify(|w| w.set_rmvf(true));
        if flags.wdgrstf() || flags.wwdgrstf() {
            Self::Watchdog
        } else if flags.sftrstf() {
            Self::Program
        } else if flags.porrstf() || flags.borrstf() {
            Self::PowerOn
        } else {
            Self::Pin
        }
    }
}

fn mute_and_restart() -> ! {
    board::mute();
    audio::i2s::silence_now();
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    board::mute();
    audio::i2s::silence_now();
    defmt::error!("panic: {}; muted, starting again", defmt::Display2Format(info));
    mute_and_restart()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    board::mute();
    audio::i2s::silence_now();
    defmt::error!("hard fault at {=u32:#010x}, called from {=u32:#010x}; muted, starting again", frame.pc(), frame.lr());
    mute_and_restart()
}

#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    board::mute();
    audio::i2s::silence_now();
    defmt::error!("interrupt {=i16} came and nobody serves it; muted, starting again", interrupt);
    mute_and_restart()
}
