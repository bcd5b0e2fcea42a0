//! Contact: from the velocity of a strike to a force over time.
//!
//! A [`Striker`] turns the velocity into a peak force `m` and a contact time `τ`. A [`Pulse`] is
//! the shape `C(t)` of the force between (eq. 2). An [`Impact`] is one such contact at its exact
//! time. The force on an object is the sum over all contacts (eq. 3),
//!
//! ```text
//! F(t) = Σ_i m_i C(t - t_i; τ_i)
//! ```
//!
//! so a second strike adds to a first one that still pushes, and cuts nothing off.

mod impact;
mod pulse;
mod striker;

pub use impact::Impact;
pub use pulse::Pulse;
pub use striker::Striker;
