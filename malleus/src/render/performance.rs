//! A performance: the events and the force that are to be rendered, and the length of the sound.

use dsp_core::SampleRate;
use dsp_core::event::{Action, Event, Time};

/// Events and force that are to be rendered, and the length of the sound.
#[derive(Clone, Debug, Default)]
pub struct Performance {
    /// Events in order of time.
    pub events: Vec<Event>,
    /// Pad that a force drives directly, and the force's samples in Q4.27 from frame 0 on.
    pub direct: Option<(u8, Vec<i32>)>,
    /// Length of the sound in frames.
    pub frames: usize,
}

impl Performance {
    /// Creates a performance that ends `tail_s` seconds after the last event or sample of force.
    ///
    /// Without `tail_s` it ends when all that is excited, and then the room, has decayed by about
    /// 96 dB, but at most 30 s after the last excitation. The length depends on the kit's tables
    /// alone, so that every renderer gives a sound of equal length.
    pub fn new(
        events: Vec<Event>,
        direct: Option<(u8, Vec<i32>)>,
        kit: &kit::Kit,
        rate: SampleRate,
        tail_s: Option<f64>,
    ) -> Self {
        let direct_pads = direct.iter().map(|(pad, _)| *pad);
        let is_heard = |event: &&Event| match event.action {
            Action::Strike => event.velocity > 0.0,
            action => matches!(action, Action::Touch { .. }),
        };
        let struck = events.iter().filter(is_heard);
        let ringing = struck.map(|event| event.pad).chain(direct_pads).map(|pad| ringing_time_s(kit, usize::from(pad)));
        let room_s = kit.room.iter().map(|band| 1.6 * band.t60_s()).fold(0.0, f64::max);
        let tail_s = tail_s.unwrap_or_else(|| (ringing.fold(0.0, f64::max) + room_s).min(LONGEST_TAIL_S));
        let asked = |event: &&Event| !matches!(event.action, Action::Shed(_));
        let last_event = events.iter().rfind(asked).map_or(0, |event| event.time.first_frame());
        let last = (last_event as usize).max(direct.as_ref().map_or(0, |(_, force)| force.len()));
        let frames = last.saturating_add((tail_s * rate.hz()).ceil() as usize).saturating_add(1);
        Self { events, direct, frames }
    }

    /// Creates a kit's loudest chord: each of `pads` pads is struck in frame 0 by its first
    /// striker, at velocity 1 and position 0.
    pub fn chord(pads: usize, frames: usize) -> Self {
        let pads = (0..=u8::MAX).take(pads);
        Self { events: pads.map(|pad| strike(pad, 0, 0.0)).collect(), direct: None, frames }
    }
}

/// A strike at velocity 1 in frame 0.
pub(super) fn strike(pad: u8, striker: u8, position: f32) -> Event {
    Event { time: Time::at_frame(0), pad, velocity: 1.0, position, striker, action: Action::Strike }
}

/// Longest tail of a performance without one of its own, in seconds.
const LONGEST_TAIL_S: f64 = 30.0;

/// Time in seconds after which a pad has decayed by about 96 dB.
///
/// It is 1.6 times the longest T60 of its modes and biquads or duration of its dynamic filter, and
/// 0.1 s for a contact.
fn ringing_time_s(kit: &kit::Kit, pad: usize) -> f64 {
    let Some(pad) = kit.pads.get(pad) else { return 0.0 };
    let objects = || kit.objects.iter().filter(|object| object.name == pad.object);
    let object = objects().flat_map(|object| &object.modes);
    let strikers = kit.strikers.iter().filter(|striker| pad.strikers.contains(&striker.name));
    let modes = object.chain(strikers.flat_map(|striker| &striker.modes));
    let slowest = modes.map(|mode| f64::from(mode.decay_per_s)).fold(f64::INFINITY, f64::min);
    let filters_s = objects().flat_map(|object| &object.dynamic_filter).map(kit::DynamicFilter::duration_s);
    let biquads_s = objects().flat_map(|object| &object.biquads).map(kit::Biquads::t60_s);
    let longest_s = filters_s.chain(biquads_s).fold(1000f64.ln() / slowest, f64::max);
    0.1 + 1.6 * longest_s
}
