//! Paths between the lines of a file, and what is read from them.

use dsp_core::SampleRate;
use malleus::motion::{Action, State};
use proptest::prelude::*;

use crate::motion;

/// Two contacts on the board with uneven steps, and one on the drum.
const LINES: &str = "
    0.1,board,scrape,,0,0,2
    0.2,board,scrape,,0.05,0.01,4
    0.25,board,scrape,,0.09,0.05,
    0.4,board,lift,,0.02,0.06,1
    0.5,board,roll,ball,0,,
    0.7,board,roll,,0.1,,
    0.8,board,lift,,,,
    1,drum,scrape,pen,-0.5,-0.5,3
    1.5,drum,lift,,-0.4,-0.5,5
";

/// Largest difference of two states in place (m) and in velocity (m/s).
fn difference(a: &State, b: &State) -> [f64; 2] {
    let most = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
    [most(a.position_m, b.position_m), most(a.velocity_m_per_s, b.velocity_m_per_s)]
}

#[test]
fn spaces_before_quotes_and_lines_of_spaces_change_no_motion() {
    let loose = LINES.replace("board", " \"board\" ").replace('\n', "\n  \t\n");
    assert_eq!(motion(&loose), motion(LINES));
}

#[test]
fn path_goes_through_its_lines_and_is_c1_at_each() {
    let motion = motion(LINES);
    for (time_s, place) in [(0.1, [0.0, 0.0]), (0.2, [0.05, 0.01]), (0.25, [0.09, 0.05]), (0.4, [0.02, 0.06])] {
        assert_eq!(motion.at(time_s).unwrap().position_m, place);
    }
    for time_s in [0.2, 0.25] {
        let [before, behind] = [-1e-9, 1e-9].map(|by| motion.at(time_s + by).unwrap());
        let [place, velocity] = difference(&before, &behind);
        assert!(place < 1e-8 && velocity < 1e-6, "{place} m, {velocity} m/s at {time_s} s");
    }
}

#[test]
fn velocity_and_acceleration_are_the_derivatives_of_the_place() {
    let motion = motion(LINES);
    for n in 0..300 {
        // Halfway through each millisecond, so that no line lies in between.
        let time_s = 0.1005 + f64::from(n) * 1e-3;
        let [before, here, behind] = [-1e-6, 0.0, 1e-6].map(|by| motion.at(time_s + by).unwrap());
        for axis in 0..2 {
            let slope = (behind.position_m[axis] - before.position_m[axis]) / 2e-6;
            assert!((slope - here.velocity_m_per_s[axis]).abs() < 1e-7, "{slope} at {time_s}");
        }
    }
    // A free fall has the same acceleration everywhere, to the ends, whatever the steps.
    let fall: String = [0.0, 0.01, 0.03, 0.04, 0.1]
        .map(|t: f64| format!("{t},board,scrape,,{},{},\n", 0.2 * t - 4.0 * t * t, 3.0 * t * t))
        .concat();
    let fall = crate::motion(&fall);
    for n in 0..=100 {
        let time_s = f64::from(n) * 1e-3;
        let state = fall.at(time_s).unwrap();
        assert!((state.velocity_m_per_s[0] - (0.2 - 8.0 * time_s)).abs() < 1e-9);
        assert!((state.acceleration_m_per_s2[0] + 8.0).abs() < 1e-9, "{state:?}");
        assert!((state.acceleration_m_per_s2[1] - 6.0).abs() < 1e-9, "{state:?}");
    }
}

#[test]
fn states_tell_contact_pad_striker_action_and_given_force() {
    let motion = motion(LINES);
    let told = |time_s: f64| motion.at(time_s).map(|s| (s.contact, s.pad, s.striker, s.action, s.normal_n));
    assert_eq!(motion.contacts().len(), 3);
    assert_eq!(told(0.05), None);
    assert_eq!(told(0.1), Some((0, 0, 0, Action::Scrape, Some(2.0))));
    assert_eq!(told(0.15), Some((0, 0, 0, Action::Scrape, Some(3.0))));
    // Lines 0.25 has no force: none between its neighbours either.
    assert_eq!(told(0.22), Some((0, 0, 0, Action::Scrape, None)));
    assert_eq!(told(0.4), Some((0, 0, 0, Action::Scrape, None)));
    assert_eq!(told(0.45), None);
    assert_eq!(told(0.6), Some((1, 0, 1, Action::Roll, None)));
    // A lift without a place ends the contact at the line before.
    assert_eq!(told(0.7).map(|told| told.0), Some(1));
    assert_eq!(told(0.75), None);
    assert_eq!(told(1.25), Some((2, 1, 0, Action::Scrape, Some(4.0))));
    assert_eq!(told(1.6), None);
    assert_eq!([told(f64::NAN), told(f64::INFINITY), told(-1.0)], [None; 3]);
    assert_eq!(motion.end_s(), 1.5);
    assert!(motion.remarks().is_empty());
}

