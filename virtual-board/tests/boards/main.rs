//! Images of the firmware on the virtual boards.
//!
//! The tests are one program, so that the long ones run side by side. `cargo test -p virtual-board
//! --test boards latency` runs one part.

mod common;
mod faults;
mod frames;
mod hits;
mod images;
mod inputs;
mod latency;
mod load;
mod played;
mod presses;
mod replay;
mod restarts;
mod self_test;
mod sound;
mod stages;
mod storage;
mod timing;
mod usb;
mod volume;
