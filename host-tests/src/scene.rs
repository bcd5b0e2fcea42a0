//! Small kits made in code, and an engine that plays them.

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Skipping, TickReport};
use dsp_core::event::{Action, Event, Time};
use dsp_core::table::Kit as KitView;
use kit::{Gain, Kit, Loaded, Mode, Object, Pad, Pulse, Striker};

use crate::lent;

/// Mode with gains at one position.
pub fn mode(frequency_hz: f64, t60_s: f64, sine: f64, cosine: f64) -> Mode {
    Mode {
        frequency_hz: frequency_hz as f32,
        decay_per_s: (1000f64.ln() / t60_s) as f32,
        gains: vec![Gain { sine: sine as f32, cosine: cosine as f32 }],
    }
}

/// Kit of one pad `pad` with one striker; change its parts, then [`load`] it.
pub fn one_pad(modes: Vec<Mode>) -> Kit {
    let nothing = String::new;
    Kit {
        name: "test".into(),
        objects: vec![Object {
            name: "object".into(),
            source: nothing(),
            licence: nothing(),
            reference_force: 1.0,
            acceleration: kit::Acceleration::NONE,
            modes,
            residual: None,
            dynamic_filter: None,
            biquads: None,
            surface: None,
        }],
        strikers: vec![Striker {
            name: "striker".into(),
            source: nothing(),
            licence: nothing(),
            pulse: Pulse::Hertz,
            peak_force: 1.0,
            peak_exponent: 1.2,
            contact_time_s: 0.0005,
            contact_exponent: -0.2,
            restitution: Striker::DEFAULT_RESTITUTION,
            scrape: None,
            roll: None,
            modes: Vec::new(),
        }],
        pads: vec![Pad {
            name: "pad".into(),
            object: "object".into(),
            strikers: vec!["striker".into()],
            level_db: 0.0,
            pan: -1.0,
            striker_weight: 1.0,
            choke_t60_s: 0.0,
            midi_notes: Vec::new(),
            note_off: kit::NoteOff::Nothing,
            trigger: None,
        }],
        background: None,
        room: vec![],
        headphone_db: None,
        surfaces: Vec::new(),
    }
}

/// Kit together with its binary form.
pub fn load(kit: Kit) -> Loaded {
    let binary = kit::binary::build(&kit).expect("the kit is valid");
    Loaded { kit, binary, skipped_sections: Vec::new() }
}

/// Strike on pad 0 at the beginning of a frame.
pub fn strike(frame: u64, velocity: f32) -> Event {
    Event { time: Time::at_frame(frame), velocity, ..Event::default() }
}

/// Choke or release of pad 0 at the beginning of a frame.
pub fn hand(frame: u64, action: Action) -> Event {
    Event { time: Time::at_frame(frame), action, ..Event::default() }
}

/// Plays events for some frames, and optionally a force on pad 0. Gives the bus and the reports of
/// all ticks.
///
/// The block lengths are those of `blocks`, over and over.
pub fn play(
    loaded: &Loaded,
    rate: SampleRate,
    skipping: Skipping,
    events: &[Event],
    force: Option<&[i32]>,
    (frames, blocks): (usize, &[usize]),
) -> (Vec<[i32; 2]>, Vec<TickReport>) {
    let kit = KitView::parse(&loaded.binary).expect("the kit is valid");
    let mut engine = lent::engine(&kit, rate, skipping).expect("the kit can be played");
    let (mut out, mut reports) = (vec![[0; 2]; frames], Vec::new());
    let mut lengths = blocks.iter().copied().cycle();
    let (mut rest, mut events) = (out.as_mut_slice(), events);
    while !rest.is_empty() {
        let length = lengths.next().unwrap_or(128).min(rest.len());
        let (block, later) = rest.split_at_mut(length);
        let start = engine.now() as usize;
        let due = events.iter().take_while(|event| event.time.first_frame() < (start + length) as u64).count();
        let now: Option<Vec<i32>> =
            force.map(|force| force.iter().skip(start).copied().chain(std::iter::repeat(0)).take(length).collect());
        let direct = now.as_ref().map(|force| Direct { pad: 0, force });
        engine.render_bus(&events[..due], direct, block, |report| reports.push(*report)).expect("the events are valid");
        (rest, events) = (later, &events[due..]);
    }
    (out, reports)
}
