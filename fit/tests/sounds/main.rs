//! Fits of sounds and rooms: known ones, recorded ones, and input that is no good.
//! `cargo test -p fit --test sounds hammer::` runs one part.

mod bad_input;
mod bark;
mod bins;
mod dynamic_filter;
mod forms;
mod hammer;
mod modes;
mod room;
mod room_prior;
mod surface_files;
mod surface_waves;
mod surfaces;
