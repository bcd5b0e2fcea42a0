//! Levels and orders of silence: the law of the instrument's fader in `f64`.

use dsp_core::SampleRate;
use dsp_core::engine::{END_S, LEVEL_S};
use dsp_core::event::{Action, Event, Time};
use dsp_core::time::TICK_FRAMES;

/// Part of a performance from one order of silence to the next.
pub(super) struct Part {
    /// Events of the part, and the hands that lay on pads at its beginning.
    pub(super) events: Vec<Event>,
    /// First frame of the part's own sound: what a direct force made before is not heard again.
    pub(super) from: u64,
    /// Frame at which the part's sound begins to end; `None` for the last part.
    pub(super) to: Option<u64>,
}

fn frames_of(seconds: f64, rate: SampleRate) -> u64 {
    ((seconds * rate.hz()) as u64).max(1)
}

/// Splits events at orders of silence. A strike in the 4 ms in which a sound ends begins at the
/// tick after them. An order where nothing has been struck before has no effect.
pub(super) fn parts(events: &[Event], rate: SampleRate) -> Vec<Part> {
    let mut parts = vec![Part { events: Vec::new(), from: 0, to: None }];
    // Tick at which the last part begins.
    let mut begins = 0;
    for event in events {
        let frame = event.time.first_frame();
        let Some(part) = parts.last_mut() else { break };
        if event.action == Action::Silence {
            let has_sound = part.events.iter().any(|event| event.action == Action::Strike);
            if frame >= begins && has_sound {
                begins = (frame + frames_of(END_S, rate)).next_multiple_of(TICK_FRAMES as u64);
                part.to = Some(frame);
                let hands = hands(&part.events, begins);
                parts.push(Part { events: hands, from: begins, to: None });
            }
            continue;
        }
        let is_held = event.action == Action::Strike && frame < begins;
        part.events.push(if is_held { Event { time: Time::at_frame(begins), ..*event } } else { *event });
    }
    parts
}

/// Returns a choke at a frame for each pad on which a hand lies.
fn hands(events: &[Event], frame: u64) -> Vec<Event> {
    let last = |pad: u8| {
        let of_hand = |event: &&Event| event.pad == pad && event.is_choke_or_release();
        events.iter().rfind(of_hand).filter(|event| event.action == Action::Choke)
    };
    (0..=u8::MAX).filter_map(last).map(|event| Event { time: Time::at_frame(frame), ..*event }).collect()
}

/// Ends the sound of a part, and drops what lies before its beginning.
pub(super) fn fade(sound: &mut [[f64; 2]], (from, to): (u64, Option<u64>), rate: SampleRate) {
    let length = frames_of(END_S, rate);
    for (frame, sample) in (0u64..).zip(sound) {
        let gain = match to {
            _ if frame < from => 0.0,
            Some(to) if frame >= to => 1.0 - ((frame - to + 1) as f64 / length as f64).min(1.0),
            _ => 1.0,
        };
        *sample = sample.map(|x| x * gain);
    }
}

/// Multiplies a sound by its levels.
pub(super) fn set_levels(events: &[Event], rate: SampleRate, sound: &mut [[f64; 2]]) {
    let length = frames_of(LEVEL_S, rate);
    let mut orders = events.iter().filter(|event| event.action == Action::Level).peekable();
    let (mut gain, mut end, mut left) = (1.0f64, 1.0f64, 0u64);
    for (frame, sample) in (0u64..).zip(sound) {
        while let Some(order) = orders.next_if(|order| order.time.first_frame() <= frame) {
            (end, left) = (f64::from(order.velocity), length);
        }
        if left > 0 {
            gain += (end - gain) / left as f64;
            left -= 1;
        }
        *sample = sample.map(|x| x * gain);
    }
}
