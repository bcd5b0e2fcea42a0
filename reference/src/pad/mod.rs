//! Pad: one object, the strikers that play it, and the sum of what they radiate.
//!
//! Eq. 1 for one pad, without background noise and room, and with the striker's own sound:
//!
//! ```text
//! y = F ⊗ (IR_object + H) + s + η Σ_s F_s ⊗ IR_striker_s + α F,   F = Σ_s F_s + direct
//! ```
//!
//! H is the object's biquads, where it has some; s is what its dynamic filter makes of the noise that each strike begins, and of `F ⊗ IR_object` where that goes through it. `F_s` is the part of the force that striker s makes; a direct force counts as made by striker 0.
//! Each contact drives the object with the gains of its own position, however many positions are under
//! force at a time. A direct force acts at that of the latest strike that has begun; before the first at 0.

mod biquads;
mod dynamic_filter;
mod hand;
mod part;
mod voice;

use crate::biquad::Biquad;
use crate::contact::Striker;
use crate::error::Error;
use crate::event::{self, Direct, Event};
use crate::radiation::Acceleration;
use crate::rate::SampleRate;
use crate::resonator::Mode;

pub use dynamic_filter::DynamicFilter;
pub(crate) use part::Part;

/// What is struck.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its modes (`IR_object`), with gains at one or more positions.
    pub modes: Vec<Mode>,
    /// The acceleration sound.
    pub acceleration: Acceleration,
    /// Chains of biquads beside the modes (diffmodal eq. 3), driven by the force in newtons; for the sample rate at which they are rendered.
    pub biquads: Vec<Vec<Biquad>>,
    /// Noise through a filter that moves, with loops round it; its modes may go through as well.
    pub dynamic_filter: Option<DynamicFilter>,
}

/// An object with its strikers and its place in the mix.
#[derive(Clone, Debug, PartialEq)]
pub struct Pad {
    /// What is struck.
    pub object: Object,
    /// What strikes it; an [`Event`] names one by its index.
    pub strikers: Vec<Striker>,
    /// η: weight of the strikers' own sound.
    pub striker_weight: f64,
    /// Level in the mix in dB; 0 leaves the signal as it is.
    pub level_db: f64,
    /// Place in the mix, -1 left to 1 right.
    pub pan: f64,
    /// While choked, every mode of the object and of the strikers falls by 60 dB in at most this
    /// many seconds; above 0.
    pub choke_t60_s: f64,
}

/// The first `sample_count` samples of the pad with index `pad`, in mono, before level and pan.
///
/// Arguments are those of [`crate::scene::render`]; events and direct force for other pads are
/// passed over.
///
/// # Errors
/// [`Error`] if an index points at nothing, events are out of order, or a bank's gains are uneven.
pub fn render_mono(
    pads: &[Pad],
    pad: usize,
    events: &[Event],
    direct: Option<Direct<'_>>,
    rate: SampleRate,
    sample_count: usize,
) -> Result<Vec<f64>, Error> {
    event::check(events, direct, pads)?;
    let mut sound = vec![0.0; sample_count];
    Part::new(pads, pad, events, direct, rate)?.render(&mut sound);
    Ok(sound)
}
