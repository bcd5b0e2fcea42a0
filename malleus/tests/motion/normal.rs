//! Normal force from the motion: eq. 8 and 9 of the paper, lift-off, and grips that are refused.

use std::f64::consts::PI;

use malleus::motion::normal::{GRAVITY_M_PER_S2, Grip, GripError, NormalForce, NormalRange};
use malleus::motion::trials::{Shape, Trial};

use crate::{motion, parse};

const GRIP: Grip = Grip { mass_kg: 0.05, tilt_rad: 0.7, friction: 0.3 };

#[test]
fn back_and_forth_through_its_file_has_eq_8_and_9_at_its_ends() {
    let Grip { mass_kg, tilt_rad, friction } = GRIP;
    let mut worst = 0.0f64;
    for (length_m, period_s, start_s) in
        [(0.2, 1.0, 0.0), (0.05, 0.25, 1.7), (0.01, 0.1, 3.3), (0.3, 2.0, 100.0), (0.004, 0.05, 0.1)]
    {
        let shape = Shape::BackAndForth { length_m, period_s, strokes: 6 };
        let trial = Trial { shape, start_s, place_m: [0.1, -0.2] };
        let motion = parse(trial.draw().unwrap().csv("board", "ball").as_bytes()).unwrap();
        let force = NormalForce::new(&GRIP).unwrap();
        // L of the paper is the amplitude, half the stroke.
        let (angular, amplitude_m) = (2.0 * PI / period_s, 0.5 * length_m);
        let end = |sign: f64| {
            let push = angular * angular * mass_kg * amplitude_m * tilt_rad.tan();
            ((mass_kg * GRAVITY_M_PER_S2 + sign * push) / (1.0 - friction * tilt_rad.tan())).max(0.0)
        };
        for stroke in 0..=6 {
            let time_s = start_s + f64::from(stroke) * 0.5 * period_s;
            let state = motion.at(time_s.min(motion.end_s())).unwrap();
            let expected = end(if stroke % 2 == 0 { 1.0 } else { -1.0 });
            let found = force.at(&state);
            if expected == 0.0 {
                assert_eq!(found, 0.0);
            } else {
                worst = worst.max((found / expected - 1.0).abs());
            }
            let at_end = if stroke % 2 == 0 { 0.0 } else { length_m };
            assert!((state.position_m[0] - 0.1 - at_end).abs() < 1e-12);
        }
        let range = force.range(&motion, 0).unwrap();
        assert!((range.most_n / end(1.0) - 1.0).abs() < 1e-3);
        assert!((range.least_n - end(-1.0)).abs() < 1e-3 * end(1.0));
        assert_eq!(range, force.range_of_motion(&motion));
    }
    println!("eq. 8 and 9 at the ends of back-and-forth: within {:.4} %", 100.0 * worst);
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn tool_that_is_pulled_back_too_hard_is_lifted_off() {
    // At the far end the hand accelerates by -ω² L = -39.5 m/s².
    let trial = Trial {
        shape: Shape::BackAndForth { length_m: 0.08, period_s: 0.2, strokes: 2 },
        start_s: 0.0,
        place_m: [0.0; 2],
    };
    let motion = trial.draw().unwrap().motion().unwrap();
    let force = NormalForce::new(&GRIP).unwrap();
    assert_eq!(force.at(&motion.at(0.1).unwrap()), 0.0);
    assert!(force.at(&motion.at(0.0).unwrap()) > 2.0);
    assert_eq!(force.range(&motion, 0).unwrap().least_n, 0.0);
    assert_eq!(force.range(&motion, 1), None);
}

#[test]
fn constant_speed_is_pressed_by_the_weight_and_the_friction_alone() {
    let motion = motion("0,board,scrape,,0,0,\n1,board,scrape,,0.1,0.1,\n2,board,lift,,0.2,0.2,\n");
    let NormalRange { least_n, most_n } = NormalForce::new(&GRIP).unwrap().range_of_motion(&motion);
    let expected = 0.05 * GRAVITY_M_PER_S2 / (1.0 - 0.3 * 0.7f64.tan());
    assert!((least_n / expected - 1.0).abs() < 1e-9 && (most_n / expected - 1.0).abs() < 1e-9);
}

#[test]
fn rolling_ball_weighs_m_g_whatever_its_acceleration() {
    let shape = Shape::Roll { length_m: 0.5, speed_m_per_s: 0.3, incline_deg: 4.0 };
    let motion = Trial { shape, start_s: 0.0, place_m: [0.0; 2] }.draw().unwrap().motion().unwrap();
    let range = NormalForce::new(&GRIP).unwrap().range_of_motion(&motion);
    assert_eq!([range.least_n, range.most_n], [0.05 * GRAVITY_M_PER_S2; 2]);
}

#[test]
fn force_of_the_file_goes_before_that_of_the_motion() {
    let motion = motion("0,board,scrape,,0,0,7\n0.1,board,scrape,,0.1,0,9\n0.2,board,lift,,0.3,0,\n");
    let force = NormalForce::new(&GRIP).unwrap();
    assert_eq!(force.at(&motion.at(0.05).unwrap()), 8.0);
    let free = motion.at(0.15).unwrap();
    assert_eq!(force.at(&free), force.scraping_n(free.acceleration_m_per_s2[0]));
    assert_eq!(force.range(&motion, 0).unwrap().most_n, 9.0);
}

#[test]
fn grips_that_jam_or_are_no_grips_are_refused_by_name() {
    let refused = |grip: Grip| NormalForce::new(&grip).unwrap_err();
    let jam = refused(Grip { tilt_rad: 1.0, friction: 0.7, ..GRIP });
    assert!(matches!(jam, GripError::Jam { product, .. } if product > 1.0));
    assert!(jam.to_string().contains("must be below 1"), "{jam}");
    // tan(π/4) is one rounding below 1.
    assert!(matches!(refused(Grip { tilt_rad: PI / 4.0, friction: 1.000_001, ..GRIP }), GripError::Jam { .. }));
    for mass_kg in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(Grip { mass_kg, ..GRIP }), GripError::Mass(_)));
    }
    for tilt_rad in [-0.1, PI / 2.0, 3.0, f64::NAN] {
        assert!(matches!(refused(Grip { tilt_rad, ..GRIP }), GripError::Tilt(_)));
    }
    for friction in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(Grip { friction, ..GRIP }), GripError::Friction(_)));
    }
    assert!(NormalForce::new(&Grip { tilt_rad: 0.0, friction: 50.0, ..GRIP }).is_ok());
}
