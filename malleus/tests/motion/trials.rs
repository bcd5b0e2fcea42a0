//! Motions of the paper's experiments.

use std::f64::consts::TAU;

use malleus::motion::normal::GRAVITY_M_PER_S2;
use malleus::motion::trials::{Shape, Trial, TrialError};
use malleus::motion::{Action, Motion};
use proptest::prelude::*;

use crate::parse;

fn trial(shape: Shape) -> Trial {
    Trial { shape, start_s: 0.25, place_m: [0.3, -0.1] }
}

/// All shapes with the parameters that `malleus motion` takes without options.
fn all() -> [Shape; 7] {
    [
        Shape::BackAndForth { length_m: 0.2, period_s: 1.0, strokes: 4 },
        Shape::FourStrokes { length_m: 0.2, period_s: 1.0, strokes: 4 },
        Shape::Circle { length_m: 0.6, speed_m_per_s: 0.4 },
        Shape::Line { length_m: 0.6, speed_m_per_s: 0.4 },
        Shape::Scribble { length_m: 0.8, speed_m_per_s: 0.4, seed: 1 },
        Shape::Roll { length_m: 0.5, speed_m_per_s: 0.1, incline_deg: -2.0 },
        Shape::Roll { length_m: 0.5, speed_m_per_s: 0.3, incline_deg: 2.0 },
    ]
}

/// Speed at a time in metres per second; 0 while nothing is touched.
fn speed(motion: &Motion, time_s: f64) -> f64 {
    motion.at(time_s).map_or(0.0, |state| state.velocity_m_per_s[0].hypot(state.velocity_m_per_s[1]))
}

#[test]
fn each_trial_reads_back_as_the_motion_that_was_drawn() {
    for shape in all() {
        let drawing = trial(shape).draw().unwrap();
        let read = parse(drawing.csv("board", "").as_bytes()).unwrap();
        assert_eq!(read, drawing.motion().unwrap(), "{shape:?}");
        assert_eq!(read.contacts().len(), drawing.contacts());
        assert!(read.remarks().is_empty());
        let contact = &read.contacts()[0];
        assert_eq!(contact.touch_s, 0.25);
        assert_eq!(read.at(0.25).unwrap().position_m, [0.3, -0.1]);
        let rolls = matches!(shape, Shape::Roll { .. });
        assert_eq!(contact.action, if rolls { Action::Roll } else { Action::Scrape });
        assert_eq!(drawing, trial(shape).draw().unwrap());
        let seconds = read.end_s() - 0.25;
        assert!(drawing.lines() as f64 >= seconds / 1.000_001e-3, "steps above 1 ms: {shape:?}");
        let other = parse(drawing.csv("drum", "pen").as_bytes()).unwrap();
        assert_eq!((other.contacts()[0].pad, other.contacts()[0].striker), (1, 0));
    }
}

#[test]
fn pairs_share_their_velocity_profiles() {
    let [back_and_forth, four_strokes, circle, line, ..] = all();
    for (name, one, other, is_alike) in [
        ("back-and-forth, four-strokes", back_and_forth, four_strokes, true),
        ("circle, line", circle, line, true),
        ("line, four-strokes", line, four_strokes, false),
    ] {
        let [one, other] = [one, other].map(|shape| trial(shape).draw().unwrap().motion().unwrap());
        let (mut most, mut fastest) = (0.0f64, 0.0f64);
        for n in 0..=(one.end_s() * 1e4) as u32 {
            let time_s = f64::from(n) * 1e-4;
            most = most.max((speed(&one, time_s) - speed(&other, time_s)).abs());
            fastest = fastest.max(speed(&one, time_s));
        }
        println!("{name}: speeds differ by at most {:.5} % of {fastest:.4} m/s", 100.0 * most / fastest);
        assert_eq!(most < 1e-3 * fastest, is_alike, "{name}: {most} of {fastest}");
    }
}

#[test]
fn pairs_of_one_seed_share_their_variations() {
    let [back_and_forth, four_strokes, circle, line, ..] = all();
    for seed in 0..20 {
        for pair in [[back_and_forth, four_strokes], [circle, line]] {
            let [one, other] = pair.map(|shape| trial(shape).varied(seed).draw().unwrap().motion().unwrap());
            assert_eq!(one.end_s(), other.end_s());
            let ((way, fastest), (other_way, other_fastest)) = (one.way(), other.way());
            assert!((way / other_way - 1.0).abs() < 1e-4 && (fastest / other_fastest - 1.0).abs() < 1e-3);
        }
    }
    let [one, same, other] = [1, 1, 2].map(|seed| trial(circle).varied(seed));
    assert!(one == same && one != other);
}

