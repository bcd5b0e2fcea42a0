//! Motions as events, which an engine plays.

use dsp_core::SampleRate;
use dsp_core::event::{Action, Event, Time};
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;

use super::contacts::{along_object, described, held, object_size_m};
use super::error::ScrapedError;
use crate::motion::{self, Motion};

/// Events of a motion, in order of time: each touch, its motion tick by tick, and its lift.
///
/// The limits α of a striker stand for its least and its largest normal force on that pad in the
/// whole motion (scraping-rolling eq. 7). With `is_constant` the normal force stays at its mean,
/// and so does α.
///
/// # Errors
/// [`ScrapedError`].
pub fn events(motion: &Motion, kit: &Kit<'_>, rate: SampleRate, is_constant: bool) -> Result<Vec<Event>, ScrapedError> {
    kit.check_surfaces()?;
    let mut events = Vec::new();
    for (index, touch) in motion.contacts().iter().enumerate() {
        let held = held(motion, kit, index, is_constant)?;
        described(kit, touch, held.normal_n())?;
        let [length_m, _] = object_size_m(kit, touch);
        let first_tick = (touch.touch_s * rate.hz() / TICK_FRAMES as f64) as usize;
        let mut reader = motion.reader();
        let mut position = 0.5;
        for tick in first_tick.. {
            let time_s = ((tick + 1) * TICK_FRAMES) as f64 / rate.hz();
            let state = reader.at(time_s).filter(|state| state.contact == index);
            position = state.as_ref().map_or(position, |state| along_object(state, length_m) as f32);
            let event = Event {
                time: Time::at_frame((tick * TICK_FRAMES) as u64),
                pad: touch.pad,
                striker: touch.striker,
                position,
                ..Event::NOTHING
            };
            if tick == first_tick {
                let rolls = touch.action == motion::Action::Roll;
                events.push(Event { action: Action::Touch { rolls, normal_n: held.normal_n() }, ..event });
            }
            match state {
                Some(state) => {
                    let moved = held.moved(Some(&state));
                    moved.check().map_err(|error| ScrapedError::Motion { time_s, error })?;
                    events.push(Event { action: Action::Move(moved), ..event });
                }
                None if time_s > touch.lift_s => {
                    events.push(Event { action: Action::Lift, ..event });
                    break;
                }
                None => events.push(Event { action: Action::Move(Default::default()), ..event }),
            }
        }
    }
    Ok(events)
}

/// Merges two lists of events that are in order of time. In a frame, events of the first list come
/// first.
pub fn merged(first: &[Event], second: &[Event]) -> Vec<Event> {
    let mut merged = [first, second].concat();
    merged.sort_by_key(|event| event.time.first_frame());
    merged
}
