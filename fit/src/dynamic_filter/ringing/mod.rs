//! Loops that ring while the noise falls by a level of its own: filter, level and loops found together from the closed loop's own poles.
//!
//! ```text
//! first guesses: a filter that stands still, noise that falls as some band does, loops where bands fall slower ─┐
//!                what a descent without levels has found ───────────────────────────────────────────────────────┴─► descent ─► model
//! ```
//!
//! What all bands' decays share is the noise's level, not the filter's: so |F| may stay nearly the same where loops run, and they ring. Three things make the descent's prediction what
//! is heard: its knots are the table's breakpoints; at each of them the filter's gain follows from the largest gain round the loops, so that nothing has to be lowered for
//! stability afterwards; and each loop's decay and residue are those of the closed loop's pole, with all other loops' skirts in it.

mod circle;
mod descent;
mod numbers;
mod powers;
mod search;
mod start;

pub(crate) use numbers::Ringing;
pub(crate) use search::search;
pub(crate) use start::of_sought;

#[cfg(test)]
mod tests;
