//! Rules that the sources of all crates keep: comments, lengths, names, and no circles of imports.
//! `cargo test -p host-tests --test sources -- --nocapture` prints what is still to be mended, too.

mod circles;
mod comments;
mod fault;
mod files;
mod lengths;
mod modules;
mod paths;
