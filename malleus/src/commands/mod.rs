//! The commands: each reads its files, calls the library, shows progress and writes its results.

pub(crate) mod board;
mod board_midi;
pub(crate) mod demo;
mod error;
pub(crate) mod fit;
mod fit_filter;
mod fit_job;
mod fit_names;
mod fit_strikes;
pub(crate) mod kit;
mod kit_check;
mod kit_new;
mod kit_report;
mod left_out;
pub(crate) mod motion;
mod output;
pub(crate) mod play;
mod play_motion;
mod play_report;
pub(crate) mod separate;
mod separate_labels;
mod separate_tables;
pub(crate) mod shape;
mod shape_benchmarks;
pub(crate) mod study;
pub(crate) mod surface;
mod usb_midi;
