//! Hands on pads in frames: against the reference, in the caller's blocks, and what is heard.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Action, Event};
use host_tests::performance::{instrument, largest_difference, reference, snr_db};
use host_tests::scene::{hand, load, play, strike};
use malleus::render::Performance;

use crate::frames::{is_in_frames, strike_at, thing};

const RATE: SampleRate = SampleRate::HZ_44100;

/// Strikes before a hand, under it, and behind its release; the hand comes twice.
fn strikes_and_hands() -> Vec<Event> {
    let mut events: Vec<_> =
        [(100, 0.0), (1_700, 0.6), (3_250, 0.6), (3_303, 1.0), (6_000, 0.3), (9_001, 0.0), (20_000, 0.2)]
            .map(|(frame, position)| strike_at(frame, position, 0.8))
            .to_vec();
    let hands = [(2_000, Action::Choke), (5_000, Action::Release), (7_040, Action::Choke), (8_191, Action::Release)];
    events.extend(hands.map(|(frame, action)| hand(frame, action)));
    events.sort_by_key(|event| event.time.frame);
    events
}

#[test]
fn hands_on_a_thousand_modes_agree_with_the_reference() {
    for (modes, positions, choke_t60_s) in [(1025, 1, 0.1), (300, 3, 0.1), (300, 1, 0.015), (300, 1, 3.0)] {
        let mut kit = thing(modes, positions);
        kit.pads[0].choke_t60_s = choke_t60_s;
        let loaded = load(kit);
        assert!(is_in_frames(&loaded));
        let force: Vec<i32> = (0..12_000i32)
            .map(|n| if (2_300..4_700).contains(&n) { n.wrapping_mul(2_654_435) >> 6 } else { 0 })
            .collect();
        for direct in [None, Some((0, force))] {
            let with = if direct.is_some() { "a direct force" } else { "strikes alone" };
            let performance = Performance::new(strikes_and_hands(), direct, &loaded.kit, RATE, Some(0.4));
            let bus = instrument(&loaded, &performance, RATE, Skipping::Off).0;
            let expected = reference(&loaded, &performance, RATE);
            let (snr, error) = (snr_db(&expected, &bus), 20.0 * largest_difference(&expected, &bus).log10());
            let choked = snr_db(&expected[3_300..3_700], &bus[3_300..3_700]);
            println!(
                "{modes} modes, {positions} positions, choke T60 {choke_t60_s} s, {with}: SNR {snr:.1} dB, under the hand {choked:.1} dB, largest error {error:.1} dBFS"
            );
            assert!(snr >= 121.0 && choked >= 120.0 && error <= -120.0, "{modes} modes: {snr:.1} dB, {choked:.1} dB");
        }
    }
}

#[test]
fn a_hand_comes_with_the_block_behind_the_next_one_and_changes_nothing_before() {
    let mut kit = thing(300, 1);
    kit.pads[0].choke_t60_s = 0.05;
    let loaded = load(kit);
    // The tick of frame 2000 is 2016; the next block begins at 2048, the one behind it at 2304.
    let choked = [strike(100, 1.0), hand(2_000, Action::Choke)];
    let frames = (4_096, &[64][..]);
    let sound = play(&loaded, RATE, Skipping::On, &choked, None, frames).0;
    let free = play(&loaded, RATE, Skipping::On, &choked[..1], None, frames).0;
    let first = sound.iter().zip(&free).position(|(a, b)| a != b).expect("the hand is heard");
    assert!((2_305..2_320).contains(&first), "{first}");
}

#[test]
fn the_callers_blocks_change_no_bit_under_a_hand() {
    let mut kit = thing(230, 2);
    kit.pads[0].choke_t60_s = 0.08;
    let loaded = load(kit);
    let mut events = strikes_and_hands();
    // In silence, with ticks that are skipped, a hand comes too.
    events.extend([hand(130_007, Action::Choke), strike(140_000, 0.8), hand(141_111, Action::Release)]);
    let of_blocks = |blocks: &[usize]| play(&loaded, RATE, Skipping::On, &events, None, (150_000, blocks)).0;
    let whole = of_blocks(&[32]);
    assert!(whole[120_000..130_000] == [[0; 2]; 10_000] && whole[142_000] != [0; 2]);
    for blocks in [&[1][..], &[8], &[33], &[128], &[1000], &[7, 256, 1, 90]] {
        assert!(of_blocks(blocks) == whole, "blocks of {blocks:?} change the bits");
    }
}

#[test]
fn a_hand_that_is_gone_again_in_silence_changes_no_later_strike() {
    let mut kit = thing(300, 1);
    kit.pads[0].choke_t60_s = 0.05;
    let loaded = load(kit);
    // The release comes after the block has begun that would have brought the hand.
    let events = [hand(10, Action::Choke), hand(260, Action::Release), strike(9_000, 1.0)];
    let sound = |events: &[Event]| play(&loaded, RATE, Skipping::On, events, None, (12_000, &[64][..])).0;
    let (with, without) = (sound(&events), sound(&events[2..]));
    let difference = with.iter().flatten().zip(without.iter().flatten()).map(|(a, b)| (a - b).abs()).max();
    println!("{difference:?} bus steps");
    // Modes retire in turns that count the blocks of sound, and each at most at -100 dBFS.
    assert!(difference < Some(1_342), "{difference:?}");
}

#[test]
fn a_hand_on_a_pad_that_cannot_be_choked_changes_no_bit() {
    let loaded = load(thing(300, 1));
    let events = [strike(100, 1.0), hand(700, Action::Choke), strike(2_000, 0.7)];
    let sound = |events: &[Event]| play(&loaded, RATE, Skipping::On, events, None, (6_000, &[64][..])).0;
    assert!(sound(&events) == sound(&[events[0], events[2]]));
}

#[test]
fn a_choked_pad_in_frames_falls_silent_and_a_pad_beside_it_rings_on() {
    let mut kit = thing(250, 1);
    kit.pads[0].choke_t60_s = 0.1;
    let mut second = kit.pads[0].clone();
    second.name = "second".into();
    kit.pads.push(second);
    let loaded = load(kit);
    let other = |event: Event| Event { pad: 1, ..event };
    let events = [strike(0, 1.0), other(strike(600, 1.0)), hand(1_000, Action::Choke)];
    let frames = (60_000, &[64][..]);
    let reports = play(&loaded, RATE, Skipping::On, &events, None, frames).1;
    let sound = play(&loaded, RATE, Skipping::Off, &events, None, frames).0;
    let second = play(&loaded, RATE, Skipping::Off, &events[1..2], None, frames).0;
    // 0.3 s after the hand 180 dB are gone: what is left is the second pad, but for roundings.
    let rest = sound[14_500..].iter().flatten().zip(second[14_500..].iter().flatten());
    let difference = rest.map(|(a, b)| (a - b).abs()).max();
    println!("{difference:?} bus steps");
    assert!(difference <= Some(4) && second[14_500..].iter().any(|frame| frame[0].abs() > 100_000));
    assert!(reports[500].ringing_pads == 1 && reports[20].ringing_pads == 2);
}
