//! Kits as text and binary: what goes in comes out, and what is wrong is refused by name.

mod arbitrary;
mod arbitrary_filters;
mod balance;
mod binary_refusals;
mod files;
mod filters;
mod residual;
mod restitution;
mod room;
mod round_trip;
mod sample;
mod shipped;
mod statistics;
mod text_refusals;
mod trigger;
