//! Pads of many modes, which the engine plays in frames.

use dsp_core::SampleRate;
use dsp_core::engine::{Setup, Skipping};
use dsp_core::event::{Action, Event, Time};
use dsp_core::table::Kit as KitView;
use dsp_core::voice::Form;
use host_tests::lent;
use host_tests::performance::{instrument, reference, snr_db};
use host_tests::scene::{load, one_pad, play, strike};
use kit::{Gain, Kit, Loaded, Mode};
use malleus::render::instrument::{Output, Settings};
use malleus::render::{Performance, instrument as player};

const RATE: SampleRate = SampleRate::HZ_44100;

/// Kit of one pad with modes at even distances up to 20 kHz, T60 from 0.01 s to 2 s, and gains at
/// some positions.
pub(crate) fn thing(modes: usize, positions: usize) -> Kit {
    let mode = |index: usize| {
        let gain = |place: usize| {
            let phase = (index * 7 + place * index) as f32;
            Gain { sine: 900.0 * phase.sin(), cosine: if index.is_multiple_of(3) { 0.0 } else { 300.0 * phase.cos() } }
        };
        Mode {
            frequency_hz: 40.0 + 20_000.0 * index as f32 / modes as f32,
            decay_per_s: 3.45 * 200f32.powf((index * 37 % 101) as f32 / 101.0),
            gains: (0..positions).map(gain).collect(),
        }
    };
    let mut kit = one_pad((0..modes).map(mode).collect());
    kit.pads[0].level_db = -12.0;
    kit.pads[0].pan = 0.2;
    kit
}

pub(crate) fn strike_at(frame: u64, position: f32, velocity: f32) -> Event {
    Event { time: Time { frame, fraction: 1 << 30 }, position, velocity, ..Event::default() }
}

/// Strikes in two blocks and across an edge, two of them 1.2 ms apart.
fn strikes() -> Vec<Event> {
    let strikes = [(100, 0.0, 0.9), (500, 0.6, 0.5), (553, 0.6, 0.7), (3000, 1.0, 1.0), (9001, 0.3, 0.4)];
    strikes.map(|(frame, position, velocity)| strike_at(frame, position, velocity)).to_vec()
}

pub(crate) fn is_in_frames(loaded: &Loaded) -> bool {
    let kit = KitView::parse(&loaded.binary).expect("the kit is valid");
    lent::engine(&kit, RATE, Skipping::On).expect("the kit can be played").form(0) == Some(Form::Frames)
}

#[test]
fn a_pad_is_in_frames_if_a_direct_force_costs_less_there_and_its_choke_is_slow() {
    assert!(!is_in_frames(&load(thing(183, 1))) && is_in_frames(&load(thing(184, 1))));
    for (choke_t60_s, in_frames) in [(0.1, true), (0.0146, true), (0.0144, false)] {
        let mut kit = thing(300, 1);
        kit.pads[0].choke_t60_s = choke_t60_s;
        assert_eq!(is_in_frames(&load(kit)), in_frames, "{choke_t60_s} s");
    }
}

#[test]
fn strikes_and_a_direct_force_on_a_thousand_modes_agree_with_the_reference() {
    for (modes, positions) in [(1025, 1), (300, 3)] {
        let loaded = load(thing(modes, positions));
        assert!(is_in_frames(&loaded));
        let performance = Performance::new(strikes(), None, &loaded.kit, RATE, Some(0.6));
        let (bus, reports) = instrument(&loaded, &performance, RATE, Skipping::Off);
        let merged: u32 = reports.iter().map(|report| report.merged_positions).sum();
        let snr = snr_db(&reference(&loaded, &performance, RATE), &bus);
        println!("{modes} modes, {positions} positions: {snr:.1} dB");
        assert!(snr >= 105.0 && merged == 0, "{modes} modes: {snr:.1} dB, {merged} merged");
    }
}

#[test]
fn the_callers_blocks_change_no_bit_of_a_pad_in_frames() {
    let mut kit = thing(230, 2);
    // A pad in the bank beside it.
    kit.objects.push(kit::Object {
        name: "small".into(),
        modes: thing(12, 1).objects.remove(0).modes,
        ..kit.objects[0].clone()
    });
    kit.pads.push(kit::Pad { name: "small".into(), object: "small".into(), choke_t60_s: 0.1, ..kit.pads[0].clone() });
    let loaded = load(kit);
    let mut events = strikes();
    events.push(Event { pad: 1, ..strike(9500, 0.8) });
    // The second force begins in silence, long after the strikes' sound.
    let force: Vec<i32> = (0..150_000i32)
        .map(|n| if (4000..4700).contains(&n) || n > 140_003 { n.wrapping_mul(2_654_435) >> 6 } else { 0 })
        .collect();
    let of_blocks = |blocks: &[usize]| play(&loaded, RATE, Skipping::On, &events, Some(&force), (150_000, blocks)).0;
    let whole = of_blocks(&[32]);
    assert!(whole[145_000..].iter().any(|frame| frame[0] != 0) && whole[..100] == [[0; 2]; 100]);
    for blocks in [&[1][..], &[8], &[33], &[128], &[1000], &[7, 256, 1, 90]] {
        assert!(of_blocks(blocks) == whole, "blocks of {blocks:?} change the bits");
    }
}

