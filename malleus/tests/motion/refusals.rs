//! Files that are no motion: each is refused by name.

use malleus::motion::MotionFault;
use proptest::prelude::*;

use crate::{HEADER, parse};

/// Fault of lines behind the header, with its message.
fn refused(lines: &str) -> (MotionFault, String) {
    let fault = parse(format!("{HEADER}{lines}").as_bytes()).unwrap_err();
    let message = fault.to_string();
    (fault, message)
}

/// Asserts that lines are refused by the fault of a pattern, with a message that has all parts.
macro_rules! refuses {
    ($lines:expr, $pattern:pat, $($part:expr),+) => {{
        let (fault, message) = refused($lines);
        assert!(matches!(fault, $pattern), "{:?}: {fault:?}", $lines);
        $(assert!(message.contains($part), "{:?}: no {:?} in: {message}", $lines, $part);)+
    }};
}

const TOUCH: &str = "0,board,scrape,,0,,\n";

#[test]
fn times_that_are_equal_or_go_back_are_refused() {
    for time in ["0", "0.0000000001"] {
        refuses!(
            &format!("{TOUCH}{time},board,scrape,,0,,\n"),
            MotionFault::OutOfOrder { line: 3, .. },
            "line 3",
            "not later"
        );
    }
    refuses!("1,board,scrape,,0,,\n0.5,drum,lift,,,,\n", MotionFault::OutOfOrder { .. }, "0.5 s", "1 s");
}

#[test]
fn lifts_without_a_touch_are_refused() {
    refuses!("0,board,lift,,,,\n", MotionFault::LiftBeforeTouch { line: 2, .. }, "line 2", "board", "before");
    refuses!(&format!("{TOUCH}1,drum,lift,,,,\n"), MotionFault::LiftBeforeTouch { .. }, "line 3", "drum");
    let lifted = format!("{TOUCH}1,board,lift,,0.1,,\n");
    refuses!(&format!("{lifted}2,board,lift,,,,\n"), MotionFault::LiftAfterLift { line: 4, .. }, "line 4", "already");
}

#[test]
fn contacts_of_one_line_and_motions_of_no_contact_are_refused() {
    for end in ["", "1,board,lift,,,,\n"] {
        refuses!(&format!("{TOUCH}{end}"), MotionFault::SingleLine { line: 2, .. }, "line 2", "board", "two lines");
    }
    refuses!("", MotionFault::NoContact, "touches no pad");
    refuses!("# nothing\n", MotionFault::NoContact, "scrape or roll");
}

#[test]
fn changes_of_action_striker_or_pad_without_a_lift_are_refused() {
    let to = |line: &str| format!("{TOUCH}1,{line}\n");
    refuses!(&to("board,roll,,0,,"), MotionFault::ActionChanged { .. }, "line 3", "roll", "scrape", "lift first");
    refuses!(&to("board,scrape,ball,0,,"), MotionFault::StrikerChanged { .. }, "line 3", "striker", "lift first");
    refuses!(&to("board,lift,ball,0,,"), MotionFault::StrikerChanged { .. }, "line 3");
    refuses!(&to("drum,scrape,,0,,"), MotionFault::TwoPads { .. }, "line 3", "drum", "board", "one pad at a time");
}

#[test]
fn speed_above_10_metres_a_second_is_refused_with_its_time() {
    refuses!(
        &format!("{TOUCH}0.1,board,lift,,1.01,,\n"),
        MotionFault::TooFast { line: 3, .. },
        "10.1000 m/s",
        "line 3"
    );
    assert!(parse(format!("{HEADER}{TOUCH}0.1,board,lift,,1,,\n").as_bytes()).is_ok());
    // Both steps are slower than 10 m/s, but the smooth path between them is not.
    let (fault, message) = refused("0,board,scrape,,0,,\n0.1,board,scrape,,0.2,,\n0.2,board,lift,,1.15,,\n");
    let MotionFault::TooFast { time_s, speed_m_per_s, .. } = fault else { panic!("{message}") };
    assert!(speed_m_per_s > 10.0 && (0.1..=0.2).contains(&time_s), "{message}");
    refuses!(&format!("{TOUCH}0.000001,board,lift,,1e6,,\n"), MotionFault::TooFast { .. }, "m/s");
}

