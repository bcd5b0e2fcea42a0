//! Arbitrary valid tables, events and forces: no panic, bounded output, silence in the end.
//! Overflow checks and the kernels' headroom assertions are on.

use dsp_core::SampleRate;
use dsp_core::engine::{Direct, Skipping};
use dsp_core::event::{Action, Event, Time};
use dsp_core::table::Kit as KitView;
use host_tests::lent;
use kit::{Acceleration, Gain, Kit, Loaded, Mode, Object, Pad, Pulse, Striker};
use proptest::prelude::*;

/// Magnitudes from tiny to `max` with either sign, and 0.
fn magnitude(max: f32) -> impl Strategy<Value = f32> {
    prop_oneof![1 => Just(0.0), 6 => (-30.0f32..0.0, any::<bool>()).prop_map(move |(log2, negative)| {
        let value = max * log2.exp2();
        if negative { -value } else { value }
    })]
}

fn modes(positions: usize, most: usize) -> impl Strategy<Value = Vec<Mode>> {
    // T60s of 1 to 80 ms are short enough for silence within the test. Frequencies go beyond
    // Nyquist.
    let mode = (0.0f32..1.0, 80.0f32..7_000.0, prop::collection::vec((magnitude(1e6), magnitude(1e6)), positions));
    prop::collection::vec(mode, 0..most).prop_map(|modes| {
        modes
            .into_iter()
            .map(|(place, decay_per_s, gains)| Mode {
                frequency_hz: 0.1 * 400_000f32.powf(place),
                decay_per_s,
                gains: gains.into_iter().map(|(sine, cosine)| Gain { sine, cosine }).collect(),
            })
            .collect()
    })
}

prop_compose! {
    fn object(index: usize)(positions in 1usize..4)(
        modes in modes(positions, 40), reference_force in -10.0f32..8.0, acceleration in magnitude(1e3),
    ) -> Object {
        Object {
            name: format!("object {index}"), source: String::new(), licence: String::new(),
            reference_force: reference_force.exp2(), acceleration: Acceleration::Factor(acceleration), modes, residual: None, dynamic_filter: None, biquads: None,
            surface: None,
        }
    }
}

prop_compose! {
    fn striker(index: usize)(
        gaussian: bool, peak in -10.0f32..12.0, peak_exponent in 0.0f32..4.0, contact in -15.0f32..-5.0,
        contact_exponent in -0.5f32..0.5, restitution in 0.1f32..=1.0,
        modes in modes(1, 8),
    ) -> Striker {
        Striker {
            name: format!("striker {index}"), source: String::new(), licence: String::new(),
            pulse: if gaussian { Pulse::Gaussian } else { Pulse::Hertz },
            peak_force: peak.exp2(), peak_exponent, contact_time_s: contact.exp2(), contact_exponent,
            restitution: if gaussian { Striker::DEFAULT_RESTITUTION } else { restitution },
            scrape: None,
            roll: None, modes,
        }
    }
}

prop_compose! {
    fn kit()(
        objects in (object(0), object(1)), strikers in (striker(0), striker(1)),
        pads in prop::collection::vec((0usize..2, any::<bool>(), -60.0f32..40.0, -1.0f32..=1.0, magnitude(10.0), 0.0f32..0.3), 1..4),
    ) -> Kit {
        Kit {
            name: "arbitrary".into(),
            objects: vec![objects.0, objects.1],
            strikers: vec![strikers.0, strikers.1],
            pads: pads.into_iter().enumerate().map(|(index, (object, both, level_db, pan, weight, choke))| Pad {
                name: format!("pad {index}"),
                object: format!("object {object}"),
                strikers: (0..1 + usize::from(both)).map(|striker| format!("striker {striker}")).collect(),
                level_db, pan, striker_weight: weight,
                choke_t60_s: if choke < 0.05 { 0.0 } else { choke },
                midi_notes: Vec::new(),
                note_off: kit::NoteOff::Nothing,
                trigger: None,
            }).collect(),
            background: None,
            room: vec![],
            headphone_db: None,
        surfaces: Vec::new(),
        }
    }
}

/// Events in the first 6000 frames, made for a kit from raw numbers.
fn events(kit: &Kit, raw: &[(u16, u32, u8, f32, f32, u8, u8)]) -> Vec<Event> {
    let mut events: Vec<Event> = raw
        .iter()
        .map(|&(frame, fraction, pad, velocity, position, striker, action)| {
            let pad = usize::from(pad) % kit.pads.len();
            Event {
                time: Time { frame: u64::from(frame) % 6_000, fraction },
                pad: pad as u8,
                velocity,
                position,
                striker: striker % kit.pads[pad].strikers.len() as u8,
                action: [Action::Strike, Action::Strike, Action::Choke, Action::Release][usize::from(action) % 4],
            }
        })
        .collect();
    events.sort_by_key(|event| event.time);
    events
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, max_shrink_iters: 200, ..ProptestConfig::default() })]

    #[test]
    fn no_table_and_no_event_makes_the_engine_panic_wrap_or_ring_for_ever(
        kit in kit(),
        raw in prop::collection::vec(any::<(u16, u32, u8)>().prop_flat_map(|(frame, fraction, pad)| {
            (Just(frame), Just(fraction), Just(pad), 0.0f32..=1.0, 0.0f32..=1.0, any::<u8>(), any::<u8>())
        }), 0..60),
        force in prop::collection::vec(any::<i32>(), 0..3_000),
        quiet in 0u32..31,
        block in 1usize..200,
        skip: bool,
        rate in prop_oneof![Just((48_000, 1)), Just((44_100, 1)), Just((22_050, 1)), Just((192_000, 1)), Just((86_000_000, 1792))],
    ) {
        let loaded = Loaded {
            binary: kit::binary::build(&kit).expect("within all ranges"),
            kit,
            skipped_sections: Vec::new(),
        };
        let view = KitView::parse(&loaded.binary).expect("it was built");
        let rate = SampleRate::new(rate.0, rate.1).expect("a rate");
        // A kit that the rate cannot hold must be refused, and no more.
        let Ok(mut engine) = lent::engine(&view, rate, if skip { Skipping::On } else { Skipping::Off }) else {
            return Ok(());
        };
        let all_events = events(&loaded.kit, &raw);
        let mut rest = all_events.as_slice();
        // A T60 of 80 ms falls by 160 dB in 0.22 s. Gains may add 250 dB, and contacts last up to
        // 0.25 s. Chokes only shorten the sound.
        let frames = 8_000 + (rate.hz() * 1.2) as usize;
        let mut last = [[0; 2]; 32];
        let mut out = vec![[0; 2]; block];
        while (engine.now() as usize) < frames {
            let start = engine.now();
            let due = rest.iter().take_while(|event| event.time.first_frame() < start + block as u64).count();
            let now: Vec<i32> = force.iter().map(|x| x >> quiet).skip(start as usize)
                .chain(std::iter::repeat(0)).take(block).collect();
            engine.render(&rest[..due], Some(Direct { pad: 0, force: &now }), &mut out).expect("valid events");
            rest = &rest[due..];
            for frame in &out {
                prop_assert!(frame.iter().all(|x| (-(1 << 23)..1 << 23).contains(x)));
                last.rotate_left(1);
                last[31] = *frame;
            }
        }
        prop_assert!(engine.is_silent() || !skip, "still ringing");
        prop_assert!(last.iter().all(|frame| *frame == [0, 0]), "not silent: {:?}", last[31]);
    }
}
