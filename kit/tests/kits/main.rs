//! Kits as text and binary: valid ones come through unchanged, and invalid ones are refused by
//! name.

mod arbitrary;
mod arbitrary_filters;
mod arbitrary_number;
mod arbitrary_surfaces;
mod balance;
mod binary_refusals;
mod files;
mod filters;
mod headphone;
mod residual;
mod restitution;
mod room;
mod round_trip;
mod sample;
mod shipped;
mod statistics;
mod surfaces;
mod text_refusals;
mod trigger;
