//! Contact: from a strike to the force on the object, `F(t) = Σ m_i C_i(t)` (diffimpact eq. 3).
//!
//! ```text
//! velocity --> striker's law --> peak m, contact time τ --> pulse --+
//!                                          (several in flight)      +--> force, Q4.27
//! direct signal ----------------------------------------------------+
//! ```
//!
//! [`law`] turns a velocity into peak and contact time, [`pulse`] is the shape over the contact, [`flight`] keeps the contacts that are
//! under way, for all pads of an engine.

pub mod flight;
pub mod law;
pub mod pulse;

pub use flight::{Contact, Flight};
pub use law::StrikerLaw;
pub use pulse::Pulse;