#[test]
fn a_struck_pad_in_frames_ends_in_silence_and_the_report_says_what_ran() {
    let loaded = load(thing(250, 1));
    let (bus, reports) = play(&loaded, RATE, Skipping::On, &[strike(300, 1.0)], None, (300_000, &[64]));
    let full = play(&loaded, RATE, Skipping::Off, &[strike(300, 1.0)], None, (300_000, &[64])).0;
    let missing = bus.iter().zip(&full).map(|(a, b)| (a[1] - b[1]).abs()).max().unwrap_or(0);
    let missing_db = 20.0 * (f64::from(missing) / f64::from(1 << 27)).log10();
    println!("skipping leaves out {missing_db:.1} dBFS at most");
    assert!(missing_db < -100.0);
    let last = reports.last().expect("a report");
    assert_eq!((last.ringing_pads, last.retired_amplitude), (0, 0.0), "{last:?}");
    assert!(bus.iter().rev().take(1000).all(|frame| *frame == [0; 2]));
    let frames: u32 = reports.iter().map(|report| report.run_mode_frames()).sum();
    let skipped: u32 = reports.iter().map(|report| report.decayed_mode_frames + report.unstruck_mode_frames).sum();
    assert_eq!(u64::from(frames) + u64::from(skipped), 250 * 300_000);
    assert!(reports.iter().map(|report| report.retired_modes).sum::<u32>() == 250);
}

/// Kit of pads with 64 modes each.
fn several(pads: usize) -> Kit {
    let mut kit = thing(64, 1);
    for number in 1..pads {
        let name = format!("pad {number}");
        let mut object = kit.objects[0].clone();
        object.name = name.clone();
        object.modes.iter_mut().for_each(|mode| mode.frequency_hz *= 1.0 + 0.01 * number as f32);
        kit.objects.push(object);
        kit.pads.push(kit::Pad { name: name.clone(), object: name, ..kit.pads[0].clone() });
    }
    kit
}

#[test]
fn three_pads_of_64_modes_share_frames_unless_a_limit_is_set() {
    for (pads, without_limit) in [(2, Form::FewModes), (3, Form::Frames)] {
        let loaded = load(several(pads));
        let kit = KitView::parse(&loaded.binary).expect("the kit is valid");
        let engine = lent::engine_of::<i16>(&kit, Setup::new(RATE)).expect("the kit can be played");
        assert_eq!(engine.form(0), Some(without_limit), "{pads} pads");
        assert_eq!(lent::engine(&kit, RATE, Skipping::On).expect("as above").form(0), Some(Form::FewModes));
    }
    let loaded = load(several(3));
    let events = (0..9).map(|n| Event { pad: n % 3, ..strike_at(100 + 397 * u64::from(n), 0.0, 0.7) }).collect();
    let performance = Performance::new(events, None, &loaded.kit, RATE, Some(0.6));
    let (bus, _) = instrument(&loaded, &performance, RATE, Skipping::Off);
    let snr = snr_db(&reference(&loaded, &performance, RATE), &bus);
    println!("three pads of 64 modes: {snr:.1} dB");
    assert!(snr >= 105.0, "{snr:.1} dB");
}

#[test]
fn modes_that_are_shed_beside_frames_replay_to_the_same_bits_in_any_block() {
    // The second pad is in the bank, and a budget leaves modes of it out.
    let mut kit = several(2);
    kit.objects[0].modes = thing(230, 1).objects.remove(0).modes;
    kit.pads.iter_mut().for_each(|pad| pad.choke_t60_s = 0.1);
    let loaded = load(kit);
    let view = KitView::parse(&loaded.binary).expect("the kit is valid");
    let hand = |frame, action| Event { time: Time::at_frame(frame), action, ..Event::default() };
    let mut events: Vec<Event> =
        (0..40).map(|n| Event { pad: n % 2, ..strike_at(77 + 531 * u64::from(n), 0.0, 0.8) }).collect();
    events.extend([hand(4_000, Action::Choke), hand(9_003, Action::Release)]);
    events.sort_by_key(|event| event.time);
    let performance = Performance::new(events, None, &loaded.kit, RATE, Some(0.3));
    let setup = Setup { frame_cycles: Some(lent::FRAME_CYCLES), ..Setup::new(RATE) };
    let play = |events: Vec<Event>, block, budget_cycles| {
        let mut log = Vec::new();
        let performance = Performance { events, ..performance.clone() };
        let settings = Settings { setup, block, budget_cycles };
        let log_event = |event: &Event| log.push(*event);
        let sound = player::render_logged(&view, &performance, settings, Output::Bus, |_| {}, log_event);
        (sound.expect("right events"), log)
    };
    let (whole, log) = play(performance.events.clone(), 32, Some(36_000));
    let sheds = log.iter().filter(|event| matches!(event.action, Action::Shed(_))).count();
    println!("{sheds} decisions to leave modes out");
    assert!(sheds > 10, "{sheds}");
    for block in [1, 8, 33, 128, 1000] {
        assert!(play(log.clone(), block, None).0 == whole, "blocks of {block} change the bits");
    }
}
