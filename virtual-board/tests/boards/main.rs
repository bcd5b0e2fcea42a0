//! The firmware's images on the virtual boards: one program, so that its long tests run side by side.
//! `cargo test -p virtual-board --test boards latency` runs one part.

mod common;
mod faults;
mod hits;
mod images;
mod latency;
mod load;
mod played;
mod replay;
mod self_test;
mod sound;
mod stages;
mod timing;
