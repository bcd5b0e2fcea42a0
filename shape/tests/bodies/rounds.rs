//! Bodies of revolution against elasticity in space.

use std::f64::consts::{PI, TAU};

use shape::solve::{Solved, Wanted};

use crate::pairs::assert_groups;
use crate::truth::round::{Lame, cylinder, sphere};
use crate::{METAL, SPHERE, assert_within, solve_text};

/// Profile of a sphere of radius 1 with a hollow of radius 0.6.
const HOLLOW: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="2" height="2"><path d="M0,0 A1,1 0 0,1 0,2 L0,1.6 A0.6,0.6 0 0,0 0,0.4 Z"/></svg>"#;

/// Tests' material.
fn metal() -> Lame {
    Lame { first: 200e9 * 0.3 / (1.3 * 0.4), shear: 200e9 / 2.6, density: 8000.0 }
}

/// Solves a body of revolution; `profile` are the keys of its shape.
fn round(profile: &str, svg: Option<&str>, count: usize, error: f64) -> Solved {
    let text = format!(
        "format = 1\nname = \"round\"\nshape = {{ kind = \"revolve\", {profile} }}\nmaterial = {{ {METAL} }}\n"
    );
    solve_text(&text, svg, Wanted::Lowest(count), error).unwrap()
}

/// Returns ω a/c of shear waves of a sphere's lowest spheroidal mode of degree 2 (Eringen and
/// Suhubi, Elastodynamics II, 1975).
fn spheroidal(poisson: f64) -> f64 {
    let j2 = |x: f64| (3.0 / x.powi(3) - 1.0 / x) * x.sin() - 3.0 / (x * x) * x.cos();
    let j3 = |x: f64| (15.0 / x.powi(4) - 6.0 / (x * x)) * x.sin() - (15.0 / x.powi(3) - 1.0 / x) * x.cos();
    let determinant = |k: f64| {
        let h = k * ((1.0 - 2.0 * poisson) / (2.0 * (1.0 - poisson))).sqrt();
        let pressure = [(2.0 - k * k / 2.0) * j2(h) + 2.0 * h * j3(h), j2(h) - h * j3(h)];
        let shear = [6.0 * (j2(k) - k * j3(k)), (3.0 - k * k / 2.0) * j2(k) + k * j3(k)];
        pressure[0] * shear[1] - shear[0] * pressure[1]
    };
    let (mut low, mut high) = (2.5, 2.8);
    for _ in 0..60 {
        let half = (low + high) / 2.0;
        if determinant(low) * determinant(half) <= 0.0 { high = half } else { low = half }
    }
    low
}

#[test]
fn spheres_have_their_multiplets() {
    let drawing = "outline = \"half.svg\", unit_m = 0.1";
    let solved = round(drawing, Some(SPHERE), 20, 0.002);
    let truth = sphere(metal(), [0.0, 0.1], 14, 20);
    // Torsional and spheroidal modes of degree 2 by the frequency equations.
    let shear_m_per_s = (200e9_f64 / 2.6 / 8000.0).sqrt();
    for (mode, root) in [(0, 2.501_133), (5, spheroidal(0.3))] {
        assert!((root * shear_m_per_s / 0.1 / TAU / truth[mode] - 1.0).abs() < 1e-6, "{truth:?}");
    }
    assert_eq!(solved.rigid, 6);
    assert!((solved.mass_kg / (8000.0 * 4.0 / 3.0 * PI * 1e-3) - 1.0).abs() < 1e-6, "{}", solved.mass_kg);
    assert_within(&solved, &truth, 2e-6);
    // Torsional modes of degree 2, spheroidal ones of degrees 2, 1 and 3.
    assert_groups("sphere", &solved, &[5, 5, 3, 7], 1e-8);
    let solved = round(drawing, Some(HOLLOW), 22, 0.002);
    assert_within(&solved, &sphere(metal(), [0.06, 0.1], 14, 22), 2e-6);
}

#[test]
fn cylinders_have_the_frequencies_of_ritz() {
    let [less, truth] = [[7, 16], [9, 20]].map(|degrees| cylinder(metal(), 0.05, 0.12, degrees, 20));
    let change = less.iter().zip(&truth).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
    println!("more polynomials change by {change:.1e}");
    assert!(change < 1e-5, "{less:?} {truth:?}");
    let solved = round("profile_m = [[0, 0], [0.05, 0], [0.05, 0.12], [0, 0.12]]", None, 20, 0.002);
    assert_within(&solved, &truth, 2e-6);
}
