//! Pads on a board's inputs: faults, second sensors, crosstalk, buttons, and inputs that no piezo
//! makes.

use dsp_core::SampleRate;
use dsp_core::event::Action;
use dsp_core::trigger::{Buttons, Detection, Fault, Mode, Report, Settings, Trigger, TriggerError};
use proptest::prelude::*;

const RATE: SampleRate = SampleRate::HZ_48000;

/// All reports but forces, in blocks of 48 frames.
fn reports<const CHANNELS: usize>(trigger: &mut Trigger<CHANNELS>, counts: &[[u16; CHANNELS]]) -> Vec<String> {
    let mut told = Vec::new();
    for block in counts.chunks(48) {
        trigger.process(block, |report| match report {
            Report::Strike(strike) => told.push(format!("strike {} {}", strike.pad, strike.striker)),
            Report::Fault { channel, fault, .. } => told.push(format!("channel {channel}: {fault:?}")),
            Report::Recovered { channel, .. } => told.push(format!("channel {channel} recovered")),
            Report::Force { .. } => {}
        });
    }
    told
}

/// Value in counts of a ring of 1 kHz that begins at frame `onset`.
fn ring(n: usize, onset: usize, height: f64) -> f64 {
    let t = (n as f64 - onset as f64) / 48_000.0;
    if t < 0.0 { 0.0 } else { height * (-t / 0.008).exp() * (std::f64::consts::TAU * 1000.0 * t).sin() }
}

fn count(x: f64) -> u16 {
    (2048.0 + x).round().clamp(0.0, 4095.0) as u16
}

#[test]
fn a_piezo_at_the_rail_is_named_strikes_at_most_once_and_is_heard_again_later() {
    for (rail, fault) in [(4095u16, Fault::StuckHigh), (0, Fault::StuckLow)] {
        let counts: Vec<[u16; 2]> = (0..480_000)
            .map(|n| {
                let stuck = (48_000..336_000).contains(&n);
                let strike = ring(n, 432_000, 400.0) + ring(n, 24_000, 400.0);
                [if stuck { rail } else { count(strike) }, count(ring(n, 200_000, 400.0))]
            })
            .collect();
        let pads = [Settings::of_unset_pad(0), Settings::of_unset_pad(1)];
        let mut trigger = Trigger::<2>::new(pads, RATE).expect("valid");
        let told = reports(&mut trigger, &counts[..336_000]);
        assert_eq!(trigger.fault(0), Some(fault));
        let on_pad_0 = told.iter().filter(|report| *report == "strike 0 0").count();
        // These are the strike before, and at most one by the step to the rail.
        assert!((1..=2).contains(&on_pad_0), "{told:?}");
        assert_eq!(told.iter().filter(|report| report.contains("Stuck")).count(), 1, "{told:?}");
        assert!(told.contains(&format!("channel 0: {fault:?}")), "{told:?}");
        // The other pad plays on.
        assert!(told.contains(&"strike 1 0".to_owned()), "{told:?}");
        let told = reports(&mut trigger, &counts[336_000..]);
        assert_eq!(told, ["channel 0 recovered", "strike 0 0"]);
        assert_eq!(trigger.fault(0), None);
    }
}

#[test]
fn a_piezo_that_is_at_the_rail_from_the_start_never_strikes() {
    let mut trigger = Trigger::<1>::new([Settings::of_unset_pad(0)], RATE).expect("valid");
    assert_eq!(reports(&mut trigger, &[[4095]; 96_000]), ["channel 0: StuckHigh"]);
}

#[test]
fn noise_that_grows_louder_than_the_threshold_is_learnt_and_not_played() {
    let mut state = 1u32;
    let mut noise = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 16) / 65_536.0 - 0.5
    };
    let counts: Vec<[u16; 1]> = (0..480_000)
        .map(|n| [count(noise() * if n < 96_000 { 2.0 } else { 80.0 } + ring(n, 432_000, 800.0))])
        .collect();
    let mut trigger = Trigger::<1>::new([Settings::of_unset_pad(0)], RATE).expect("valid");
    let grows = reports(&mut trigger, &counts[..144_000]);
    assert!(grows.len() <= 3, "{grows:?}");
    assert_eq!(reports(&mut trigger, &counts[144_000..]), ["strike 0 0"]);
}

