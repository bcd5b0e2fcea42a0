//! Contact: from a strike to the force on the object, `F(t) = Σ m_i C_i(t)` (diffimpact eq. 3).
//!
//! ```text
//! velocity --> striker's law --> peak m, contact time τ --> pulse --+
//!                                          (several in active)      +--> force, Q4.27
//! direct signal ----------------------------------------------------+
//! ```
//!
//! [`law`] turns a velocity into peak and contact time. [`pulse`] is the shape over the contact.
//! [`active`] keeps the contacts that are under way, for all pads of an engine: impacts, and
//! contacts that go on ([`scrape`](crate::scrape)), whose force comes a tick at a time.
//!
//! A Hertz pulse is asymmetric by the striker's restitution, so that its spectrum has no zeros for
//! a harder strike to sweep through a mode. Each sample of its force is the mean over the interval
//! that ends there. So the impulse is exact at any onset; highest frequencies droop by sinc(f/fs).

pub mod active;
mod angle;
mod kernel;
pub mod law;
mod ongoing;
pub mod pulse;
mod shape;

pub use active::{ActiveContacts, Contact};
pub use law::StrikerLaw;
pub use ongoing::OngoingForces;
pub use pulse::Pulse;
