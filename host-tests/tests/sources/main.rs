//! Rules for the sources of all crates: comments, lengths, names, and no circles of imports.
//! `cargo test -p host-tests --test sources -- --nocapture` also prints the places still to be
//! mended.

mod circles;
mod comments;
mod fault;
mod files;
mod lengths;
mod modules;
mod paths;