#[test]
fn fields_with_wrong_values_are_refused_with_what_is_allowed() {
    for (line, parts) in [
        ("nan,board,scrape,,0,,", ["time_s = \"nan\"", "at least 0"]),
        ("-1,board,scrape,,0,,", ["time_s = \"-1\"", "at least 0"]),
        (",board,scrape,,0,,", ["time_s = \"\"", "seconds"]),
        ("2e6,board,scrape,,0,,", ["time_s = \"2e6\"", "1e6"]),
        ("0,bell,scrape,,0,,", ["pad = \"bell\"", "board, drum"]),
        ("0,2,scrape,,0,,", ["pad = \"2\"", "board, drum"]),
        ("0,board,strike,,0,,", ["action = \"strike\"", "scrape, roll or lift"]),
        ("0,board,,,0,,", ["action = \"\"", "scrape, roll or lift"]),
        ("0,board,scrape,axe,0,,", ["striker = \"axe\"", "pen, ball"]),
        ("0,drum,scrape,ball,0,,", ["striker = \"ball\"", "drum has pen"]),
        ("0,board,scrape,,,,", ["x_m = \"\"", "metres"]),
        ("0,board,scrape,,inf,,", ["x_m = \"inf\"", "metres"]),
        ("0,board,scrape,,0,NaN,", ["y_m = \"NaN\"", "metres"]),
        ("0,board,lift,,,0,", ["x_m = \"\"", "metres"]),
        ("0,board,scrape,,0,,-0.1", ["normal_n = \"-0.1\"", "from 0"]),
        ("0,board,scrape,,0,,inf", ["normal_n = \"inf\"", "newtons"]),
    ] {
        refuses!(line, MotionFault::Field { line: 2, .. }, "line 2", parts[0], parts[1]);
    }
    let by_sample = parse(b"sample,pad,action,x_m\n1.5,board,scrape,0\n").unwrap_err().to_string();
    assert!(by_sample.contains("sample = \"1.5\"") && by_sample.contains("whole number"), "{by_sample}");
}

#[test]
fn files_that_are_no_csv_of_a_motion_are_refused() {
    for (bytes, part) in [
        (&b"time_s,pad,action\n"[..], "`x_m` is missing"),
        (b"pad,action,x_m\n", "`time_s`"),
        (b"time_s,sample,pad,action,x_m\n", "exactly one"),
        (b"time_s,pad,action,x_m,speed\n", "`speed` is unknown"),
        (b"time_s,pad,action,x_m,x_m\n", "twice"),
        (b"", "`time_s`"),
        (b"time_s,pad,action,x_m\n0,board,scrape\n", "fields is 3; the header has 4"),
        (b"RIFF\x24\xF0\0\0WAVE", "not text in UTF-8 (byte 5"),
        (b"time_s,pad,action,x_m\n\0", "not text"),
    ] {
        let message = parse(bytes).unwrap_err().to_string();
        assert!(message.contains(part), "{:?}: {message}", String::from_utf8_lossy(bytes));
    }
}

/// A whole file with all that a file may have.
const WHOLE: &str = "time_s,pad,action,striker,x_m,y_m,normal_n\n# a remark\n0,board,scrape,pen,0,0,1\n0.01,board,scrape,,0.001,0.002,2\n0.02,\"board\",lift,,0.002,0.002,\n0.03,1,roll,,-0.5,,\n0.04,drum,roll,,-0.499,,\n0.05,drum,lift,,,,\n";

proptest! {
    #[test]
    fn cut_or_damaged_files_are_read_or_refused_but_never_panic(
        cut in 0..WHOLE.len(),
        damage in prop::collection::vec((0..WHOLE.len(), prop_oneof![any::<u8>(), prop::sample::select(b"0123456789.,-einf\n\"".to_vec())]), 0..4)
    ) {
        let mut bytes = WHOLE.as_bytes().to_vec();
        for (place, byte) in damage {
            bytes[place] = byte;
        }
        for file in [&bytes[..cut], &bytes[..], &bytes[cut..]] {
            if let Ok(motion) = parse(file) {
                let ticks = (motion.end_s() < 10.0).then(|| motion.ticks(dsp_core::SampleRate::HZ_48000).count());
                prop_assert!(ticks.is_none_or(|ticks| ticks > 0));
                for n in 0..100 {
                    let Some(state) = motion.at(f64::from(n) * 6e-4) else { continue };
                    prop_assert!(state.position_m.iter().chain(&state.acceleration_m_per_s2).all(|x| x.is_finite()));
                }
            }
        }
    }

    #[test]
    fn random_lines_are_read_or_refused_but_never_panic(
        lines in prop::collection::vec(
            (-0.1..3.0f64, "(board|drum|0|7|)", "(scrape|roll|lift|)", "(pen|ball|)", "(-?[0-9]{1,3}(\\.[0-9]{1,3})?|)", "(0\\.[0-9]|)"), 0..12)
    ) {
        let lines = lines.iter().map(|(t, pad, action, striker, x, y)| format!("{t},{pad},{action},{striker},{x},{y},\n"));
        let _ = parse(format!("{HEADER}{}", lines.collect::<String>()).as_bytes());
    }
}
