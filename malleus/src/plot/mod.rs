//! Pictures, as PNG: a performance over time, a kit's modes, and run time against error. Needs nothing of the machine, the font comes along.
//!
//! [`performance()`] and [`kit()`] draw on a `canvas` by means of `panel`s with `scale`s; `spectrogram` is the one computation.

mod canvas;
mod colour;
mod curves;
mod error;
mod kit_picture;
mod page;
mod panel;
mod performance;
mod run_time;
mod scale;
mod spectrogram;
mod spectrogram_image;
mod text;

pub use curves::{Axis, Curve, CurvesPanel, CurvesPicture, StrokeKind, curves};
pub use error::PlotError;
pub use kit_picture::{KitPicture, ObjectPicture, kit};
pub use performance::{Performance, StrikeMark, TickRow, performance};
pub use run_time::{KernelMark, RunTimePicture, run_time};
pub use spectrogram_image::{SPECTROGRAM_HZ, SPECTROGRAM_RANGE_DB, spectrogram_pngs};
