//! Independence of the sound from the caller's block size, bit for bit.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Action, Event, Time};
use dsp_core::resonator::TICK_FRAMES;
use host_tests::scene::{load, play};

/// Strikes between samples, chokes and releases, at all positions and velocities, and a force that
/// comes and goes.
fn busy_piece(kit: &kit::Kit) -> (Vec<Event>, Vec<i32>) {
    let mut random = 1u64;
    let mut next = |below: u64| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) % below
    };
    let mut frame = 0;
    let mut events = Vec::new();
    for _ in 0..300 {
        frame += next(200);
        let pad = next(kit.pads.len() as u64) as usize;
        events.push(Event {
            time: Time { frame, fraction: (next(4) << 30) as u32 },
            pad: pad as u8,
            velocity: next(1001) as f32 / 1000.0,
            position: next(1001) as f32 / 1000.0,
            striker: next(kit.pads[pad].strikers.len() as u64) as u8,
            action: [Action::Strike, Action::Strike, Action::Strike, Action::Choke, Action::Release][next(5) as usize],
        });
    }
    events.sort_by_key(|event| event.time);
    let force = (0..frame)
        .map(|n| if (n / 3_000) % 2 == 0 { (next(1 << 28) as i32) - (1 << 27) } else { 0 } >> (n / 1_000 % 16));
    (events, force.collect())
}

#[test]
fn the_same_events_give_the_same_bits_in_any_blocks_with_and_without_skipping() {
    let mut kit = kit::open("demo").expect("the shipped kit is valid").kit;
    kit.pads.truncate(7);
    let loaded = load(kit);
    let (events, force) = busy_piece(&loaded.kit);
    let frames = 40_000 / TICK_FRAMES * TICK_FRAMES;
    for skipping in [Skipping::On, Skipping::Off] {
        for rate in [SampleRate::HZ_48000, SampleRate::new(86_000_000, 1792).expect("a board's rate")] {
            let run = |blocks: &[usize]| play(&loaded, rate, skipping, &events, Some(&force), (frames, blocks));
            let (expected, _) = run(&[32]);
            assert!(expected.iter().flatten().any(|sample| sample.unsigned_abs() > 1 << 24));
            for blocks in [&[8][..], &[33], &[128], &[1], &[127], &[1, 5, 64, 3, 200, 31]] {
                assert!(run(blocks).0 == expected, "{skipping:?}, {rate}, blocks of {blocks:?}");
            }
        }
    }
}
