//! Panics and faults: the output is muted, the cause is logged, and the chip restarts.

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use embassy_stm32::pac::RCC;

use crate::{audio, board, last_words};

/// Cause of the chip's last start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Cause {
    /// Power was switched on.
    PowerOn,
    /// The reset pin was pulled, by a button or a programmer.
    Pin,
    /// The watchdog found that sound had stopped.
    Watchdog,
    /// The program restarted itself after a panic or a fault.
    Program,
}

impl Cause {
    /// Returns the cause of the last start and clears the chip's reset flags.
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

/// True once [`end`] has begun to log.
static ENDING: AtomicBool = AtomicBool::new(false);

/// Mutes the output, logs the cause by `tell`, and restarts the chip.
///
/// A panic inside `tell` comes here again and restarts the chip without logging.
fn end(tell: impl FnOnce()) -> ! {
    cortex_m::interrupt::disable();
    board::mute();
    audio::i2s::silence_now();
    if !ENDING.swap(true, Ordering::Relaxed) {
        tell();
    }
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end(|| {
        last_words::keep(format_args!("{info}"));
        defmt::error!("panic: {}; muted, starting again", defmt::Display2Format(info));
    })
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    let (at, from) = (frame.pc(), frame.lr());
    end(|| {
        last_words::keep(format_args!("hard fault at {at:#010x}, called from {from:#010x}"));
        defmt::error!("hard fault at {=u32:#010x}, called from {=u32:#010x}; muted, starting again", at, from);
    })
}

#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    end(|| defmt::error!("interrupt {=i16} came and nobody serves it; muted, starting again", interrupt))
}
