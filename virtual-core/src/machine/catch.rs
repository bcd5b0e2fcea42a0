//! Vector catch: a debug probe halts the core where it enters a fault, by bits of DEMCR (DDI 0403
//! C1.6.5).
//!
//! The emulated core keeps TRCENA alone of what a program writes to DEMCR. The machine adds the
//! rest, at the cost of a look at each store that goes to the system's registers.

use super::Machine;
use crate::cpu::Core;

/// Bits of DEMCR that a program can write: TRCENA and those of vector catch.
const WRITABLE: u32 = 1 << 24 | CATCHES;
/// Bits of vector catch: VC_HARDERR down to VC_MMERR, and VC_CORERESET.
const CATCHES: u32 = 0x7f1;
/// Bit of DEMCR that no program sets. It is lost if a store goes to DEMCR.
const MARK: u32 = 1 << 31;

impl Machine {
    /// Attaches a debug probe that catches hard faults, as `probe-rs run` does. The program may
    /// clear the bit by which the probe does so (VC_HARDERR), and it outlives a reset.
    pub fn catch_faults(&mut self) {
        self.has_probe = true;
        self.core.set_debug_monitor_control(self.core.debug_monitor_control() | 1 << 10);
    }
}

/// Returns true if a probe halts the core at the exception of this number.
pub(super) fn catches(core: &impl Core, exception: u16) -> bool {
    let bits = match exception {
        3 => 1 << 10,
        4 => 1 << 4,
        5 => 1 << 8,
        6 => 0b111 << 5,
        _ => 0,
    };
    core.debug_monitor_control() & bits != 0
}

/// Marks DEMCR before a store to the system's registers.
pub(super) fn before_store(core: &mut impl Core) {
    core.set_debug_monitor_control(core.debug_monitor_control() | MARK);
}

/// Sets the bits that a store of `value` has written to DEMCR, if it went there.
pub(super) fn after_store(core: &mut impl Core, value: u32) {
    let bits = core.debug_monitor_control();
    let went_there = bits & MARK == 0;
    core.set_debug_monitor_control(if went_there { value & WRITABLE } else { bits & !MARK });
}
