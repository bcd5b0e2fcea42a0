//! Constants of the board: clocks, wiring, number of LEDs. A feature chooses the board.

pub mod sector;
pub mod wiring;

#[cfg(feature = "blackpill-f411")]
mod blackpill_f411;
#[cfg(feature = "blackpill-f411")]
pub use blackpill_f411::*;

#[cfg(not(feature = "blackpill-f411"))]
mod stm32f407g_disc1;
#[cfg(not(feature = "blackpill-f411"))]
pub use stm32f407g_disc1::*;

/// Name of the board in the project, as in `malleus play --board`.
pub const NAME: &str = <Memory as boards::Board>::NAME;

// `malleus play --board` plays on the PC with the rate and the clock of the crate `boards`.
const _: () = {
    let ((a, b), (c, d)) = (CLOCKS.sample_rate_ratio(), <Memory as boards::Board>::RATE);
    assert!(a as u64 * d as u64 == c as u64 * b as u64, "boards/src and CLOCKS name different rates");
    let (linked, played) = (dsp_core::built::Built::HERE, <Memory as boards::Board>::BUILT);
    assert!(
        linked.biquads == played.biquads && linked.room == played.room,
        "boards/src and Cargo.toml name different stages"
    );
    assert!(CLOCKS.core_hz() == <Memory as boards::Board>::CORE_HZ, "boards/src and CLOCKS name different clocks");
};
