//! The engine with a room: its answer, its rest, block sizes, refusals.

use dsp_core::SampleRate;
use dsp_core::engine::{LoadError, Plan, Setup, TickReport};
use dsp_core::event::{Action, Event};
use dsp_core::fixed::ONE_Q27;
use dsp_core::room::RoomError;
use dsp_core::table::Kit as KitView;
use host_tests::lent;
use host_tests::room::{SMALL, Table, TableBand, answer_to_sides};
use host_tests::scene::{hand, load, mode, one_pad, strike};
use kit::{Kit, Loaded, RoomBand};

/// Setup with at most [`SMALL`] samples of delay.
fn setup() -> Setup {
    Setup { room_samples: SMALL, ..Setup::new(SampleRate::HZ_48000) }
}

fn dry() -> Kit {
    one_pad(vec![mode(440.0, 0.05, 500.0, 0.0), mode(2_510.0, 0.03, 500.0, 0.0)])
}

/// Kit with a room of 0.3 s below 1 kHz and 0.2 s above.
fn wet() -> Kit {
    Kit { room: vec![RoomBand::new(0.0, 0.3, -6.0), RoomBand::new(1_000.0, 0.2, -9.0)], ..dry() }
}

/// Sound and reports in blocks of `block` frames.
fn play(loaded: &Loaded, events: &[Event], frames: usize, block: usize) -> (Vec<[i32; 2]>, Vec<TickReport>) {
    let kit = KitView::parse(&loaded.binary).expect("a right kit");
    let mut engine = lent::engine_of::<i32>(&kit, setup()).expect("it can be played");
    let (mut out, mut reports, mut events) = (vec![[0; 2]; frames], Vec::new(), events);
    for chunk in out.chunks_mut(block) {
        let end = engine.now() + chunk.len() as u64;
        let due = events.iter().take_while(|event| event.time.first_frame() < end).count();
        engine.render_bus(&events[..due], None, chunk, |report| reports.push(*report)).expect("right events");
        events = &events[due..];
    }
    (out, reports)
}

#[test]
fn the_sound_is_the_dry_one_and_the_rooms_answer_to_it() {
    let (frames, events) = (19_200, [strike(7, 1.0), strike(4_000, 0.4)]);
    let (dry_sound, _) = play(&load(dry()), &events, frames, 128);
    let (sound, _) = play(&load(wet()), &events, frames, 128);
    let table = Table {
        bands: wet()
            .room
            .iter()
            .map(|band| TableBand { from_hz: band.from_hz.into(), t60_s: band.t60_s(), gain: band.gain.into() })
            .collect(),
    };
    let input = [0, 1]
        .map(|side| dry_sound.iter().map(|sides| f64::from(sides[side]) / f64::from(ONE_Q27)).collect::<Vec<f64>>());
    let sides = input.each_ref().map(Vec::as_slice);
    let [left, right] = answer_to_sides::<i32, SMALL>(&table, SampleRate::HZ_48000, sides).expect("a right table");
    let energy = |side: &[f64]| side.iter().map(|x| x * x).sum::<f64>();
    assert!(energy(&left) > 0.01 * energy(&input[0]));
    for (frame, (wet, dry)) in sound.iter().zip(&dry_sound).enumerate() {
        for (side, room) in [left[frame], right[frame]].into_iter().enumerate() {
            let expected = i64::from(dry[side]) + (room * f64::from(ONE_Q27)).round() as i64;
            assert!((i64::from(wet[side]) - expected).abs() <= 1, "frame {frame}");
        }
    }
}

#[test]
fn a_room_sleeps_before_the_first_strike_and_after_the_last_tail() {
    let (sound, reports) = play(&load(wet()), &[strike(4_800, 1.0)], 96_000, 128);
    assert!(reports[..150].iter().all(|report| report.room_frames == 0));
    assert!(sound[..4_800].iter().all(|frame| *frame == [0, 0]));
    assert!(reports[152..300].iter().all(|report| report.room_frames == 32));
    let end = 2_500;
    assert!(reports[end..].iter().all(|report| report.room_frames == 0), "it still sounds after 1.5 s");
    assert!(sound[end * 32..].iter().all(|frame| *frame == [0, 0]));
}

#[test]
fn the_block_size_cannot_change_a_bit_of_the_room() {
    let loaded = load(wet());
    // The last strike falls into the silence after the room's tail, between two ticks.
    let events = [
        strike(3, 1.0),
        strike(40, 0.3),
        hand(5_000, Action::Choke),
        hand(5_555, Action::Release),
        strike(5_600, 0.5),
        strike(88_011, 0.7),
    ];
    let (whole, _) = play(&loaded, &events, 96_000, 96_000);
    for block in [1, 7, 32, 100, 1_024] {
        assert!(play(&loaded, &events, 96_000, block).0 == whole, "blocks of {block}");
    }
    // The room then answers as it would have from the start on.
    let (alone, _) = play(&loaded, &[strike(88_011, 0.7)], 96_000, 100);
    let energy = |sound: &[[i32; 2]]| sound.iter().map(|frame| f64::from(frame[0]).powi(2)).sum::<f64>();
    let db = 10.0 * (energy(&whole[88_000..]) / energy(&alone[88_000..])).log10();
    assert!(db.abs() < 1.0, "{db:.2} dB");
}

#[test]
fn a_room_that_the_rate_or_the_memory_does_not_hold_is_refused_by_name() {
    let refusal = |kit: Kit, setup: Setup| {
        let loaded = load(kit);
        let view = KitView::parse(&loaded.binary).expect("a right kit");
        Plan::of::<i32>(&view, setup).expect_err("it cannot be")
    };
    let high = Kit { room: vec![RoomBand::new(0.0, 0.3, -6.0), RoomBand::new(23_900.0, 0.2, -9.0)], ..dry() };
    let error = refusal(high, setup());
    assert!(matches!(error, LoadError::Room(RoomError::EdgeAboveNyquist { band: 1, .. })), "{error}");
    assert!(
        error.to_string().starts_with("the room's band 1 begins at from_hz = 23900; it must begin below 23520.0"),
        "{error}"
    );
    let error = refusal(wet(), Setup { room_samples: 100, ..setup() });
    assert!(matches!(error, LoadError::Room(RoomError::TooFewSamples { capacity: 100, .. })), "{error}");
}
