//! The keyboard: what each message does to the pads of a kit, and what goes out.

use dsp_core::event::{Action, Event, Time};
use dsp_core::midi::{Keyboard, Message, MidiOut, Outcome};
use dsp_core::table::Kit as KitView;
use host_tests::scene::load;

const NOW: Time = Time::at_frame(77);

/// The demo kit: pad 0 is note 60, pad 1 notes 81 and 53. The end of a note chokes pad 1.
fn demo() -> kit::Loaded {
    let mut kit = kit::open("demo").unwrap().kit;
    kit.pads[1].note_off = kit::NoteOff::Choke;
    load(kit)
}

/// Events that messages of channel 10 make, and the last outcome.
fn play(keyboard: &mut Keyboard<'_>, messages: &[[u8; 3]]) -> (Vec<Event>, Outcome) {
    let (mut events, mut outcome) = (Vec::new(), Outcome::Unknown);
    for &[kind, first, second] in messages {
        let channel = kind & 0xF;
        let message = match kind >> 4 {
            0x8 => Message::NoteOff { channel, note: first, velocity: second },
            0x9 => Message::NoteOn { channel, note: first, velocity: second },
            0xA => Message::PolyPressure { channel, note: first, pressure: second },
            0xB => Message::ControlChange { channel, controller: first, value: second },
            0xC => Message::ProgramChange { channel, program: first },
            _ => Message::ChannelPressure { channel, pressure: first },
        };
        outcome = keyboard.take(message, NOW, |event| events.push(event));
    }
    assert!(events.iter().all(|event| event.time == NOW));
    (events, outcome)
}

fn actions(events: &[Event]) -> Vec<(u8, Action)> {
    events.iter().map(|event| (event.pad, event.action)).collect()
}

#[test]
fn note_on_strikes_its_pad_with_its_share_of_127_at_the_position_of_its_channel() {
    let loaded = demo();
    let keyboard = &mut Keyboard::new(KitView::parse(&loaded.binary).unwrap(), None);
    let (events, outcome) =
        play(keyboard, &[[0xB9, 16, 127], [0x99, 53, 64], [0x90, 60, 127], [0xB9, 17, 0], [0x99, 60, 1]]);
    let found: Vec<_> = events.iter().map(|event| (event.pad, event.velocity, event.position)).collect();
    assert_eq!(found, [(1, 64.0 / 127.0, 1.0), (0, 1.0, 0.0), (0, 1.0 / 127.0, 0.0)]);
    assert_eq!(outcome, Outcome::Taken);
    assert_eq!(play(keyboard, &[[0x99, 2, 100]]), (vec![], Outcome::NoPad(2)));
}

#[test]
fn velocity_goes_through_the_curve_of_the_pad() {
    let mut kit = kit::open("demo").unwrap().kit;
    let usual = dsp_core::trigger::Settings::of_unset_pad(0);
    kit.pads[0].trigger = Some(dsp_core::trigger::Settings { velocity_exponent: 2.0, ..usual });
    let loaded = load(kit);
    let keyboard = &mut Keyboard::new(KitView::parse(&loaded.binary).unwrap(), None);
    let velocity = play(keyboard, &[[0x99, 60, 64]]).0[0].velocity;
    assert!((f64::from(velocity) - (64.0f64 / 127.0).powi(2)).abs() < 1e-6, "{velocity}");
}

#[test]
fn other_channels_are_not_listened_to_if_one_is_set() {
    let loaded = demo();
    let keyboard = &mut Keyboard::new(KitView::parse(&loaded.binary).unwrap(), Some(9));
    assert_eq!(play(keyboard, &[[0x90, 60, 100]]), (vec![], Outcome::OtherChannel));
    assert_eq!(play(keyboard, &[[0x99, 60, 100]]).0.len(), 1);
}

