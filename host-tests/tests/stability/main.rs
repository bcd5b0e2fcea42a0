//! Stability of the engine under abuse and under arbitrary valid scenes.
//! `cargo test -p host-tests --test stability abuse::` runs one part.

mod abuse;
mod arbitrary_scenes;
