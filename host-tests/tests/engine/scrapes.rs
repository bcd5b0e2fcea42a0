//! Scraping and rolling by events: the engine makes the force of the contact, tick by tick.

use dsp_core::SampleRate;
use dsp_core::engine::{STANDARD_SCRAPES, Skipping, TickReport};
use dsp_core::event::{Action, Event, EventError, Time};
use dsp_core::scrape::{Contact, Motion, MotionError};
use dsp_core::table::Kit;
use dsp_core::time::TICK_FRAMES;
use host_tests::lent;
use host_tests::scene::{load, play};
use host_tests::scrape;
use kit::Loaded;

const RATE: SampleRate = SampleRate::HZ_48000;
const TICK: u64 = TICK_FRAMES as u64;
const NORMAL_N: [f32; 2] = [0.1, 1.0];

/// Shipped kit `scrapes` with some of its pads, in their order.
fn scrapes(pads: &[&str]) -> Loaded {
    let mut kit = kit::shipped("scrapes").expect("a shipped kit").expect("a right kit").kit;
    kit.pads.retain(|pad| pads.contains(&pad.name.as_str()));
    load(kit)
}

fn event(tick: u64, striker: u8, action: Action) -> Event {
    Event { time: Time::at_frame(tick * TICK), striker, position: 0.5, action, ..Event::NOTHING }
}

fn touch(tick: u64, striker: u8, rolls: bool) -> Event {
    event(tick, striker, Action::Touch { rolls, normal_n: NORMAL_N })
}

/// Motion of tick `tick` of a stroke that goes to and fro.
fn motion(tick: u64) -> Motion {
    let angle = tick as f32 * 0.02;
    let normal_n = if tick % 100 > 90 { 0.0 } else { 0.55 + 0.4 * angle.cos() };
    Motion { velocity_m_per_s: [0.8 * angle.sin(), 0.2 * (2.0 * angle).cos()], normal_n }
}

/// Touch, motions of `ticks` ticks, and lift.
fn stroke(first: u64, ticks: u64, striker: u8, rolls: bool) -> Vec<Event> {
    let moves = (0..ticks).map(|tick| event(first + tick, striker, Action::Move(motion(tick))));
    [touch(first, striker, rolls)]
        .into_iter()
        .chain(moves)
        .chain([event(first + ticks, striker, Action::Lift)])
        .collect()
}

fn run(loaded: &Loaded, events: &[Event], force: Option<&[i32]>, ticks: u64) -> (Vec<[i32; 2]>, Vec<TickReport>) {
    play(loaded, RATE, Skipping::On, events, force, ((ticks * TICK) as usize, &[128]))
}

#[test]
fn engine_plays_a_contact_as_it_plays_the_force_of_a_scraper() {
    for (pad, striker, rolls) in [("plate", 0, false), ("bowl", 1, true), ("bowl", 3, true)] {
        let mut loaded = scrapes(&[pad]);
        // A direct force goes to the first striker: the one that touches is made the first.
        let strikers = &mut loaded.kit.pads[0].strikers;
        strikers.swap(0, striker);
        strikers.truncate(1);
        let loaded = load(loaded.kit);
        let table = Kit::parse(&loaded.binary).unwrap();
        let contact = Contact::of(&table, 0, 0, rolls, NORMAL_N).unwrap();
        let motions: Vec<Motion> = (0..600).map(motion).chain(std::iter::repeat_n(Motion::default(), 100)).collect();
        let force = scrape::render(contact, &motions);
        let (by_force, _) = run(&loaded, &[], Some(&force), 700);
        let (by_events, reports) = run(&loaded, &stroke(0, 600, 0, rolls), None, 700);
        // Only the headroom is another, because the engine knows a contact's force beforehand.
        let power = |x: f64| x * x;
        let both = by_force.iter().flatten().zip(by_events.iter().flatten());
        let (signal, noise) = both.fold((0.0, 0.0), |(signal, noise), (&a, &b)| {
            (signal + power(a.into()), noise + power(f64::from(a) - f64::from(b)))
        });
        let snr_db = 10.0 * (signal / noise).log10();
        println!("{pad}, striker {striker}: {snr_db:.1} dB from the sound of the force");
        assert!(signal > 1e12 && snr_db > 100.0, "{pad}, striker {striker}: {snr_db} dB");
        assert!(reports.iter().any(|report| report.scrape_frames > 0) && reports[699].scrape_frames == 0);
    }
}

