//! From recordings to tables: what a board plays, out of what a microphone heard.

pub mod modes;
pub mod score;
pub mod synthetic;
