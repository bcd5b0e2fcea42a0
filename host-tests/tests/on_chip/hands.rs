//! Hands and positions on the virtual core: their cycles, and bits equal to the PC's.
//!
//! `cargo test -p host-tests --test on_chip hands -- --nocapture` prints the cycles.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Action, Event};
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit;
use host_tests::lent;
use host_tests::on_chip::EngineOnChip;
use host_tests::on_chip::budget_scenes::{at_two_places, hands_on};
use host_tests::on_chip::lone_pad::kit_of;
use host_tests::on_chip::scenes::{choked_pads, pads_with_positions};
use host_tests::scene::{hand, load, strike};

const RATE: SampleRate = SampleRate::HZ_48000;

/// Cycles that an engine spends over a scene in functions whose names contain a word, for each
/// word. The sound must have the PC's bits.
fn spent(loaded: &kit::Loaded, events: &[Event], ticks: usize, words: &[&str]) -> Vec<u64> {
    let mut chip = EngineOnChip::new().unwrap();
    chip.load(&loaded.binary, RATE).unwrap();
    let view = Kit::parse(&loaded.binary).unwrap();
    let mut engine = lent::engine(&view, RATE, Skipping::On).unwrap();
    chip.machine().clear_counts();
    for tick in 0..ticks {
        let frames = (tick * TICK_FRAMES) as u64..((tick + 1) * TICK_FRAMES) as u64;
        let now: Vec<Event> =
            events.iter().filter(|event| frames.contains(&event.time.first_frame())).copied().collect();
        let mut expected = vec![[0; 2]; TICK_FRAMES];
        engine.render(&now, None, &mut expected).unwrap();
        let (got, _) = chip.render(&now, None, TICK_FRAMES).unwrap();
        assert!(got == expected, "tick {tick}");
    }
    let profile = chip.machine().profile();
    let of = |word: &&str| {
        let functions = profile.iter().filter(|function| function.name.contains(word));
        functions.map(|function| function.cost.nominal).sum()
    };
    words.iter().map(of).collect()
}

#[test]
fn a_hand_takes_at_most_60_cycles_a_mode_and_has_the_same_bits_on_the_chip() {
    let spent = spent(
        &choked_pads(4),
        &hands_on(4),
        100,
        &["reach", "lay_hand", "change_choke", "choke_stages", "settle", "make_room"],
    );
    // The scene chokes and releases four pads of 64 modes from 80 Hz.
    let modes = 2.0 * 4.0 * 64.0;
    let per_mode = spent.iter().sum::<u64>() as f64 / modes;
    println!("{per_mode:.1} cycles a mode: {spent:?} of {modes} modes");
    assert!((10.0..=60.0).contains(&per_mode), "{per_mode:.1} cycles a mode");
}

#[test]
fn strikes_at_two_places_have_the_same_bits_on_the_chip() {
    let mut events = at_two_places(4);
    events.extend(hands_on(4).into_iter().filter(|event| event.velocity == 0.0));
    events.sort_by_key(|event| event.time);
    let words = ["set_position", "driven_twice", "gain", "malleus_kernel"];
    let spent = spent(&pads_with_positions(4), &events, 80, &words);
    let moves = 4.0 * 8.0 * 64.0;
    println!("at most {moves} modes moved: {words:?} {spent:?}");
    assert!(spent[1] > 0, "no force in the second slot");
}

#[test]
fn a_hand_on_frames_costs_what_the_page_states_and_has_the_pcs_bits() {
    const RATE: SampleRate = SampleRate::HZ_44100;
    let mut kit = kit_of(1025, 0);
    // So slow that modes ring to the end of the scene.
    kit.pads[0].choke_t60_s = 2.0;
    let loaded = load(kit);
    let view = Kit::parse(&loaded.binary).unwrap();
    let mut chip = EngineOnChip::new().unwrap();
    // Frames between strikes; cycles a frame free, and the dearest tick; the same under the hand.
    for (every, stated) in [(100_000, [715.0, 764.0, 782.0, 877.0]), (44, [2065.0, 2281.0, 2234.0, 2637.0])] {
        chip.load(&loaded.binary, RATE).unwrap();
        let mut engine = lent::engine(&view, RATE, Skipping::On).unwrap();
        let hands = [(24 * 256, Action::Choke), (40 * 256, Action::Release)];
        let mut events: Vec<_> = (300..48 * 256).step_by(every).map(|frame| strike(frame, 0.8)).collect();
        events.extend(hands.map(|(frame, action)| hand(frame, action)));
        events.sort_by_key(|event| event.time.frame);
        let mut measured = [0.0f64; 4];
        for tick in 0..48 * 8 {
            let frames = (tick * TICK_FRAMES) as u64..((tick + 1) * TICK_FRAMES) as u64;
            let now: Vec<Event> =
                events.iter().filter(|event| frames.contains(&event.time.first_frame())).copied().collect();
            let mut expected = vec![[0; 2]; TICK_FRAMES];
            engine.render(&now, None, &mut expected).unwrap();
            let (got, call) = chip.render(&now, None, TICK_FRAMES).unwrap();
            assert!(got == expected, "tick {tick}");
            let cycles = call.cost.nominal as f64 / TICK_FRAMES as f64;
            // Whole blocks without a hand, and under it.
            let at = match tick / 8 {
                8..24 => 0,
                26..40 => 2,
                _ => continue,
            };
            measured[at] += cycles / if at == 0 { 128.0 } else { 112.0 };
            measured[at + 1] = measured[at + 1].max(cycles);
        }
        println!(
            "a strike each {every} frames: free and under a hand {measured:.0?} cycles a frame, mean and dearest tick"
        );
        for (measured, stated) in measured.into_iter().zip(stated) {
            assert!((measured / stated - 1.0).abs() <= 0.03, "{measured:.0} cycles a frame, not {stated}");
        }
    }
}
