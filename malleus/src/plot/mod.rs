//! Pictures as PNG files: a performance over time, a kit's modes, curves, crossings, run time
//! against error.
//!
//! They need nothing of the machine, since the program carries its font. [`performance_png()`],
//! [`kit()`], [`curves()`], [`crossings()`] and [`run_time()`] draw panels with scales on a canvas.
//! Only spectrograms are computed; the other pictures show numbers that their caller has.

mod canvas;
mod colour;
mod crossings;
mod curves;
mod error;
mod field_image;
mod kit_picture;
mod page;
mod panel;
mod performance;
mod run_time;
mod scale;
mod spectrogram;
mod spectrogram_image;
mod text;

pub use crossings::{CrossingsPicture, Level, Mark, crossings};
pub use curves::{Axis, Curve, CurvesPanel, CurvesPicture, StrokeKind, curves};
pub use error::PlotError;
pub use field_image::field_png;
pub use kit_picture::{KitPicture, ObjectPicture, kit};
pub use performance::{Performance, StrikeMark, TickRow, performance_png};
pub use run_time::{KernelMark, RunTimePicture, run_time};
pub use spectrogram_image::{SPECTROGRAM_HZ, SPECTROGRAM_RANGE_DB, signed_png, spectrogram_pngs};