#[test]
fn motions_strikes_and_chokes_give_the_same_bits_in_blocks_of_any_length() {
    let loaded = scrapes(&["mug", "marimba"]);
    let on_second = |event: Event| Event { pad: 1, position: (event.time.frame % 9_000) as f32 / 9_000.0, ..event };
    let mut events = stroke(3, 500, 0, false);
    events.extend(stroke(40, 600, 1, true).into_iter().map(on_second));
    // Motions that are told between ticks take effect at the next one.
    events.iter_mut().skip(5).step_by(3).for_each(|event| event.time.frame -= event.time.frame % 7);
    let at =
        |frame: u64, action| Event { time: Time { frame, fraction: 1 << 30 }, velocity: 0.7, action, ..Event::NOTHING };
    events.extend((0..40).map(|strike| Event { position: 0.3, ..at(311 * strike, Action::Strike) }));
    events.extend((0..40).map(|strike| on_second(at(409 * strike, Action::Strike))));
    events.extend([at(5_001, Action::Choke), at(9_777, Action::Release)]);
    events.extend(stroke(560, 90, 2, false));
    // Touches within a tick, beside an impact that ends in it, and both in one tick.
    let rub = |tick: u64, first: u64| {
        let mut events = stroke(tick, 20, 3, false);
        events.iter_mut().for_each(|event| event.time.frame += first);
        events.into_iter().map(on_second)
    };
    events.extend(rub(655, 9).chain(rub(676, 3)));
    events.push(Event { time: Time::at_frame(660 * TICK + 5), action: Action::Silence, ..Event::NOTHING });
    events.sort_by_key(|event| event.time.first_frame());
    for skipping in [Skipping::On, Skipping::Off] {
        let run = |blocks: &[usize]| play(&loaded, RATE, skipping, &events, None, (700 * TICK_FRAMES, blocks)).0;
        let expected = run(&[32]);
        assert!(expected.iter().flatten().any(|sample| sample.unsigned_abs() > 1 << 20));
        for blocks in [&[1][..], &[33], &[128], &[7, 300, 2]] {
            assert!(run(blocks) == expected, "{skipping:?}, blocks of {blocks:?}");
        }
    }
}

#[test]
fn resting_contact_costs_nothing_and_sounds_again_when_it_moves() {
    let loaded = scrapes(&["plate"]);
    let table = Kit::parse(&loaded.binary).unwrap();
    let mut engine = lent::engine(&table, RATE, Skipping::On).unwrap();
    let mut out = [[0; 2]; TICK_FRAMES];
    let mut hear = |engine: &mut dsp_core::engine::Engine<'_, '_, _>, events: &[Event]| {
        engine.render(events, None, &mut out).unwrap();
        out.iter().flatten().any(|&x| x != 0)
    };
    hear(&mut engine, &[touch(0, 0, false)]);
    assert!(engine.is_silent() && engine.pass_silent_tick(), "it touches, and rests");
    let moving = Motion { velocity_m_per_s: [0.3, 0.0], normal_n: 0.5 };
    hear(&mut engine, &[event(2, 0, Action::Move(moving))]);
    assert!(!engine.is_silent() && (0..20).any(|_| hear(&mut engine, &[])), "it goes on by itself");
    let rest = event(engine.now() / TICK, 0, Action::Move(Motion { normal_n: 0.5, ..Motion::default() }));
    hear(&mut engine, &[rest]);
    let mut ticks = 0;
    while !engine.pass_silent_tick() {
        hear(&mut engine, &[]);
        ticks += 1;
        assert!(ticks < 20_000, "still sounding");
    }
    // An hour at rest, in which no tick has anything to do.
    for _ in 0..3_600 * 1_500 {
        assert!(engine.pass_silent_tick());
    }
    let now = engine.now() / TICK;
    hear(&mut engine, &[event(now, 0, Action::Move(moving))]);
    assert!((0..20).any(|_| hear(&mut engine, &[])), "it moves again after an hour");
}

#[test]
fn contact_moves_along_an_object_with_its_positions() {
    // One mode, which the first of two positions drives alone.
    let mut kit = scrapes(&["plate"]).kit;
    let name = kit.pads[0].object.clone();
    let object = kit.objects.iter_mut().find(|object| object.name == name).unwrap();
    object.modes.truncate(1);
    let gain = object.modes[0].gains[0];
    object.acceleration = kit::Acceleration::NONE;
    object.modes[0].gains = vec![gain, kit::Gain { sine: 0.0, cosine: 0.0 }];
    kit.strikers.iter_mut().for_each(|striker| striker.modes.clear());
    let loaded = load(kit);
    let motion = Action::Move(Motion { velocity_m_per_s: [0.3, 0.0], normal_n: 0.5 });
    let power = |from: f32, to: f32| {
        let mut events = vec![Event { position: from, ..touch(0, 0, false) }];
        events.extend((0..3_000).map(|tick| {
            let share = tick as f32 / 3_000.0;
            Event { position: from + share * (to - from), ..event(tick, 0, motion) }
        }));
        let (sound, _) = run(&loaded, &events, None, 3_000);
        let power = |half: &[[i32; 2]]| half.iter().map(|x| f64::from(x[0]).powi(2)).sum::<f64>();
        let (first, second) = sound.split_at(sound.len() / 2);
        [power(first), power(second)]
    };
    let (at_first, at_second, along) = (power(0.0, 0.0), power(1.0, 1.0), power(0.0, 1.0));
    println!("{at_first:?}, {at_second:?}, {along:?}");
    assert!(at_second == [0.0; 2], "the second position does not drive the mode");
    // The gain falls in a straight line: 7/12 of the power in the first half, 1/12 in the second.
    assert!((along[0] / at_first[0] / (7.0 / 12.0) - 1.0).abs() < 0.3, "{}", along[0] / at_first[0]);
    assert!((along[1] / at_first[1] / (1.0 / 12.0) - 1.0).abs() < 0.4, "{}", along[1] / at_first[1]);
}

