//! One recording, many strikes: modes, gains and all forces by maximum likelihood together.
//!
//! ```text
//! sound ─► rises ─► free modes ─► changes ─► start ─► alignment ─► descend ─► estimate
//!          (ears'   (amplitudes    (matched   (grid     (common      (through     │
//!          bands)    of their own   to the     over τ    time of      the         │
//!                    in each gap)   modes)     and δ)    contacts)    contact)    │
//!                                                            ▲                    │
//!                                                            └──── completion ◄───┘
//! ```
//!
//! Recordings of several positions or strikers begin with `places` instead of `start`. For a
//! recording in a room, `in_room` alternates between these steps and an estimate of the room's
//! response (`reflections`). For one with clipped samples, `declipping` alternates between all
//! steps and those samples. [`estimate()`] needs no knowledge of the forces. The folder `joint`
//! fits modes and noise of one strike together; this one fits many strikes.

mod added_noise;
mod alignment;
mod amplitudes;
mod arrow;
mod begin;
mod changes;
mod clipping;
mod completion;
mod contact;
mod contact_grid;
mod declipping;
mod derivatives;
mod descend;
mod dry;
mod equations;
mod error;
mod estimate;
mod fading;
mod fit;
mod free;
#[cfg(test)]
mod hard_cases;
mod heard;
mod in_room;
mod layout;
mod model;
mod passes;
mod places;
#[cfg(test)]
mod random_strikes;
mod real_shapes;
mod reflections;
mod ringing;
mod rises;
mod seriation;
mod sought_anew;
mod spline;
mod start;
mod strikers;
pub mod synthetic;
mod table;
mod tied;
mod timing;
mod truth;
mod whitening;
mod zeros;

pub(crate) use clipping::is_clipped;
pub use error::StrikesError;
pub use estimate::{Estimate, ModeEstimate, StrikeEstimate, estimate, estimate_in_place};
pub use layout::Layout;
pub use table::{events, table};
pub use truth::cramer_rao;

/// Maximum length in seconds of a recording that `malleus fit --events` reads.
///
/// Its fit takes 3 GB of memory (`cargo bench -p fit --bench strikes -- time 1800`).
pub const LONGEST_S: f64 = 1800.0;