#[test]
fn strokes_end_where_the_paths_say_and_at_rest() {
    let motion =
        trial(Shape::FourStrokes { length_m: 0.2, period_s: 1.0, strokes: 4 }).draw().unwrap().motion().unwrap();
    assert_eq!(motion.contacts().len(), 4);
    for (index, contact) in motion.contacts().iter().enumerate() {
        let (touch, lift) = (motion.at(contact.touch_s).unwrap(), motion.at(contact.lift_s).unwrap());
        assert!((touch.position_m[0] - 0.3 - 0.2 * index as f64).abs() < 1e-9);
        assert!((lift.position_m[0] - touch.position_m[0] - 0.2).abs() < 1e-9);
        assert!(touch.velocity_m_per_s[0].abs() < 1e-5 && lift.velocity_m_per_s[0].abs() < 1e-5);
        // Always forward.
        assert!(motion.at(contact.touch_s + 0.25).unwrap().velocity_m_per_s[0] > 0.6);
    }
    let back = trial(all()[0]).draw().unwrap().motion().unwrap();
    assert!(back.at(0.25 + 0.75).unwrap().velocity_m_per_s[0] < -0.6);
}

#[test]
fn circle_closes_and_its_acceleration_is_that_of_its_speed() {
    let motion = trial(Shape::Circle { length_m: 0.6, speed_m_per_s: 0.4 }).draw().unwrap().motion().unwrap();
    let end = motion.at(motion.end_s()).unwrap();
    assert!((end.position_m[0] - 0.3).abs() < 1e-9 && (end.position_m[1] + 0.1).abs() < 1e-9);
    let expected = 0.4 * 0.4 / (0.6 / TAU);
    for n in 4..16 {
        let [x, y] = motion.at(0.25 + 0.1 * f64::from(n) - 0.05).unwrap().acceleration_m_per_s2;
        assert!((x.hypot(y) / expected - 1.0).abs() < 1e-3, "{} of {expected}", x.hypot(y));
    }
    assert!((motion.way().0 - 0.6).abs() < 1e-6);
}

#[test]
fn ball_rolls_by_five_sevenths_of_the_slope_and_back_if_it_stops() {
    for incline_deg in [-3.0, 2.0, 0.0f64] {
        let shape = Shape::Roll { length_m: 0.4, speed_m_per_s: 0.2, incline_deg };
        let motion = trial(shape).draw().unwrap().motion().unwrap();
        let expected = -5.0 / 7.0 * GRAVITY_M_PER_S2 * incline_deg.to_radians().sin();
        let end = motion.at(motion.end_s()).unwrap();
        for n in 0..=50 {
            let state = motion.at(0.25 + f64::from(n) / 50.0 * (motion.end_s() - 0.25)).unwrap();
            assert!((state.acceleration_m_per_s2[0] - expected).abs() < 1e-5, "{state:?}");
        }
        let start = motion.at(0.25).unwrap();
        assert!((start.velocity_m_per_s[0] - 0.2).abs() < 1e-9);
        // Uphill it stops after 0.082 m and comes back with its speed.
        let (way, speed) = if incline_deg > 0.0 { (0.0, -0.2) } else { (0.4, (0.04 + 0.8 * expected).sqrt()) };
        assert!((end.position_m[0] - 0.3 - way).abs() < 1e-8, "{end:?}");
        assert!((end.velocity_m_per_s[0] - speed).abs() < 1e-6, "{end:?}");
    }
}

#[test]
fn scribbles_have_their_length_and_differ_by_seed() {
    for seed in 0..10 {
        let shape = Shape::Scribble { length_m: 0.8, speed_m_per_s: 0.4, seed };
        let motion = trial(shape).draw().unwrap().motion().unwrap();
        let (way, fastest) = motion.way();
        assert!((way / 0.8 - 1.0).abs() < 1e-4 && (0.5..1.6).contains(&fastest), "{way} m, {fastest} m/s");
        assert!(speed(&motion, 0.25) < 1e-4 && speed(&motion, motion.end_s()) < 1e-4);
        let other = Shape::Scribble { length_m: 0.8, speed_m_per_s: 0.4, seed: seed + 1 };
        assert_ne!(motion, trial(other).draw().unwrap().motion().unwrap());
    }
}

