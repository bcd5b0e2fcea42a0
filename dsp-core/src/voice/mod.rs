//! A voice: all stages of one pad, which are its object and strikers, its filters and its noise
//! (diffimpact eq. 1 without background and room).
//!
//! ```text
//! contacts of striker s ---> F_s -+-> η · striker bank s --------------+
//! direct force (counts as s = 0) -+                                    |
//!                                 +-> F = Σ F_s -> object, filters ----+-> level, pan -> stereo
//!                                 |              \-> α · F ------------+       |
//!                                 +-> strike -> residual ----------------------+
//! ```
//!
//! A second strike adds energy to the same ringing banks.

mod beside_frames;
mod choke;
mod filters;
mod form;
mod guard;
mod hand;
mod load;
mod ongoing;
mod render;
mod residual;
mod state;
mod tables;

pub(crate) use choke::nepers_per_frame;
pub use filters::{FilterWork, Filters, FiltersSize};
pub use form::Form;
pub use load::VoiceSize;
pub use render::Ran;
pub use residual::Residual;
pub use state::{PadWork, Run, Voice};
pub use tables::PadTables;