#[test]
fn third_contact_at_once_is_refused_and_told() {
    let loaded = scrapes(&["mug"]);
    let mut events: Vec<Event> = (0..3).map(|striker| touch(0, striker, false)).collect();
    let (_, reports) = run(&loaded, &events, None, 3);
    assert_eq!((STANDARD_SCRAPES, reports[0].refused_scrapes), (2, 1));
    // A touch by a striker that touches already needs no other place, and a lift gives one back.
    events =
        vec![touch(0, 0, false), touch(0, 1, false), touch(1, 0, false), event(2, 1, Action::Lift), touch(3, 2, false)];
    let (_, reports) = run(&loaded, &events, None, 5);
    assert!(reports.iter().all(|report| report.refused_scrapes == 0));
}

#[test]
fn motions_that_no_contact_can_make_are_refused_by_name() {
    let mut kit = scrapes(&["mug", "glass"]).kit;
    let glass = kit.pads[1].object.clone();
    kit.objects.iter_mut().find(|object| object.name == glass).unwrap().surface = None;
    let loaded = load(kit);
    let table = Kit::parse(&loaded.binary).unwrap();
    let mut engine = lent::engine(&table, RATE, Skipping::On).unwrap();
    let mut refuse = |event: Event| engine.render(&[event], None, &mut [[0; 2]; 64]).expect_err("a wrong event");
    let fast = Action::Move(Motion { velocity_m_per_s: [8.0, 7.0], normal_n: 0.5 });
    let error = refuse(event(0, 0, fast));
    assert!(matches!(error, EventError::Motion { index: 0, error: MotionError::Speed { .. } }));
    assert!(error.to_string().contains("10 m/s"), "{error}");
    let no_number = Action::Move(Motion { velocity_m_per_s: [f32::NAN, 0.0], normal_n: 0.5 });
    assert!(matches!(refuse(event(0, 0, no_number)), EventError::Motion { .. }));
    let range = Action::Touch { rolls: false, normal_n: [0.0, f32::NAN] };
    assert!(matches!(refuse(event(0, 0, range)), EventError::Motion { error: MotionError::NormalForce, .. }));
    let error = refuse(touch(0, 0, true));
    assert_eq!(error, EventError::NoSurface { index: 0, pad: 0, striker: 0, rolls: true });
    assert!(error.to_string().contains("[striker.roll]"), "{error}");
    let error = refuse(Event { pad: 1, ..touch(0, 0, false) });
    assert!(matches!(error, EventError::NoSurface { pad: 1, .. }) && error.to_string().contains("surface"), "{error}");
}

#[test]
fn end_of_all_sound_ends_contacts_until_they_touch_again() {
    let loaded = scrapes(&["plate"]);
    let is_any = |sound: &[[i32; 2]], ticks: std::ops::Range<usize>| {
        sound[ticks.start * TICK_FRAMES..ticks.end * TICK_FRAMES].iter().flatten().any(|&x| x != 0)
    };
    // The order comes while it sounds, or on the frame of the touch after it.
    for again in [300, 100] {
        let mut events = stroke(0, 400, 0, false);
        events.insert(1 + 100, event(100, 0, Action::Silence));
        let place = 1 + events.iter().rposition(|event| event.time.frame <= again * TICK).unwrap();
        events.insert(place, touch(again, 0, false));
        events.sort_by_key(|event| event.time.first_frame());
        let (sound, _) = run(&loaded, &events, None, 400);
        assert!(is_any(&sound, 60..100) && is_any(&sound, again as usize + 20..400), "again at {again}");
        assert!(again == 100 || !is_any(&sound, 109..300));
    }
    // A contact at rest in a silent engine ends too, and so does one told in the same tick.
    let moving = event(12, 0, Action::Move(Motion { velocity_m_per_s: [0.3, 0.0], normal_n: 0.5 }));
    let silence = event(10, 0, Action::Silence);
    let soon = |frame: u64, event: Event| Event { time: Time::at_frame(10 * TICK + frame), ..event };
    for skipping in [Skipping::On, Skipping::Off] {
        for events in [
            vec![touch(0, 0, false), silence, moving],
            vec![soon(3, touch(0, 0, false)), soon(4, moving), soon(5, silence), moving],
        ] {
            let (sound, _) = play(&loaded, RATE, skipping, &events, None, (60 * TICK_FRAMES, &[TICK_FRAMES]));
            assert!(!is_any(&sound, 0..60), "{skipping:?}: {events:?}");
        }
    }
}
