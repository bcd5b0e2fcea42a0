//! Presses of the button: each sounds the same time after the contact, whatever the core does.

use virtual_board::{Board, Press, Setup};

use crate::common;
use crate::hits::signal;

/// Time of the first press, in s from power-on.
const FIRST_S: f64 = 0.4;
/// Time from a press to the next one, in s.
const APART_S: f64 = 0.06;
/// Time for which the button is held, in s.
const HELD_S: f64 = 0.02;

/// Returns the frames from each press to its event, less those of the first press.
///
/// Four pads ring at the same time, so that the core renders for a good part of each half.
fn frames_after(board: Board, count: usize) -> Vec<f64> {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let half_s = 32.0 / 48_000.0;
    let at_s = |press: usize| FIRST_S + APART_S * press as f64 + half_s * (press as f64 * golden).fract();
    let presses = (0..count).map(|press| Press { at_s: at_s(press), for_s: HELD_S, bounce_s: 0.0 }).collect();
    let seconds = at_s(count);
    let ringing = (0..4).map(|piezo| {
        let strokes: Vec<(f64, f32)> =
            (0..).map(|n| (0.3 + 0.1 * f64::from(n), 0.9)).take_while(|(at_s, _)| *at_s < seconds - 0.05).collect();
        signal(piezo, seconds, &strokes)
    });
    let setup = Setup { presses, piezos: ringing.collect(), ..Setup::default() };
    let running = common::run(board, &setup, seconds);
    let rate_hz = running.streams()[0].rate.as_f64();
    // Without trigger settings the button strikes pad 0 with velocity 0.8, which no piezo does.
    let report = running.report().unwrap();
    let frame = |message: &str| {
        let mut fields = message.strip_prefix("event ")?.split(',');
        let frame: f64 = fields.next()?.parse().ok()?;
        (fields.nth(1)? == "0.8").then_some(frame)
    };
    let events: Vec<f64> = report.log.iter().filter_map(|line| frame(&line.message)).collect();
    assert_eq!(events.len(), count, "{events:?}");
    let offsets: Vec<f64> = events.iter().enumerate().map(|(press, event)| event - at_s(press) * rate_hz).collect();
    offsets.iter().map(|offset| offset - offsets[0]).collect()
}

#[test]
fn presses_sound_within_two_frames_of_each_other_at_any_place_in_a_half() {
    for board in Board::ALL {
        let after = frames_after(board, 40);
        let (least, most) = after.iter().fold((0.0f64, 0.0f64), |(least, most), &x| (least.min(x), most.max(x)));
        println!("{}: events of presses spread over {:.2} frames: {after:.1?}", board.name(), most - least);
        assert!(most - least < 2.0, "{}: {after:.2?}", board.name());
    }
}
