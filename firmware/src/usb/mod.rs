//! USB-MIDI: a class-compliant MIDI interface with one cable in each direction.
//!
//! ```text
//!            OTG_FS   notes the time, masks what caused it
//!               │
//!            I2C3_EV  runs the driver's handler, unmasks, wakes the sender
//!               │
//!             SDIO    polls the task: control requests, receiving, sending
//!    Incoming ◄─┤─► Sysex        messages of the host: short ones to the audio interrupt,
//!    Outgoing ─►┴◄─ Replies      SysEx to a task; the other way back
//! ```
//!
//! The peripherals I2C3 and SDIO are not used, so their interrupts are free for the program. Both
//! have priorities below that of the sound. The driver's handler takes up to 20 us and is not in
//! `OTG_FS`, so that the time of a transfer does not depend on what the core does.
//!
//! Nothing waits for the host: a transfer that the host does not fetch is given up after
//! [`SEND_TIMEOUT`](tasks::SEND_TIMEOUT), and a control request that the host breaks off ends at
//! the next reset of the bus. Suspended, unplugged, or without a host, the USB core is idle.

mod descriptors;
mod ends;
mod interrupts;
mod tasks;

use embassy_executor::InterruptExecutor;
use embassy_stm32::Peri;
use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_stm32::peripherals::{PA11, PA12, USB_OTG_FS};

pub use ends::{Incoming, Outgoing, Packet, Received, Replies, Sysex};

/// USB peripheral and its pins.
pub struct Port {
    /// USB core, full speed.
    pub peripheral: Peri<'static, USB_OTG_FS>,
    /// Pin of D+.
    pub dp: Peri<'static, PA12>,
    /// Pin of D-.
    pub dm: Peri<'static, PA11>,
}

/// Ends of the queues between USB and the rest of the program.
pub struct Ends {
    /// Short messages of the host, for the audio interrupt.
    pub incoming: Incoming,
    /// Short messages to the host, of the audio interrupt.
    pub outgoing: Outgoing,
    /// SysEx of the host, for a task.
    pub sysex: Sysex,
    /// SysEx to the host, of a task.
    pub replies: Replies,
}

static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// Starts USB: the host sees the board from now on.
///
/// Returns `None` if it has been called before.
pub fn start(port: Port) -> Option<Ends> {
    let (ends, inner) = ends::split()?;
    interrupts::set_priorities();
    let spawner = EXECUTOR.start(interrupt::SDIO);
    spawner.spawn(tasks::run(port, inner).ok()?);
    // SAFETY: the handler shares atomics and wakers alone with other code.
    unsafe { interrupt::I2C3_EV.enable() };
    Some(ends)
}
