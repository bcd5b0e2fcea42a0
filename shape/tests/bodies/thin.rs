//! Thin plates and membranes against closed forms, Ritz's method and Bessel functions.

use std::f64::consts::{PI, TAU};

use shape::solve::Wanted;

use crate::truth::bessel;
use crate::truth::kirchhoff::{Edges, ThinPlate};
use crate::truth::ritz::sorted;
use crate::{DISC, assert_within, assert_within_of, plate, solve_text, thin_hz};

/// Drawing of a ring of radii 1 and 0.4.
const RING: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="4"><circle cx="2" cy="2" r="1"/><circle cx="2" cy="2" r="0.4"/></svg>"#;

/// Thickness of the plates, metres, which are 1 m wide.
const THIN: f64 = 0.0005;

#[test]
fn thin_hinged_rectangles_have_the_frequencies_of_the_closed_form() {
    for aspect in [1.0, 1.37, 3.1] {
        let polygon = format!("polygon_m = [[0, 0], [{aspect}, 0], [{aspect}, 1], [0, 1]]");
        let solved = solve_text(&plate(&polygon, THIN, "hinged"), None, Wanted::Lowest(32), 0.001).unwrap();
        let waves = (1..40).flat_map(|m| (1..40).map(move |n| [f64::from(m), f64::from(n)]));
        let parameter = |[m, n]: [f64; 2]| PI * PI * ((m / aspect).powi(2) + n * n);
        let expected = sorted(waves.map(|waves| thin_hz(parameter(waves), 1.0, THIN)).collect(), 32);
        assert_within(&solved, &expected, 0.0005);
    }
}

#[test]
fn thin_clamped_rectangles_have_the_frequencies_of_ritz() {
    let shear = 200e9 / 2.6;
    for aspect in [1.0, 1.37, 3.1] {
        let truth = ThinPlate::orthotropic([aspect, 1.0], THIN, [200e9; 2], 0.3, shear);
        let [less, expected] =
            [20, 24].map(|degrees| truth.ritz(Edges::Clamped, [degrees + (8.0 * aspect) as usize, degrees], 32));
        let change = less.iter().zip(&expected).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        assert!(change < 1e-5, "{change}");
        let polygon = format!("polygon_m = [[0, 0], [{aspect}, 0], [{aspect}, 1], [0, 1]]");
        let solved = solve_text(&plate(&polygon, THIN, "clamped"), None, Wanted::Lowest(32), 0.001).unwrap();
        assert_within(&solved, &expected, 0.001);
    }
}

#[test]
fn thin_clamped_discs_and_rings_have_the_frequencies_of_bessel_functions() {
    assert_rounds(10, 0.03);
}

#[test]
fn thin_clamped_discs_and_rings_have_32_frequencies_of_bessel_functions() {
    assert_rounds(32, 0.001);
}

/// Asserts the lowest frequencies of clamped discs and rings.
fn assert_rounds(count: usize, error: f64) {
    for (drawing, numbers) in [(DISC, bessel::clamped_disc(15.0)), (RING, bessel::clamped_ring(0.4, 18.0))] {
        let expected: Vec<f64> = numbers.iter().take(count).map(|number| thin_hz(number * number, 1.0, THIN)).collect();
        assert_eq!(expected.len(), count);
        let text = plate("outline = \"round.svg\", unit_m = 1", THIN, "clamped");
        let solved = solve_text(&text, Some(drawing), Wanted::Lowest(count), error).unwrap();
        assert_within(&solved, &expected, 0.00012);
    }
}

#[test]
fn thin_wooden_rectangles_have_the_frequencies_of_closed_form_and_ritz() {
    assert_wood(12, 0.001);
}

#[test]
#[ignore = "fifteen seconds: cargo test -p shape --test bodies thin -- --ignored --nocapture"]
fn thin_wooden_rectangles_have_32_frequencies_of_closed_form_and_ritz() {
    assert_wood(32, 0.001);
}

/// Asserts the lowest frequencies of wooden rectangles.
fn assert_wood(count: usize, error: f64) {
    let (young, poisson, shear) = ([12e9, 0.9e9], 0.4, 0.7e9);
    // Along the grain lies the longer side, then the shorter one. Thin plates have no shear; that
    // within a thickness of free edges counts most.
    for (edge, grain_deg, size, theory) in
        [("hinged", 0, [1.3, 1.0], 5e-5), ("clamped", 90, [1.0, 1.3], 5e-5), ("free", 0, [1.3, 1.0], 3e-4)]
    {
        let truth = ThinPlate::orthotropic(size, THIN, young, poisson, shear);
        let expected = match edge {
            "hinged" => truth.hinged(count),
            "clamped" => truth.ritz(Edges::Clamped, [22, 26], count),
            _ => truth.ritz(Edges::Free, [22, 26], count),
        };
        let polygon = "polygon_m = [[0, 0], [1.3, 0], [1.3, 1], [0, 1]]";
        let wood = format!(
            "youngs_modulus_pa = {young:?}, poisson = {poisson}, shear_modulus_pa = {shear}, grain_deg = {grain_deg}"
        );
        let text = plate(polygon, THIN, edge).replace("youngs_modulus_pa = 200e9, poisson = 0.3", &wood);
        let solved = solve_text(&text, None, Wanted::Lowest(count), error).unwrap();
        println!("{edge}, grain at {grain_deg} degrees");
        assert_within_of(&solved, &expected, 0.0005, theory);
    }
}

