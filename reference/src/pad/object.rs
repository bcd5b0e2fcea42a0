//! A struck object, and a pad: the object with its strikers.

use super::dynamic_filter::DynamicFilter;
use crate::biquad::Biquad;
use crate::contact::Striker;
use crate::radiation::Acceleration;
use crate::resonator::Mode;

/// A struck object.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Modes (`IR_object`), with gains at one or more positions.
    pub modes: Vec<Mode>,
    /// Acceleration sound of the object.
    pub acceleration: Acceleration,
    /// Chains of biquads beside the modes (diffmodal eq. 3), driven by the force in newtons.
    ///
    /// Their coefficients are for the sample rate at which they are rendered.
    pub biquads: Vec<Vec<Biquad>>,
    /// Noise through a filter that changes over time, with loops round it. The modes may feed it
    /// too.
    pub dynamic_filter: Option<DynamicFilter>,
}

/// An object with its strikers and its place in the mix.
#[derive(Clone, Debug, PartialEq)]
pub struct Pad {
    /// The struck object.
    pub object: Object,
    /// Strikers that play the object; an event names one by its index.
    pub strikers: Vec<Striker>,
    /// Weight η of the strikers' own sound.
    pub striker_weight: f64,
    /// Level in the mix in dB; 0 leaves the signal as it is.
    pub level_db: f64,
    /// Place in the mix, -1 left to 1 right.
    pub pan: f64,
    /// Longest T60 in seconds, above 0, of every mode of object and strikers while the pad is
    /// choked.
    pub choke_t60_s: f64,
    /// True if a choke reaches the object's modes as it does in frames: at the beginning of the
    /// block of 256 samples behind the next one to begin, and with rates that add, `d + d_c`.
    pub is_in_frames: bool,
}