#[test]
fn the_louder_of_two_sensors_plays_its_striker_and_the_other_is_silent() {
    let pad = Settings { rim_channel: Some(1), rim_striker: 2, ..Settings::of_unset_pad(0) };
    for (head, rim, late, expected) in [
        (800.0, 300.0, 20, "strike 0 0"),
        (300.0, 800.0, 20, "strike 0 2"),
        (800.0, 300.0, 0, "strike 0 0"),
        (300.0, 800.0, 45, "strike 0 2"),
    ] {
        let counts: Vec<[u16; 2]> =
            (0..24_000).map(|n| [count(ring(n, 12_000, head)), count(ring(n, 12_000 + late, rim))]).collect();
        let mut trigger = Trigger::<2>::new([pad], RATE).expect("valid");
        assert_eq!(reports(&mut trigger, &counts), [expected], "{head} {rim} {late}");
    }
    // The rim gets more weight: 12 dB.
    let pad = Settings { rim_db: 12.0, ..pad };
    let counts: Vec<[u16; 2]> =
        (0..24_000).map(|n| [count(ring(n, 12_000, 800.0)), count(ring(n, 12_000, 300.0))]).collect();
    let mut trigger = Trigger::<2>::new([pad], RATE).expect("valid");
    assert_eq!(reports(&mut trigger, &counts), ["strike 0 2"]);
}

#[test]
fn two_pads_struck_at_once_both_play_and_one_that_is_only_shaken_does_not() {
    let pads = [Settings::of_unset_pad(0), Settings::of_unset_pad(1), Settings::of_unset_pad(2)];
    let counts: Vec<[u16; 3]> = (0..24_000)
        .map(|n| {
            let (first, second) = (ring(n, 12_000, 1500.0), ring(n, 12_030, 700.0));
            [count(first), count(second), count(0.1 * (first + second))]
        })
        .collect();
    let mut trigger = Trigger::<3>::new(pads, RATE).expect("valid");
    assert_eq!(reports(&mut trigger, &counts), ["strike 0 0", "strike 1 0"]);
}

#[test]
fn a_pad_that_was_shaken_is_heard_when_it_is_struck_itself_3_ms_later() {
    let pads = [Settings::of_unset_pad(0), Settings::of_unset_pad(1)];
    let counts: Vec<[u16; 2]> = (0..24_000)
        .map(|n| {
            let (first, second) = (ring(n, 12_000, 1000.0), ring(n, 12_144, 900.0));
            [count(first + 0.1 * second), count(second + 0.1 * first)]
        })
        .collect();
    let mut trigger = Trigger::<2>::new(pads, RATE).expect("valid");
    assert_eq!(reports(&mut trigger, &counts), ["strike 0 0", "strike 1 0"]);
}

#[test]
fn pads_that_are_off_or_whose_channel_is_not_there_are_not_heard() {
    let off = Settings { mode: Mode::Off, channel: 0, ..Settings::of_unset_pad(0) };
    let far = Settings { channel: 7, ..Settings::of_unset_pad(1) };
    let near = Settings { channel: 0, ..Settings::of_unset_pad(2) };
    let trigger = Trigger::<2>::new([off, far, near], RATE).expect("valid");
    assert_eq!([0, 1, 2].map(|pad| trigger.hears(pad)), [false, false, true]);
}

#[test]
fn settings_that_cannot_be_are_refused_by_name() {
    let usual = Settings::of_unset_pad(0);
    let refusal = |pads: [Settings; 2]| Trigger::<4>::new(pads, RATE).expect_err("wrong").to_string();
    assert_eq!(refusal([usual, usual]), "pad 1: channel 0 is another sensor's already; give each its own");
    let slow = Settings { scan_time_s: 1.0, ..usual };
    assert_eq!(refusal([slow, Settings::of_unset_pad(1)]), "pad 0: scan_time_s = 1: must be from 0.001 to 0.01");
    let nan = Settings { threshold: f32::NAN, ..usual };
    assert!(refusal([nan, Settings::of_unset_pad(1)]).starts_with("pad 0: threshold = NaN"));
    let rate = SampleRate::new(96_000, 1).expect("a rate");
    assert!(matches!(Trigger::<1>::new([usual], rate), Err(TriggerError::Rate { .. })));
    let buttons = Buttons::<2>::new([usual, Settings { button: Some(0), ..Settings::of_unset_pad(1) }], RATE);
    assert!(matches!(buttons, Err(TriggerError::SharedButton { pad: 1, button: 0 })));
}

