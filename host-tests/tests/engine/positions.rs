//! Positions: each contact drives the gains of the place where it strikes.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Action, Event, Time};
use host_tests::performance::{instrument, reference, snr_db};
use host_tests::scene::{load, one_pad, play};
use kit::{Gain, Loaded, Mode};
use malleus::render::Performance;
use proptest::prelude::*;

const RATE: SampleRate = SampleRate::HZ_48000;

fn strike_at(time_samples: f64, position: f32, velocity: f32) -> Event {
    let frame = time_samples.floor();
    let fraction = ((time_samples - frame) * 4_294_967_296.0) as u32;
    Event { time: Time { frame: frame as u64, fraction }, position, velocity, ..Event::default() }
}

fn snr_to_the_reference(loaded: &Loaded, events: Vec<Event>) -> (f64, u32) {
    let performance = Performance::new(events, None, &loaded.kit, RATE, Some(0.3));
    let (bus, reports) = instrument(loaded, &performance, RATE, Skipping::Off);
    let merged = reports.iter().map(|report| report.merged_positions).sum();
    (snr_db(&reference(loaded, &performance, RATE), &bus), merged)
}

/// Modes from 100 Hz to 20 kHz with gains at `positions` places. Every other mode has cosine gains.
fn modes(gains: &[(f32, f32)], positions: usize) -> Vec<Mode> {
    let count = gains.len() / positions;
    let of_mode = |(index, gains): (usize, &[(f32, f32)])| Mode {
        frequency_hz: 100.0 * 200f32.powf(index as f32 / count as f32),
        decay_per_s: 5.0 + 3.0 * index as f32,
        gains: gains
            .iter()
            .map(|&(sine, cosine)| Gain { sine, cosine: if index % 2 == 0 { cosine } else { 0.0 } })
            .collect(),
    };
    gains.chunks_exact(positions).enumerate().map(of_mode).collect()
}

/// Kit whose object has 24 modes, with gains that differ from place to place.
fn table() -> Loaded {
    let gains: Vec<(f32, f32)> =
        (0..72).map(|n| ((n as f32 * 1.7).sin() * 40.0, (n as f32 * 2.3).cos() * 10.0)).collect();
    let mut kit = one_pad(modes(&gains, 3));
    kit.strikers[0].contact_time_s = 0.003;
    load(kit)
}

#[test]
fn two_strikes_at_two_places_within_a_contact_agree_with_the_reference() {
    let loaded = table();
    for apart_ms in [0.1, 0.5, 1.0, 2.0] {
        let events = vec![strike_at(100.0, 0.0, 0.9), strike_at(100.0 + 48.0 * apart_ms, 0.7, 0.8)];
        let (snr, merged) = snr_to_the_reference(&loaded, events);
        println!("{apart_ms} ms apart: {snr:.1} dB");
        assert!(snr >= 100.0 && merged == 0, "{apart_ms} ms: {snr:.1} dB, {merged} merged");
    }
}

#[test]
fn a_strike_at_a_third_place_is_merged_into_the_nearer_and_counted() {
    let loaded = table();
    let events = vec![strike_at(100.0, 0.0, 0.9), strike_at(120.0, 0.7, 0.8), strike_at(140.0, 0.6, 0.8)];
    let performance = Performance::new(events.clone(), None, &loaded.kit, RATE, Some(0.1));
    let (bus, reports) = instrument(&loaded, &performance, RATE, Skipping::Off);
    assert_eq!(reports.iter().map(|report| report.merged_positions).sum::<u32>(), 1);
    // The third strike is played at 0.7.
    let mut nearer = performance;
    nearer.events[2].position = 0.7;
    let snr = snr_db(&reference(&loaded, &nearer, RATE), &bus);
    println!("{snr:.1} dB to the reference with the third at the nearer place");
    assert!(snr >= 100.0, "{snr:.1} dB");
}

#[test]
fn a_pad_with_one_position_is_struck_in_one_slot_whatever_its_strikes_say() {
    let loaded = load(one_pad(modes(&[(40.0, 0.0); 12], 1)));
    let events = vec![strike_at(10.0, 0.0, 0.9), strike_at(20.0, 0.7, 0.8), strike_at(25.0, 1.0, 0.8)];
    let (snr, merged) = snr_to_the_reference(&loaded, events);
    assert!(snr >= 100.0 && merged == 0, "{snr:.1} dB, {merged} merged");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, max_shrink_iters: 60, ..ProptestConfig::default() })]

    #[test]
    fn strikes_anywhere_on_any_table_agree_with_the_law_until_one_is_merged(
        gains in prop::collection::vec((10f32..60.0, -20f32..20.0, any::<bool>()), 8..160),
        positions in 2usize..5,
        mut strikes in prop::collection::vec((0.0f64..4_000.0, 0u8..5, 0.2f32..1.0), 2..12),
        choke: bool,
        block in 1usize..200,
    ) {
        let gains: Vec<_> = gains.into_iter().map(|(s, c, flips)| (if flips { -s } else { s }, c)).collect();
        let mut kit = one_pad(modes(&gains, positions));
        kit.strikers[0].contact_time_s = 0.002;
        kit.pads[0].choke_t60_s = 0.2;
        let loaded = load(kit);
        strikes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut events: Vec<Event> = strikes
            .iter()
            .map(|&(at, place, velocity)| strike_at(at, f32::from(place) / 4.0, velocity))
            .collect();
        if choke {
            for (frame, action) in [(700, Action::Choke), (2_300, Action::Release)] {
                events.push(Event { time: Time::at_frame(frame), action, ..Event::default() });
            }
            events.sort_by_key(|event| event.time);
        }
        let blocks = |size: usize| play(&loaded, RATE, Skipping::On, &events, None, (6_000, &[size])).0;
        prop_assert!(blocks(block) == blocks(32), "blocks of {block} change the bits");
        let (snr, merged) = snr_to_the_reference(&loaded, events);
        prop_assert!(merged > 0 || snr >= 96.0, "{snr:.1} dB");
    }
}
