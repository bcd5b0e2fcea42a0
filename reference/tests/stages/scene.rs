//! Scene: pads mixed to stereo, and the errors of invalid scenes.

use reference::pad::render_mono;
use reference::scene::{level_gain, pan_gains, quantise_24};
use reference::{BankOwner, Direct, Error, Event, Gain, Pad, Pulse, SampleRate, Scene, Striker, render};

use crate::build::{RATE, choke, hertz_striker, mode, noise, pad, release, some_modes, strike};

fn two_pads() -> Vec<Pad> {
    let mallet = Striker { pulse: Pulse::Gaussian, modes: some_modes(), ..hertz_striker() };
    let left = Pad { pan: -0.5, level_db: -3.0, striker_weight: 0.2, ..pad(some_modes(), vec![mallet]) };
    let right = Pad { pan: 0.8, level_db: 2.0, ..pad(vec![mode(330.0, 2.0, 1.0, 0.0)], vec![hertz_striker()]) };
    vec![left, right]
}

fn events() -> Vec<Event> {
    vec![
        strike(0.0, 0, 1.0),
        strike(12.5, 1, 0.3),
        strike(400.25, 0, 0.6),
        choke(1_000.0),
        strike(1_000.0, 0, 0.5),
        release(1_500.75),
        strike(1_777.7, 1, 0.9),
    ]
}

#[test]
fn blocks_of_any_size_give_the_same_bits() {
    let pads = two_pads();
    let force = noise(900);
    let direct = Some(Direct { pad: 1, force: &force });
    let whole = render(&pads, &events(), direct, RATE, 3_000).expect("a valid scene");
    assert!(whole.iter().any(|frame| frame[0].abs() > 0.001));
    for block in [1, 31, 256, 257, 1_000] {
        let mut scene = Scene::new(&pads, &events(), direct, RATE).expect("a valid scene");
        let mut pieces = vec![[0.0; 2]; 3_000];
        pieces.chunks_mut(block).for_each(|frames| scene.render(frames));
        assert_eq!(pieces, whole, "blocks of {block}");
    }
}

#[test]
fn a_frame_is_the_sum_of_the_pads_at_their_level_and_pan() {
    let pads = two_pads();
    let frames = render(&pads, &events(), None, RATE, 2_500).expect("a valid scene");
    let mono = [0, 1].map(|pad| render_mono(&pads, pad, &events(), None, RATE, 2_500).expect("a valid scene"));
    for (n, frame) in frames.iter().enumerate() {
        for (side, y) in frame.iter().enumerate() {
            let of_pad =
                |index: usize| level_gain(pads[index].level_db) * pan_gains(pads[index].pan)[side] * mono[index][n];
            assert!((y - of_pad(0) - of_pad(1)).abs() < 1e-15);
        }
    }
}

#[test]
fn gains_of_a_pad_that_nothing_plays_are_not_checked() {
    let mut pads = two_pads();
    pads[1].object.modes[0].gains.clear();
    assert!(Scene::new(&pads, &[strike(0.0, 0, 1.0)], None, RATE).is_ok());
    assert!(Scene::new(&pads, &[strike(0.0, 1, 1.0)], None, RATE).is_err());
}

#[test]
fn panning_keeps_the_power() {
    for step in -10..=10 {
        let [left, right] = pan_gains(f64::from(step) / 10.0);
        assert!((left * left + right * right - 1.0).abs() < 1e-15);
    }
    let close = |gains: [f64; 2], to: [f64; 2]| (gains[0] - to[0]).hypot(gains[1] - to[1]) < 1e-15;
    assert!(close(pan_gains(-1.0), [1.0, 0.0]));
    assert!(close(pan_gains(0.0), [0.5_f64.sqrt(); 2]));
    assert!(close(pan_gains(1.0), [0.0, 1.0]));
}

#[test]
fn minus_twenty_db_is_a_gain_of_a_tenth() {
    assert_eq!(level_gain(0.0), 1.0);
    assert!((level_gain(-20.0) - 0.1).abs() < 1e-15);
}

#[test]
fn quantising_rounds_halves_up_and_clips() {
    let lsb = 1.0 / f64::from(1 << 23);
    assert_eq!(quantise_24(0.0), 0);
    assert_eq!(quantise_24(0.5 * lsb), 1);
    assert_eq!(quantise_24(-0.5 * lsb), 0);
    assert_eq!(quantise_24(-1.5 * lsb), -1);
    assert_eq!(quantise_24(1.49 * lsb), 1);
    assert_eq!(quantise_24(-1.51 * lsb), -2);
    assert_eq!(quantise_24(1.0), 8_388_607);
    assert_eq!(quantise_24(-1.0), -8_388_608);
    assert_eq!(quantise_24(f64::INFINITY), 8_388_607);
    assert_eq!(quantise_24(-7.0), -8_388_608);
    assert_eq!(quantise_24(f64::NAN), 0);
}

#[test]
fn a_rate_is_the_exact_ratio() {
    let rate = SampleRate { numerator: 86_000_000, denominator: 1_792 };
    assert!((rate.hz() - 47_991.071_428_571_43).abs() < 1e-9);
}

#[test]
fn an_event_for_a_missing_pad_is_named() {
    let error = render(&two_pads(), &[strike(0.0, 0, 1.0), strike(1.0, 7, 1.0)], None, RATE, 1).unwrap_err();
    assert_eq!(error, Error::EventPad { event: 1, pad: 7, pad_count: 2 });
}

#[test]
fn a_strike_with_a_missing_striker_is_named() {
    let event = Event { striker: 1, ..strike(0.0, 1, 1.0) };
    let error = render(&two_pads(), &[event], None, RATE, 1).unwrap_err();
    assert_eq!(error, Error::EventStriker { event: 0, pad: 1, striker: 1, striker_count: 1 });
}

#[test]
fn events_out_of_order_are_named() {
    let events = [strike(5.0, 0, 1.0), strike(4.5, 0, 1.0)];
    let error = render(&two_pads(), &events, None, RATE, 1).unwrap_err();
    assert_eq!(error, Error::EventOrder { event: 1, time_samples: 4.5, previous_samples: 5.0 });
    let without_time = [strike(f64::NAN, 0, 1.0)];
    assert!(matches!(render(&two_pads(), &without_time, None, RATE, 1), Err(Error::EventOrder { event: 0, .. })));
}

#[test]
fn a_direct_force_or_a_mono_signal_of_a_missing_pad_is_named() {
    let pads = two_pads();
    let missing = Error::NoSuchPad { pad: 2, pad_count: 2 };
    let direct = Some(Direct { pad: 2, force: &[1.0] });
    assert_eq!(render(&pads, &[], direct, RATE, 1), Err(missing.clone()));
    assert_eq!(render_mono(&pads, 0, &[], direct, RATE, 1), Err(missing.clone()));
    assert_eq!(render_mono(&pads, 2, &[], None, RATE, 1), Err(missing));
}

#[test]
fn uneven_gains_are_named_by_pad_bank_and_mode() {
    let mut pads = two_pads();
    pads[0].strikers[0].modes[3].gains.push(Gain { sine: 1.0, cosine: 0.0 });
    let error = render(&pads, &[strike(0.0, 0, 1.0)], None, RATE, 1).unwrap_err();
    assert!(matches!(error, Error::Bank { pad: 0, owner: BankOwner::Striker(0), gains } if gains.mode == 3));
    let message = error.to_string();
    assert!(message.starts_with("the striker 0 bank of pad 0: mode 3 has gains at 2 positions where 1"));
}
