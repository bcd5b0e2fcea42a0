//! The trigger on signals of piezos: strikes found and missed, times, faults of the inputs.
//! `cargo test -p host-tests --test trigger quality::` runs one part.

mod pads;
mod quality;
mod timing;
