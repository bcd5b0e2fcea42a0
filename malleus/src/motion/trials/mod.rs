//! Motions of the paper's experiments (scraping-rolling §3.1, §3.2 and Fig. 5, §5.1), as files.
//!
//! Two pairs share a velocity profile and differ in their paths: [`Shape::BackAndForth`] and
//! [`Shape::FourStrokes`], [`Shape::Circle`] and [`Shape::Line`]. The paper's scribble came from
//! optical tracking; [`Shape::Scribble`] is a random path like it.

mod draw;
mod drawing;
mod profile;
mod scribble;
mod shape;
mod vary;

pub use drawing::Drawing;
pub use shape::{Shape, Trial, TrialError};
