//! Events that were read from a file, and how a time in seconds becomes an event's time.

use dsp_core::SampleRate;
use dsp_core::event::{Event, Time};

/// Events of a file, with remarks on those that were left out.
#[derive(Clone, Debug, Default)]
pub struct EventList {
    /// Events in order of time.
    pub events: Vec<Event>,
    /// Strikes with a force of their own, in order of time.
    ///
    /// All are on one pad.
    pub strikes: Vec<OwnForce>,
    /// Remarks for the user, such as MIDI notes that no pad plays.
    pub remarks: Vec<String>,
}

/// Strike whose peak force, contact time or both do not follow from its striker's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnForce {
    /// Time at which the contact begins.
    pub time: Time,
    /// Number of the pad, counted from 0.
    pub pad: u8,
    /// Number of the pad's striker, counted from 0; it makes the pulse's shape.
    pub striker: u8,
    /// Position along the object, 0 to 1.
    pub position: f32,
    /// Velocity, 0 to 1, for what the law still decides.
    pub velocity: f32,
    /// Peak force in newtons; `None` for that of the law.
    pub peak_force: Option<f64>,
    /// Contact time in seconds; `None` for that of the law.
    pub contact_time_s: Option<f64>,
}

/// Converts a time in seconds to whole frames and a fraction of a frame.
///
/// Returns `None` for negative times, for times that are not finite, and from 9e15 frames on,
/// which an `f64` no longer tells apart to the frame.
pub fn time_from_seconds(seconds: f64, rate: SampleRate) -> Option<Time> {
    let frames = seconds * rate.hz();
    if !(0.0..9e15).contains(&frames) {
        return None;
    }
    let whole = frames.floor();
    // `as` saturates: a fraction that rounds up to 1 stays just below it.
    Some(Time { frame: whole as u64, fraction: ((frames - whole) * 4_294_967_296.0).round() as u32 })
}
