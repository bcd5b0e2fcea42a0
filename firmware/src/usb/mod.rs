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

use embassy_stm32::interrupt::{self, InterruptExt};

pub use ends::{Ends, Incoming, Outgoing, Packet, Received, Replies, Sysex};
pub use interrupts::host_is_new;
pub use tasks::Port;

/// Starts USB: the host sees the board from now on.
///
/// Returns `None` if it has been called before.
pub fn start(port: Port) -> Option<Ends> {
    let (ends, inner) = ends::split()?;
    interrupts::set_priorities();
    let spawner = interrupts::EXECUTOR.start(interrupt::SDIO);
    spawner.spawn(tasks::run(port, inner).ok()?);
    // SAFETY: the handler shares atomics and wakers alone with other code.
    unsafe { interrupt::I2C3_EV.enable() };
    Some(ends)
}
