//! Pad: one object, the strikers that play it, and the sum of all that they radiate.
//!
//! Eq. 1 for one pad, without background noise and room, and with the striker's own sound:
//!
//! ```text
//! y = F ⊗ (IR_object + H) + s + η Σ_s F_s ⊗ IR_striker_s + α F,   F = Σ_s F_s + direct
//! ```
//!
//! H is the response of the object's biquads, if it has any. s is the output of its dynamic filter.
//! The filter's input is the noise that each strike begins and, if the modes feed the filter,
//! `F ⊗ IR_object`. `F_s` is the part of the force that striker s makes; a direct force counts as
//! made by striker 0. Each contact drives the object with the gains of its own position, however
//! many positions are under force at a time. A direct force acts at the position of the latest
//! strike that has begun, and at 0 before the first.

mod biquads;
mod dynamic_filter;
mod hand;
mod object;
mod part;
mod voice;

use crate::error::Error;
use crate::event::{self, Direct, Event};
use crate::rate::SampleRate;

pub use dynamic_filter::DynamicFilter;
pub use object::{Object, Pad};
pub(crate) use part::Part;

/// Renders the first `sample_count` samples of the pad with index `pad`, in mono, before level and
/// pan.
///
/// The arguments are those of [`crate::scene::render`]. Events and direct force for other pads are
/// ignored.
///
/// # Errors
/// [`Error`] if an index is out of range, events are out of order, or the gains of a bank are
/// uneven.
pub fn render_mono(
    pads: &[Pad],
    pad: usize,
    events: &[Event],
    direct: Option<Direct<'_>>,
    rate: SampleRate,
    sample_count: usize,
) -> Result<Vec<f64>, Error> {
    event::check(events, direct, &striker_counts(pads))?;
    let mut sound = vec![0.0; sample_count];
    Part::new(pads, pad, events, direct, rate)?.render(&mut sound);
    Ok(sound)
}

/// Number of strikers of each pad.
pub(crate) fn striker_counts(pads: &[Pad]) -> Vec<usize> {
    pads.iter().map(|pad| pad.strikers.len()).collect()
}