#[test]
fn contact_without_a_lift_ends_at_the_last_line_with_a_remark() {
    let motion = motion("0,drum,roll,,0,,\n0.5,drum,roll,,0.1,,\n");
    assert_eq!(motion.end_s(), 0.5);
    assert_eq!(motion.remarks(), ["pad drum is not lifted; its contact ends at the last line, 0.5 s"]);
}

#[test]
fn samples_and_numbers_of_pads_read_as_seconds_and_names() {
    let by_sample = crate::parse(b"sample,pad,action,x_m\n4800,1,scrape,0\n9600,1,lift,0.01\n").unwrap();
    assert_eq!(by_sample, motion("0.1,drum,scrape,,0,,\n0.2,drum,lift,,0.01,,\n"));
}

#[test]
fn ticks_give_the_states_at_their_ends_until_the_last_lift() {
    let motion = motion(LINES);
    let rate = SampleRate::new(86_000_000, 1792).unwrap();
    let ticks: Vec<_> = motion.ticks(rate).collect();
    for (tick, state) in ticks.iter().enumerate() {
        let time_s = (32 * (tick + 1)) as f64 / rate.hz();
        assert_eq!(*state, motion.at(time_s));
    }
    assert_eq!(ticks.len(), (1.5 * rate.hz() / 32.0).ceil() as usize);
    assert_eq!(ticks.last(), Some(&None));
    assert!(ticks[ticks.len() - 2].is_some());
}

proptest! {
    #[test]
    fn reader_gives_the_states_of_a_search_at_times_in_any_order(
        times in prop::collection::vec(prop_oneof![-0.1..1.7f64, Just(0.1), Just(0.4), Just(0.7), Just(f64::NAN)], 1..60)
    ) {
        let motion = motion(LINES);
        let mut reader = motion.reader();
        for time_s in times {
            prop_assert_eq!(reader.at(time_s), motion.at(time_s));
        }
    }

    #[test]
    fn any_accepted_path_is_c1_and_at_most_10_metres_a_second(
        steps in prop::collection::vec((1e-4..0.1f64, -0.1..0.1f64, -0.1..0.1f64), 2..20)
    ) {
        let (mut text, mut at) = (String::from(crate::HEADER), (0.0, 0.0, 0.0));
        for (t, x, y) in steps {
            at = (at.0 + t, at.1 + x, at.2 + y);
            text += &format!("{},board,scrape,,{},{},\n", at.0, at.1, at.2);
        }
        match crate::parse(text.as_bytes()) {
            Ok(motion) => {
                let contact = &motion.contacts()[0];
                for n in 0..=2000 {
                    let time_s = contact.touch_s + f64::from(n) / 2000.0 * (contact.lift_s - contact.touch_s);
                    let state = motion.at(time_s.min(contact.lift_s)).unwrap();
                    let [x, y] = state.velocity_m_per_s;
                    prop_assert!(x.hypot(y) <= 10.0 + 1e-6);
                    if let Some(next) = motion.at(time_s + 1e-9) {
                        // No more than the acceleration of the sharpest turn makes of a nanosecond.
                        let [place, velocity] = difference(&state, &next);
                        prop_assert!(place < 1.1e-8 && velocity < 1e-2, "{place} {velocity}");
                    }
                }
            }
            Err(fault) => {
                let is_speed = matches!(fault, malleus::motion::MotionFault::TooFast { speed_m_per_s, .. } if speed_m_per_s > 10.0);
                prop_assert!(is_speed, "{}", fault);
            }
        }
    }
}