#[test]
fn thin_hinged_hexagon_has_the_frequency_of_its_membrane_squared() {
    // Side 1; the membrane's lowest value is that of Jones, arXiv:1602.08636, for regular polygons.
    let corner = |k: i32| [(f64::from(k) * PI / 3.0).cos(), (f64::from(k) * PI / 3.0).sin()];
    let polygon = format!("polygon_m = {:?}", (0..6).map(corner).collect::<Vec<_>>());
    let solved = solve_text(&plate(&polygon, THIN, "hinged"), None, Wanted::Lowest(1), 0.001).unwrap();
    assert_within(&solved, &[thin_hz(7.155_339_13, 1.0, THIN)], 2.8e-4);
}

#[test]
fn membranes_with_a_corner_into_them_have_the_frequencies_of_bessel_functions() {
    for degrees in [240.0_f64, 270.0, 345.0] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let drawing = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="4"><path d="M 2 2 L 3 2 A 1 1 0 1 1 {} {} Z"/></svg>"#,
            2.0 + cosine,
            2.0 + sine
        );
        let text = membrane("outline = \"sector.svg\", unit_m = 1");
        let solved = solve_text(&text, Some(&drawing), Wanted::Lowest(16), 0.001).unwrap();
        let orders = (1..40).map(|n| f64::from(n) * 180.0 / degrees);
        let numbers = sorted(orders.flat_map(|order| bessel::zeros_of_order(order, 14.0)).collect(), 16);
        let expected: Vec<f64> = numbers.iter().map(|number| number / TAU).collect();
        println!("sector of {degrees} degrees");
        assert_within(&solved, &expected, 5e-4);
    }
}

/// Shape file of a membrane whose waves travel at 1 m/s.
fn membrane(shape: &str) -> String {
    format!(
        "format = 1\nname = \"skin\"\nshape = {{ kind = \"membrane\", {shape}, tension_n_per_m = 1, density_kg_per_m2 = 1 }}\nmaterial = {{ loss_factor = 0 }}\n"
    )
}

#[test]
fn membranes_have_the_frequencies_of_closed_forms_to_half_a_thousandth() {
    let l = "polygon_m = [[0, 0], [1, 0], [1, -1], [-1, -1], [-1, 1], [0, 1]]";
    let solved = solve_text(&membrane(l), None, Wanted::Lowest(3), 0.0005).unwrap();
    let expected = [9.639_723_8_f64, 15.197_252, 19.739_209].map(|value| value.sqrt() / TAU);
    assert_within(&solved, &expected, 0.0005);
    let disc =
        solve_text(&membrane("outline = \"disc.svg\", unit_m = 1"), Some(DISC), Wanted::Lowest(8), 0.0005).unwrap();
    let zeros = [2.404_825_6, 3.831_706, 3.831_706, 5.135_622_3, 5.135_622_3, 5.520_078_1, 6.380_161_9, 6.380_161_9];
    assert_within(&disc, &zeros.map(|zero| zero / TAU), 2e-5);
    let ring =
        solve_text(&membrane("outline = \"ring.svg\", unit_m = 1"), Some(RING), Wanted::Lowest(20), 0.0005).unwrap();
    let expected: Vec<f64> = bessel::ring_membrane(0.4, 16.0).iter().take(20).map(|number| number / TAU).collect();
    assert_within(&ring, &expected, 2e-5);
    // Equilateral triangle of side 1: λ = (16 π²/9) (m² + m n + n²).
    let triangle = format!("polygon_m = [[0, 0], [1, 0], [0.5, {}]]", 0.75_f64.sqrt());
    let solved = solve_text(&membrane(&triangle), None, Wanted::Lowest(8), 0.0005).unwrap();
    let waves = (1..12).flat_map(|m| (1..12).map(move |n| f64::from(m * m + m * n + n * n)));
    let expected = sorted(waves.map(|square| (16.0 / 9.0 * square).sqrt() * PI / TAU).collect(), 8);
    assert_within(&solved, &expected, 2e-5);
}
