//! Cycle counter of the core (DWT CYCCNT), which wraps every 25 s at 168 MHz.

use cortex_m::Peripherals;
use cortex_m::peripheral::DWT;

/// Starts the counter.
pub fn start(core: &mut Peripherals) {
    core.DCB.enable_trace();
    core.DWT.enable_cycle_counter();
}

/// Returns the core cycles since the counter was started, modulo 2^32.
pub fn now() -> u32 {
    DWT::cycle_count()
}