#[test]
fn pressure_of_64_and_more_chokes_once_and_less_releases_once() {
    let loaded = demo();
    let keyboard = &mut Keyboard::new(KitView::parse(&loaded.binary).unwrap(), None);
    let (events, _) = play(keyboard, &[[0xA9, 60, 64], [0xA9, 60, 99], [0xA9, 60, 63], [0xA9, 60, 0]]);
    assert_eq!(actions(&events), [(0, Action::Choke), (0, Action::Release)]);
    let pads = loaded.kit.pads.len();
    assert_eq!(play(keyboard, &[[0xD9, 127, 0]]).0.len(), pads);
    assert_eq!(play(keyboard, &[[0xB9, 121, 0]]).0.len(), pads, "controllers are reset");
}

#[test]
fn end_of_a_note_chokes_if_the_kit_says_so_and_the_next_note_releases() {
    let loaded = demo();
    let keyboard = &mut Keyboard::new(KitView::parse(&loaded.binary).unwrap(), None);
    assert_eq!(play(keyboard, &[[0x99, 60, 9], [0x89, 60, 0]]).0.len(), 1, "pad 0 rings on");
    let (events, _) = play(keyboard, &[[0x99, 81, 9], [0x99, 81, 0], [0x89, 53, 0], [0x99, 81, 9]]);
    let expected = [Action::Strike, Action::Choke, Action::Release, Action::Strike].map(|action| (1, action));
    assert_eq!(actions(&events), expected);
    // Pressure and the end of a note lay one hand: it goes when both are gone.
    let (events, _) =
        play(keyboard, &[[0xA9, 81, 99], [0x89, 81, 0], [0x99, 81, 9], [0x89, 81, 0], [0xA9, 81, 0], [0x99, 81, 9]]);
    let expected = [Action::Choke, Action::Strike, Action::Release, Action::Strike].map(|action| (1, action));
    assert_eq!(actions(&events), expected);
}

#[test]
fn level_silence_and_programs_concern_all_pads() {
    let loaded = demo();
    let keyboard = &mut Keyboard::new(KitView::parse(&loaded.binary).unwrap(), None);
    let (events, _) = play(keyboard, &[[0xB9, 7, 127], [0xB9, 7, 64], [0xB9, 120, 0], [0xB9, 123, 0]]);
    let kinds: Vec<_> = events.iter().map(|event| event.action).collect();
    assert_eq!(kinds, [Action::Level, Action::Level, Action::Silence, Action::Silence]);
    assert_eq!(events[0].velocity, 1.0);
    // 40 log10(v / 127) dB, as General MIDI recommends.
    assert!((events[1].velocity - (64.0f32 / 127.0).powi(2)).abs() < 1e-6);
    assert_eq!(play(keyboard, &[[0xC9, 3, 0]]), (vec![], Outcome::Program(3)));
    assert_eq!(play(keyboard, &[[0xB9, 10, 0]]), (vec![], Outcome::Unknown));
}

#[test]
fn strikes_and_hands_go_out_unless_the_host_holds_a_key_of_the_pad() {
    let loaded = demo();
    let kit = KitView::parse(&loaded.binary).unwrap();
    let (keyboard, mut out) = (&mut Keyboard::new(kit, None), MidiOut::new(kit, 9));
    let strike = Event { time: NOW, pad: 1, velocity: 0.5, position: 0.25, ..Event::NOTHING };
    let hand = Event { action: Action::Choke, ..strike };
    let mut told = |keyboard: &Keyboard<'_>, events: &[Event]| {
        let mut packets = Vec::new();
        events.iter().for_each(|event| out.tell(event, keyboard, |packet| packets.push(packet.0)));
        packets
    };
    let note = [0x09, 0x99, 81, 64];
    assert_eq!(told(keyboard, &[strike, strike]), [[0x0B, 0xB9, 16, 32], note, note]);
    let release = Event { action: Action::Release, ..strike };
    assert_eq!(told(keyboard, &[hand, release]), [[0x0A, 0xA9, 81, 127], [0x0A, 0xA9, 81, 0]]);
    let soft = Event { velocity: 0.001, ..strike };
    assert_eq!(told(keyboard, &[soft]), [[0x09, 0x99, 81, 1]], "a strike is never a note off");
    play(keyboard, &[[0x99, 53, 90]]);
    assert!(told(keyboard, &[strike]).is_empty());
    play(keyboard, &[[0x89, 53, 0]]);
    assert_eq!(told(keyboard, &[strike]), [note]);
}
