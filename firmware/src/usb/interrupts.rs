//! Interrupts of USB: the time of a transfer is noted first, the driver's handler follows.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use core::task::Poll;

use embassy_executor::InterruptExecutor;
use embassy_stm32::interrupt::typelevel::{self, Handler};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::USB_OTG_FS as OTG;
use embassy_stm32::pac::otg::regs::Gintmsk;
use embassy_stm32::{interrupt, peripherals, usb};
use embassy_sync::waitqueue::AtomicWaker;

use super::ends;
use crate::cycles;

/// Priority of the handler that notes the time, which takes 60 cycles: it need not wait for the
/// sound.
const NOTE_PRIORITY: Priority = Priority::P0;
/// Priority of the driver's handler, below that of the sound.
const DRIVER_PRIORITY: Priority = Priority::P2;
/// Priority of the task, below that of the driver's handler.
const TASK_PRIORITY: Priority = Priority::P3;

/// Number of the MIDI endpoint in both directions.
const MIDI_ENDPOINT: usize = 1;

/// Time at which the receive FIFO has last begun to fill, in core cycles.
static FILLED_AT: AtomicU32 = AtomicU32::new(0);
/// True while the driver's handler has to run.
static DRIVER_IS_DUE: AtomicBool = AtomicBool::new(false);
/// True while the driver holds a MIDI packet.
static HOLDS_PACKET: AtomicBool = AtomicBool::new(false);
/// Time at which that packet ended, in core cycles.
static ARRIVED_AT: AtomicU32 = AtomicU32::new(0);
/// True after a reset of the bus, until the sound has taken note of it.
static HOST_IS_NEW: AtomicBool = AtomicBool::new(false);
/// Waker of the part of the task that looks after resets of the bus.
pub(super) static BUS_RESET: AtomicWaker = AtomicWaker::new();

/// Executor of the task.
pub(super) static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

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
    let now = cycles::now();
    let mask = OTG.gintmsk().read();
    let active = Gintmsk(OTG.gintsts().read().0 & mask.0);
    if active.rxflvlm() {
        FILLED_AT.store(now, Ordering::Relaxed);
    }
    // Only the causes that are there are masked: a packet that comes meanwhile is still noted. This
    // access cannot corrupt a packet in a transmit FIFO (errata ES0182, ES0287): the driver writes
    // them in critical sections.
    OTG.gintmsk().write_value(Gintmsk(mask.0 & !active.0));
    DRIVER_IS_DUE.store(true, Ordering::Release);
    interrupt::I2C3_EV.pend();
}

#[interrupt]
fn I2C3_EV() {
    if DRIVER_IS_DUE.swap(false, Ordering::Acquire) {
        let flags = OTG.gintsts().read();
        if flags.rxflvl() && has_packet() && !HOLDS_PACKET.swap(true, Ordering::Relaxed) {
            ARRIVED_AT.store(FILLED_AT.load(Ordering::Relaxed), Ordering::Relaxed);
        }
        // SAFETY: `OTG_FS` asks for it, and this handler does not interrupt itself.
        unsafe {
            <usb::InterruptHandler<peripherals::USB_OTG_FS> as Handler<typelevel::OTG_FS>>::on_interrupt();
        }
        if flags.usbrst() {
            // A suspension before this reset is over. Told behind it, as after an erase in which
            // the cable was pulled and plugged in, it would leave the device suspended on a bus
            // that runs.
            OTG.gintsts().write(|w| w.set_usbsusp(true));
            forget_packets();
            HOST_IS_NEW.store(true, Ordering::Relaxed);
            BUS_RESET.wake();
        }
        // The driver itself masks and unmasks the other causes.
        OTG.gintmsk().modify(|w| {
            w.set_rxflvlm(true);
            w.set_iepint(true);
            w.set_oepint(true);
        });
    }
    ends::wake_sender();
}

#[interrupt]
fn SDIO() {
    // SAFETY: the interrupt is enabled by the start of the executor, and this is its handler.
    unsafe { EXECUTOR.on_interrupt() };
}

/// Returns true if the MIDI endpoint has taken a packet and not been opened for another one.
fn has_packet() -> bool {
    OTG.doeptsiz(MIDI_ENDPOINT).read().pktcnt() == 0
}

/// Disables the IN endpoints whose packet the host did not fetch before it reset the bus.
///
/// The driver does not: it would wait for ever for the end of that packet.
fn forget_packets() {
    for endpoint in [0, MIDI_ENDPOINT] {
        if OTG.diepctl(endpoint).read().epena() {
            OTG.diepctl(endpoint).modify(|w| {
                w.set_snak(true);
                w.set_epdis(true);
            });
        }
    }
}

/// Calls `poll`, which takes the packet that the driver holds if there is one. Returns its result
/// with the time at which the packet ended, in core cycles.
pub(super) fn with_arrival<T>(poll: impl FnOnce() -> Poll<T>) -> Poll<(T, u32)> {
    // Meanwhile the driver's handler does not run: it could take the next packet.
    interrupt::I2C3_EV.disable();
    let polled = poll();
    let at = ARRIVED_AT.load(Ordering::Relaxed);
    if polled.is_ready() {
        HOLDS_PACKET.store(false, Ordering::Relaxed);
    }
    // SAFETY: it was enabled before, since the task runs.
    unsafe { interrupt::I2C3_EV.enable() };
    polled.map(|polled| (polled, at))
}

/// Returns true once for each reset of the bus: another host may play from now on.
pub fn host_is_new() -> bool {
    HOST_IS_NEW.load(Ordering::Relaxed) && HOST_IS_NEW.swap(false, Ordering::Relaxed)
}

/// Returns true if a reset of the bus has not been served yet.
pub(super) fn reset_is_pending() -> bool {
    OTG.gintsts().read().usbrst()
}
