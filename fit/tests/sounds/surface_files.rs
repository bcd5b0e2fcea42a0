//! Heights in other units than metres.

use std::f64::consts::TAU;

use fit::surface::{Heights, Note, Options, SurfaceError, fit};

/// A profile of waves of 0.3 and 0.05 mm, and 5 µm rms, times a factor.
fn wavy(factor: f64) -> Heights {
    let height = |n: usize| {
        let x = n as f64 * 1e-5;
        6e-6 * (TAU * x / 0.3e-3).sin() + 3e-6 * (TAU * x / 0.05e-3).sin() + 1e-7 * ((n * n) as f64).sin()
    };
    Heights { step_m: 1e-5, columns: 6_000, values: (0..6_000).map(|n| factor * height(n)).collect() }
}

#[test]
fn advice_on_the_unit_of_heights_is_not_followed_by_other_advice() {
    for (unit, given) in [(1e12, 1.0), (1e9, 1.0), (1e9, 1e-3), (1e6, 1.0), (1e3, 1.0), (1e-3, 1.0), (1e-6, 1e3)] {
        let tried = |height_scale| fit(wavy(unit), &Options { height_scale, ..Options::default() }, |_| {});
        let note = match tried(given) {
            Ok((.., notes)) => notes.into_iter().find(|note| matches!(note, Note::Scale { .. })),
            Err(SurfaceError::Unit { note }) => Some(note),
            Err(other) => panic!("{other}"),
        };
        let Some(Note::Scale { factor, .. }) = note else { panic!("heights of {unit}, given {given}: no advice") };
        assert!((factor * unit - 1.0).abs() < 1e-6, "heights of {unit}, given {given}: {factor} is advised");
        let (.., notes) = tried(factor).expect("its heights are in metres");
        assert!(!notes.iter().any(|note| matches!(note, Note::Scale { .. })), "{notes:?}");
    }
}

#[test]
fn height_scale_beyond_all_units_is_refused_by_name() {
    for height_scale in [0.0, -1.0, 1e-30, 1e300, f64::NAN] {
        let refused = fit(wavy(1.0), &Options { height_scale, ..Options::default() }, |_| {});
        assert!(matches!(refused, Err(SurfaceError::Range { option: "--height-scale", .. })), "{height_scale}");
    }
}
