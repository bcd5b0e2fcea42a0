//! The room of a recording of many strikes at one place, and the strikes that are heard in it.
//!
//! ```text
//! free modes ─► presence ─► onset ─────────► answer ─► dried sound ─► strikes anew
//!               (energy     (of the strike    (all      (without       (as in a dry
//!               that        times, from the   strikes   the answer)    recording)
//!               wanders     first ms)         alike)        ▲               │
//!               about                            └──────────┴───────────────┘
//!               modes)                           ▼
//!                                         bands: T60 and level of the room
//! ```
//!
//! One place means that all strikes ring alike, the room's answer to them included. So the answer
//! is no noise: it is found as the response that all strikes have in common beside the modes, and
//! is taken off the recording. What is left hides no strike, and looks like no mode.

mod answer;
mod background;
mod bands;
mod convolution;
mod curves;
mod dried;
mod estimate;
mod onset;
mod presence;

pub(crate) use background::background;
pub(crate) use bands::told_of;
pub(crate) use dried::in_room;
pub use estimate::{BackgroundBand, RoomBandEstimate, RoomEstimate};
pub(crate) use onset::first_model;
pub(crate) use presence::in_a_room;