#[test]
fn trials_that_cannot_be_are_refused_by_name() {
    let refused = |shape: Shape| trial(shape).draw().unwrap_err();
    let line = |length_m: f64, speed_m_per_s: f64| refused(Shape::Line { length_m, speed_m_per_s });
    assert!(matches!(line(f64::NAN, 0.4), TrialError::Parameter { name: "length", .. }));
    assert!(matches!(line(0.1, 11.0), TrialError::Parameter { name: "speed", .. }));
    assert!(matches!(line(100.0, 0.01), TrialError::TooLong { .. }));
    let strokes = |period_s: f64, strokes: u32| refused(Shape::BackAndForth { length_m: 0.2, period_s, strokes });
    assert!(matches!(strokes(0.0, 4), TrialError::Parameter { name: "period", .. }));
    assert!(matches!(strokes(1.0, 0), TrialError::Parameter { name: "strokes", .. }));
    // π 0.2 m / 0.05 s is 12.6 m/s.
    assert!(matches!(strokes(0.05, 4), TrialError::TooFast { .. }));
    let roll = |speed_m_per_s, incline_deg| refused(Shape::Roll { length_m: 0.5, speed_m_per_s, incline_deg });
    assert!(matches!(roll(0.0, 1.0), TrialError::AtRest));
    assert!(matches!(roll(0.1, 85.0), TrialError::Parameter { name: "incline", .. }));
    let late = Trial { start_s: -1.0, ..trial(all()[2]) }.draw().unwrap_err();
    assert_eq!(late.to_string(), "--start -1: must be from 0 to 3600 seconds");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn any_parameters_give_a_motion_or_a_named_error(
        length_m in prop_oneof![0.001..0.5f64, 0.001..100.0f64],
        speed_m_per_s in prop_oneof![0.05..2.0f64, 0.0..12.0f64],
        strokes in 1..6u32,
        incline_deg in -81.0..81.0f64,
        seed in any::<u32>(),
        start_s in 0.0..3600.0f64,
        place in -100.0..100.0f64,
    ) {
        let period_s = 2.0 * length_m / speed_m_per_s.max(1e-3);
        for shape in [
            Shape::BackAndForth { length_m, period_s, strokes },
            Shape::FourStrokes { length_m, period_s, strokes },
            Shape::Circle { length_m, speed_m_per_s },
            Shape::Line { length_m, speed_m_per_s },
            Shape::Scribble { length_m, speed_m_per_s, seed },
            Shape::Roll { length_m, speed_m_per_s, incline_deg },
        ] {
            // Long ones are like short ones, and take a second each here.
            if length_m / speed_m_per_s.max(1e-3) > 5.0 {
                continue;
            }
            match (Trial { shape, start_s, place_m: [place, -place] }).varied(seed).draw() {
                Ok(drawing) => prop_assert_eq!(parse(drawing.csv("board", "").as_bytes()).unwrap(), drawing.motion().unwrap()),
                Err(TrialError::Path(fault)) => prop_assert!(false, "{}", fault),
                Err(_) => {}
            }
        }
    }
}

#[test]
fn highest_speed_is_drawn_and_read_back_and_above_it_nothing_is() {
    for length_m in [0.05, 0.6, 5.0, 100.0] {
        for shape in [
            Shape::Circle { length_m, speed_m_per_s: 10.0 },
            Shape::Line { length_m, speed_m_per_s: 10.0 },
            Shape::Roll { length_m, speed_m_per_s: 10.0, incline_deg: 0.0 },
            Shape::Roll { length_m, speed_m_per_s: 10.0, incline_deg: 2.0 },
        ] {
            let drawing = trial(shape).draw().unwrap();
            let read = parse(drawing.csv("board", "").as_bytes());
            assert!(read.is_ok(), "{shape:?}: {read:?}");
        }
    }
    let scribble = trial(Shape::Scribble { length_m: 0.8, speed_m_per_s: 10.0, seed: 1 });
    let refused = scribble
        .draw()
        .map_err(|error| error.to_string())
        .and_then(|drawing| drawing.motion().map(drop).map_err(|fault| TrialError::from(fault).to_string()));
    assert!(refused.is_err_and(|message| message.contains("no motion is faster than 10 m/s")));
}