/// Detections of a button with the given edges (frame, down). It bounces for 5 ms after each.
fn press(pads: &[Settings], edges: &[(u64, bool)]) -> Vec<Detection> {
    let mut buttons = Buttons::<1>::new(pads.iter().copied(), RATE).expect("valid");
    let mut found = Vec::new();
    for frame in 0..48_000u64 {
        let Some(&(since, level)) = edges.iter().rev().find(|(edge, _)| *edge <= frame) else { continue };
        // Contact is made and lost every 0.3 ms or so.
        let bounces = frame - since < 240 && (frame - since) / 15 % 2 == 1;
        buttons.sample(0, frame, level != bounces, |detection| found.push(detection));
    }
    found
}

#[test]
fn a_button_that_bounces_for_5_ms_strikes_once_at_first_contact_with_its_velocity() {
    let pad = Settings { button_velocity: 0.6, ..Settings::of_unset_pad(0) };
    let found = press(&[pad], &[(1000, true), (9000, false), (20_000, true), (30_000, false)]);
    let strike = |frame| Detection { frame, pad: 0, striker: 0, velocity: 0.6, action: Action::Strike };
    assert_eq!(found, [strike(1000), strike(20_000)]);
}

#[test]
fn a_held_button_chokes_its_pads_until_it_is_let_go() {
    let choked = |pad| Settings { button: None, choke_button: Some(0), ..Settings::of_unset_pad(pad) };
    let pads = [choked(0), Settings { button: None, ..Settings::of_unset_pad(1) }, choked(2)];
    let found = press(&pads, &[(1000, true), (9000, false)]);
    let told: Vec<_> = found.iter().map(|found| (found.frame, found.pad, found.action)).collect();
    let expected = [(1000, Action::Choke), (9000, Action::Release)];
    let expected: Vec<_> =
        expected.iter().flat_map(|&(frame, action)| [0, 2].map(|pad| (frame, pad, action))).collect();
    assert_eq!(told, expected);
}

#[test]
fn a_press_shorter_than_the_bouncing_is_let_go_all_the_same() {
    let choked = Settings { button: None, choke_button: Some(0), ..Settings::of_unset_pad(0) };
    let found = press(&[choked], &[(1000, true), (1100, false)]);
    let told: Vec<_> = found.iter().map(|found| found.action).collect();
    assert_eq!(told, [Action::Choke, Action::Release]);
    assert!(found[1].frame <= 1000 + 480);
}

/// Settings within their ranges.
fn settings(pad: u8) -> impl Strategy<Value = Settings> {
    let modes = prop::sample::select(vec![Mode::Velocity, Mode::Direct, Mode::Off]);
    (modes, 0.001f32..0.5, 0.001f32..0.01, 0.001f32..0.5, 1.0f32..1000.0, 0.01f32..1.0, -60.0f32..0.0).prop_map(
        move |(mode, threshold, scan_time_s, mask_time_s, mask_decay_per_s, full_scale, crosstalk_db)| Settings {
            mode,
            threshold,
            scan_time_s,
            mask_time_s,
            mask_decay_per_s,
            full_scale,
            crosstalk_db,
            ..Settings::of_unset_pad(pad)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_input_breaks_the_arithmetic_or_gives_a_velocity_that_is_none(
        pads in (settings(0), settings(1)),
        // The input has pieces of constants, alternations and noise, over all of 16 bits.
        pieces in prop::collection::vec((1..400usize, any::<u16>(), any::<u16>(), 1..50usize), 1..60),
    ) {
        let mut counts = Vec::new();
        for (length, low, high, period) in pieces {
            counts.extend((0..length).map(|n| if n / period % 2 == 0 { [low, high] } else { [high, low] }));
        }
        let mut trigger = Trigger::<2>::new([pads.0, pads.1], RATE).expect("valid");
        for block in counts.chunks(37) {
            let mut good = true;
            trigger.process(block, |report| match report {
                Report::Strike(strike) => good &= strike.velocity > 0.0 && strike.velocity <= 1.0 && strike.pad < 2,
                Report::Force { samples, .. } => good &= samples.iter().all(|x| x.unsigned_abs() <= 1 << 29),
                Report::Fault { .. } | Report::Recovered { .. } => {}
            });
            prop_assert!(good);
        }
    }
}
