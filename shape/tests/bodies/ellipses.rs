//! Circles, ellipses and their arcs in drawings, against closed forms and Ritz's method.

use std::f64::consts::TAU;

use shape::solve::Wanted;

use crate::truth::bessel;
use crate::truth::ellipse::{Skin, numbers};
use crate::{assert_within, plate, solve_text, thin_hz};

/// Thickness of the plates, metres, which are 2 m long.
const THIN: f64 = 0.0005;
/// Half axes of the ellipses.
const HALF_AXES: [f64; 2] = [1.0, 0.6];

/// Text of a membrane whose frequencies times 2π are its wave numbers.
fn membrane() -> String {
    "format = 1\nname = \"skin\"\nshape = { kind = \"membrane\", outline = \"x.svg\", unit_m = 1, tension_n_per_m = 1, \
     density_kg_per_m2 = 1 }\nmaterial = { loss_factor = 0 }\n"
        .to_owned()
}

/// Drawing of a shape; units are those of its user space.
fn drawing(shape: &str) -> String {
    format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="4">{shape}</svg>"#)
}

/// Frequency numbers of an ellipse, and what more polynomials change.
fn truth(skin: Skin, count: usize) -> Vec<f64> {
    let [less, more] = [18, 22].map(|degree| numbers(skin, HALF_AXES, degree, count));
    let change = less.iter().zip(&more).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
    assert!(change < 1e-7, "more polynomials change by {change:.1e}");
    more
}

#[test]
fn polynomials_within_a_circle_have_the_numbers_of_bessel_functions() {
    let disc = numbers(Skin::Membrane, [1.0; 2], 18, 4);
    let zeros = [2.404_825_557_7, 3.831_705_970_2, 3.831_705_970_2, 5.135_622_301_8];
    assert!(disc.iter().zip(zeros).all(|(found, zero)| (found / zero - 1.0).abs() < 1e-9), "{disc:?}");
    let disc = numbers(Skin::Plate, [1.0; 2], 18, 8);
    let squares = bessel::clamped_disc(8.0).into_iter().map(|number| number * number);
    assert!(disc.iter().zip(squares).all(|(found, square)| (found / square - 1.0).abs() < 1e-7), "{disc:?}");
}

/// Ellipses of half axes 1 and 0.6 as drawings have them.
fn ellipses() -> [(&'static str, String); 5] {
    let quarters =
        "M3,2 C3,2.331370850 2.552284750,2.6 2,2.6 S1,2.331370850 1,2 S1.447715250,1.4 2,1.4 S3,1.668629150 3,2 Z";
    [
        ("ellipse", r#"<ellipse cx="2" cy="2" rx="1" ry="0.6"/>"#.to_owned()),
        ("arcs", r#"<path d="M1,2 A1,0.6 0 0 0 3,2 A1,0.6 0 0 0 1,2 Z"/>"#.to_owned()),
        // From 10 to 130, 250 and 10 degrees: two cubics of 60 degrees each.
        ("thirds", thirds()),
        ("turned", r#"<g transform="rotate(33)"><ellipse cx="2" cy="2" rx="0.6" ry="1"/></g>"#.to_owned()),
        ("cubics", format!(r#"<path d="{quarters}"/>"#)),
    ]
}

/// Path of three arcs of an ellipse.
fn thirds() -> String {
    let at = |deg: f64| {
        let (sine, cosine) = deg.to_radians().sin_cos();
        format!("{:.9},{:.9}", 2.0 + cosine, 2.0 + 0.6 * sine)
    };
    let arc = |deg: f64| format!("A1,0.6 0 0 1 {} ", at(deg));
    format!(r#"<path d="M{} {}{}{}Z"/>"#, at(10.0), arc(130.0), arc(250.0), arc(10.0))
}

#[test]
fn drawn_ellipses_have_the_frequencies_of_ritz() {
    let (skin, thin) = (truth(Skin::Membrane, 8), truth(Skin::Plate, 8));
    let skin: Vec<f64> = skin.iter().map(|number| number / TAU).collect();
    let thin: Vec<f64> = thin.iter().map(|square| thin_hz(*square, 1.0, THIN)).collect();
    let clamped = plate("outline = \"x.svg\", unit_m = 1", THIN, "clamped");
    for (name, shape) in ellipses() {
        println!("{name}");
        let svg = drawing(&shape);
        let solved = solve_text(&membrane(), Some(&svg), Wanted::Lowest(8), 0.0003).unwrap();
        assert_within(&solved, &skin, 1e-5);
        let solved = solve_text(&clamped, Some(&svg), Wanted::Lowest(8), 0.001).unwrap();
        assert_within(&solved, &thin, 1e-4);
    }
}
