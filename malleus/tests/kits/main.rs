//! Kits as the user of the program meets them: levels, balance, filters, whole sounds, the recorded
//! kit, priors. `cargo test -p malleus --test kits levels::` runs one part.

mod balance;
mod filters;
mod levels;
mod priors;
mod recorded;
mod shapes;
mod whole_sound;
