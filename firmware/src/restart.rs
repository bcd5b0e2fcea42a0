//! Panics and faults: the output is muted, the cause is logged, and the chip restarts.

use core::fmt;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SCB;
use cortex_m::peripheral::scb::Exception;
use cortex_m_rt::exception;
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

/// Mutes the output, keeps and logs the cause, and restarts the chip.
///
/// A panic while the words are written comes here again and restarts the chip without logging.
fn end(cause: fmt::Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    board::mute();
    audio::i2s::silence_now();
    if !ENDING.swap(true, Ordering::Relaxed) {
        last_words::keep(cause);
        defmt::error!("{}; muted, starting again", defmt::Display2Format(&cause));
    }
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end(format_args!("panic: {info}"))
}

/// Bytes of stack below which a fault is taken for an overflow: the frame of an exception with the
/// registers of the FPU, and what one instruction pushes.
const SPENT_BYTES: i32 = 256;

/// Lets faults of the bus come here by an exception of their own, and in spite of a probe.
///
/// The frame of a fault in a full stack does not fit, which is a second fault. It needs a level
/// above that of the first one. A probe that catches faults would halt the core before it has
/// muted, while the DMA plays the last frames again and again.
pub fn watch_faults(core: &mut cortex_m::Peripherals) {
    core.SCB.enable(Exception::BusFault);
    // SAFETY: no bit of this register concerns memory.
    unsafe { core.DCB.demcr.modify(|bits| bits & !CATCH_FAULTS) };
}

/// Bits of DEMCR by which a probe halts the core at faults: VC_HARDERR down to VC_MMERR.
const CATCH_FAULTS: u32 = 0x7F0;

// Both handlers run on a fresh stack, since the old one may be full. They pass on where the fault
// was, if its frame is in memory, and how much of the old stack was left. FPCCR.LSPACT is cleared:
// registers of the FPU that wait to be stacked must not be written to a place that may not exist.
core::arch::global_asm!(
    ".section .text.faults, \"ax\", %progbits",
    ".balign 4",
    ".global HardFault",
    ".type HardFault, %function",
    ".thumb_func",
    "HardFault:",
    ".global BusFault",
    ".type BusFault, %function",
    ".thumb_func",
    "BusFault:",
    "mrs r3, msp",
    "ldr r2, =_stack_end",
    "subs r2, r3, r2",
    "itt pl",
    "ldrpl r0, [r3, #24]",
    "ldrpl r1, [r3, #20]",
    "ldr r3, =_stack_start",
    "msr msp, r3",
    "ldr r3, =0xE000EF34",
    "ldr r12, [r3]",
    "bic r12, r12, #1",
    "str r12, [r3]",
    "b {fault}",
    ".ltorg",
    fault = sym fault,
);

/// Ends the program for a fault at `at`, in a function that `from` called, with `left` bytes of
/// stack left.
extern "C" fn fault(at: u32, from: u32, left: i32) -> ! {
    if left < SPENT_BYTES {
        end(format_args!("stack overflow"));
    }
    end(format_args!("hard fault at {at:#010x}, called from {from:#010x}"))
}

#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    end(format_args!("interrupt {interrupt} came and nobody serves it"))
}
