//! Files of heights as other programs write them, and heights in other units than metres.

use std::f64::consts::TAU;
use std::path::PathBuf;

use fit::surface::{Heights, Note, Options, SurfaceError, fit, read};
use tempfile::TempDir;

/// A CSV file of a text, and the folder that holds it.
fn csv(text: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("heights.csv");
    std::fs::write(&path, text).expect("the folder is writable");
    (folder, path)
}

/// Heights of a CSV file of a text, with the notes on it, or its refusal in words.
fn read_text(text: &str) -> Result<(Heights, Vec<Note>), String> {
    let (_folder, path) = csv(text);
    read(&path, Some(1e-6)).map_err(|error| error.to_string())
}

#[test]
fn numbers_separated_by_blanks_are_read_as_those_separated_by_commas() {
    let commas = read_text("x_m,height_m\n0,1e-6\n1e-6,nan\n2e-6,3e-6\n").expect("a profile");
    let blanks = read_text("# x_m, height_m\n 0.0e+00  1.0e-06\r\n1e-6\tnan\n2e-6 3e-6 \n").expect("a profile");
    let seen = |heights: &Heights| (heights.columns, format!("{:?}", heights.values));
    assert_eq!((seen(&commas.0), &commas.1), (seen(&blanks.0), &blanks.1));
    let refused = read_text("x_m;height_m\n0;1e-6\n1e-6;2e-6\n").expect_err("semicolons");
    assert!(refused.contains("line 2") && refused.contains("separated by commas or blanks"), "{refused}");
}

#[test]
fn head_of_other_names_is_noted_and_one_of_another_unit_or_order_refused() {
    let numbers = "0,1e-6\n1e-6,2e-6\n2e-6,3e-6\n";
    let with_head = |head: &str| read_text(&format!("{head}\n{numbers}"));
    assert_eq!(with_head("x_m,height_m").expect("a profile").1, []);
    let (heights, notes) = with_head("position,z").expect("a profile");
    assert_eq!(heights.values, [1e-6, 2e-6, 3e-6]);
    let [Note::Head { head, .. }] = &notes[..] else { panic!("{notes:?}") };
    assert_eq!(head, "position,z");
    assert!(notes[0].to_string().contains("positions and heights, in metres"), "{}", notes[0]);
    for (head, cause) in [
        ("x_mm,height_um", "\"x_mm\" is in mm"),
        ("X [m],Z [µm]", "\"Z [µm]\" is in µm"),
        ("height_m,x_m", "height stands before the position"),
        ("0,rough", "\"rough\" is no number"),
    ] {
        let refused = with_head(head).expect_err(head);
        assert!(refused.contains("line 1") && refused.contains(cause), "{head}: {refused}");
    }
}

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
