//! Interrupts of USB: the time of a transfer is noted first, the driver's handler follows.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::interrupt::typelevel::{self, Handler};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::USB_OTG_FS as OTG;
use embassy_stm32::pac::otg::vals::Pktstsd;
use embassy_stm32::{interrupt, peripherals, usb};
use embassy_sync::waitqueue::AtomicWaker;

use super::{EXECUTOR, ends};
use crate::cycles;

/// Priority of the handler that notes the time, which takes 35 cycles: it need not wait for the
/// sound.
const NOTE_PRIORITY: Priority = Priority::P0;
/// Priority of the driver's handler, below that of the sound.
const DRIVER_PRIORITY: Priority = Priority::P2;
/// Priority of the task, below that of the driver's handler.
const TASK_PRIORITY: Priority = Priority::P3;

/// Time of the last interrupt of the USB core, in core cycles.
static NOTED_AT: AtomicU32 = AtomicU32::new(0);
/// True while the driver's handler has to run.
static DRIVER_IS_DUE: AtomicBool = AtomicBool::new(false);
/// Time at which the packet ended that the driver holds, in core cycles.
static ARRIVED_AT: AtomicU32 = AtomicU32::new(0);
/// Waker of the part of the task that looks after resets of the bus.
pub(super) static BUS_RESET: AtomicWaker = AtomicWaker::new();

/// Proof for the driver that its handler is bound.
#[derive(Clone, Copy)]
pub(super) struct Bound;

// SAFETY: `OTG_FS` has `I2C3_EV` call the driver's handler each time.
unsafe impl typelevel::Binding<typelevel::OTG_FS, usb::InterruptHandler<peripherals::USB_OTG_FS>> for Bound {}

/// Sets the priorities of the interrupts, which must still be disabled.
pub(super) fn set_priorities() {
    interrupt::OTG_FS.set_priority(NOTE_PRIORITY);
    interrupt::I2C3_EV.set_priority(DRIVER_PRIORITY);
    interrupt::SDIO.set_priority(TASK_PRIORITY);
}

#[interrupt]
fn OTG_FS() {
    NOTED_AT.store(cycles::now(), Ordering::Relaxed);
    interrupt::OTG_FS.disable();
    DRIVER_IS_DUE.store(true, Ordering::Release);
    interrupt::I2C3_EV.pend();
}

#[interrupt]
fn I2C3_EV() {
    if DRIVER_IS_DUE.swap(false, Ordering::Acquire) {
        let flags = OTG.gintsts().read();
        if flags.rxflvl() && is_midi() {
            ARRIVED_AT.store(NOTED_AT.load(Ordering::Relaxed), Ordering::Relaxed);
        }
        // SAFETY: `OTG_FS` asks for it, and this handler does not interrupt itself.
        unsafe {
            <usb::InterruptHandler<peripherals::USB_OTG_FS> as Handler<typelevel::OTG_FS>>::on_interrupt();
        }
        if flags.usbrst() {
            forget_packets();
            BUS_RESET.wake();
        }
        // The line has been pending since `OTG_FS` began, also if it is quiet by now.
        interrupt::OTG_FS.unpend();
        // SAFETY: the handler shares atomics alone with other code.
        unsafe { interrupt::OTG_FS.enable() };
    }
    ends::wake_sender();
}

#[interrupt]
fn SDIO() {
    // SAFETY: the interrupt is enabled by the start of the executor, and this is its handler.
    unsafe { EXECUTOR.on_interrupt() };
}

/// Returns true if the next entry of the receive FIFO is data of the MIDI endpoint, the only one
/// beside endpoint 0.
fn is_midi() -> bool {
    let entry = OTG.grxstsr().read();
    entry.epnum() != 0 && entry.pktstsd() == Pktstsd::OUT_DATA_RX
}

/// Disables the IN endpoints whose packet the host did not fetch before it reset the bus.
///
/// The driver does not: it would wait for ever for the end of that packet.
fn forget_packets() {
    for endpoint in [0, 1] {
        if OTG.diepctl(endpoint).read().epena() {
            OTG.diepctl(endpoint).modify(|w| {
                w.set_snak(true);
                w.set_epdis(true);
            });
        }
    }
}

/// Calls `poll` while the driver's handler does not run, with the time at which the packet ended
/// that the driver holds.
pub(super) fn with_arrival<T>(poll: impl FnOnce(u32) -> T) -> T {
    interrupt::I2C3_EV.disable();
    let polled = poll(ARRIVED_AT.load(Ordering::Relaxed));
    // SAFETY: it was enabled before, since the task runs.
    unsafe { interrupt::I2C3_EV.enable() };
    polled
}

/// Returns true if a reset of the bus has not been served yet.
pub(super) fn reset_is_pending() -> bool {
    OTG.gintsts().read().usbrst()
}
