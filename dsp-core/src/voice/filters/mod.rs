//! Filters of a voice: a dynamic filter with its loops, and biquads.
//!
//! ```text
//! F ──► biquads ─────────────────────────────────────────────────────────┐
//!  └──► object bank ─┬─ "beside" ────────────────────────────────────────┤
//!                    └─ "through" ─► dynamic filter ─► loops ─► choke ───┴─► the pad's bus
//! strike ──────────────► its noise ──────┘
//! ```
//!
//! Under a choke every sound that falls slower than the pad's choke T60 falls by that T60. The
//! biquads' chains do it by poles of their own ([`biquad::Bank::set_choked`]). The dynamic filter
//! does it by a gain behind it, for which the filter's path says how fast the sound falls by itself
//! ([`Levels`]). The object's bank damps its own modes.
//!
//! [`biquad::Bank::set_choked`]: crate::biquad::Bank::set_choked
//! [`Levels`]: crate::dynamic_filter::level::Levels

mod load;
mod render;
mod state;

pub use render::FilterWork;
pub use state::{Filters, FiltersSize};
