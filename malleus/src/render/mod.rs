//! Rendering of a performance by the instrument, by a board's engine, or by the `f64` reference.

pub mod board;
pub mod force;
pub mod headroom;
pub mod instrument;
pub mod level;
pub mod own_force;
pub mod part;
pub mod parts;
pub mod reference;
pub mod replay;
pub mod scraped;

mod performance;

pub use performance::Performance;
