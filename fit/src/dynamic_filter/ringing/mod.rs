//! Loops that ring while the noise's level falls by itself: filter, level and loops found together,
//! from the poles of the closed loop.
//!
//! ```text
//! first guesses: a filter that stands still, ─┐
//!   noise that falls as some band does,       │
//!   loops in bands that fall more slowly      ├─► descent ─► model
//! candidate of a descent without levels ──────┘
//! ```
//!
//! The part that all bands' decays share is put into the noise's level, not into the filter. So |F|
//! may stay nearly constant where loops run, and they ring. Three things make the descent's
//! prediction match the rendered sound. Its knots are the table's breakpoints. At each knot the
//! filter's gain follows from the largest loop gain, so that nothing has to be lowered for
//! stability afterwards. And each loop's decay and residue are those of the closed loop's pole,
//! which includes the skirts of all other loops.

mod circle;
mod descent;
mod numbers;
mod powers;
mod search;
mod start;

pub(crate) use numbers::Ringing;
pub(crate) use search::search;
pub(crate) use start::of_candidate;

#[cfg(test)]
mod tests;
