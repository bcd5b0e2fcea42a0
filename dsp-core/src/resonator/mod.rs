//! The resonator: a bank of modes in fixed point.
//!
//! ```text
//!             set_position, set_choked
//!                      |
//! force --+-- guard -- | -- kernel (group 1) --+
//!         |            |    kernel (group 2) --+-- mix -- << mix exponent --+--> out
//!         |                 ...                                            |
//!         +------------------ onset (half of h[0]) -----------------------+
//! ```
//!
//! A mode is one of two second-order forms whose coefficients are small numbers ([`coefficient`]),
//! so that Q32 multipliers keep poles within 1e-5 of the unit circle exact to a few parts in 10^8.
//! Up to six modes of the same form share a group with one **block exponent** ([`group`]): as the
//! sound decays, the states are shifted up, so that they always use 28 to 29 bits. Without it a
//! mode of T60 20 s would ring on for ever at -78 dB, because its damping term rounds to nothing.
//! [`headroom`] proves that nothing wraps, [`retirement`] decides when an inaudible mode stops
//! costing time, and [`kernel`] is the hot loop.
//!
//! Bookkeeping happens at ticks of [`TICK_FRAMES`] frames counted from the engine's start, and
//! where a force outgrows the groups' allowance, which depends on the force alone. So no bit
//! depends on the caller's block size.

pub mod bank;
pub mod coefficient;
mod gain;
pub mod group;
pub mod headroom;
pub mod kernel;
pub mod mode;
mod order;
pub mod retirement;
mod table;

pub use bank::{
    Audience, Bank, BankSize, BankWork, HAND_MODES_PER_TICK, Origin, Place, Shed, ShedChoice, ShedPlan, UpcomingRun,
    Use,
};
pub use coefficient::max_decay_per_s;
pub(crate) use gain::gain_at;
pub use group::Group;
pub use mode::Mode;
pub(crate) use order::{below_nyquist, check_bank};
pub use retirement::Retirement;
pub use table::{BankError, BankTable};

pub use crate::time::TICK_FRAMES;
