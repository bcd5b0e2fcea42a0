//! Plates and bars against elasticity in space.

use shape::solve::Wanted;

use crate::truth::ritz::{FreeBox, Functions};
use crate::{METAL, assert_within, frequencies, solve_text};

/// Functions whose frequencies are within 1e-5 of those of more functions.
const FUNCTIONS: Functions = Functions { degrees: [14, 14, 6], layer: 6 };

/// Free box of the tests' material.
fn metal(size_m: [f64; 3]) -> FreeBox {
    FreeBox { size_m, young: 200e9, poisson: 0.3, density: 8000.0 }
}

/// Text of a free plate.
fn free_plate([length, width, thickness]: [f64; 3]) -> String {
    format!(
        "format = 1\nname = \"plate\"\nshape = {{ kind = \"plate\", polygon_m = [[0, 0], [{length}, 0], [{length}, \
         {width}], [0, {width}]], thickness_m = {thickness} }}\nmaterial = {{ {METAL} }}\n"
    )
}

/// Largest difference of frequencies, as a share of them.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn products_of_legendre_polynomials_converge_for_plates_and_bars() {
    let more = Functions { degrees: [16, 16, 7], layer: 8 };
    for size in [[1.0, 1.0, 0.05], [1.0, 1.0, 0.1]] {
        let [one, other] = [FUNCTIONS, more].map(|functions| metal(size).bending(functions, 16));
        println!("{size:?}: {:.1e}", difference(&one, &other));
    }
    for size in [[0.2, 0.03, 0.008], [0.2, 0.03, 0.01]] {
        for functions in [Functions { degrees: [14, 8, 6], layer: 0 },Functions { degrees: [18, 8, 6], layer: 0 },Functions { degrees: [18, 10, 8], layer: 0 }, Functions { degrees: [14, 10, 6], layer: 6 }, Functions { degrees: [16, 8, 6], layer: 6 }] {
            let start = std::time::Instant::now();
            let found = metal(size).bending(functions, 20);
            println!("{size:?} {functions:?} {:.1}s {found:.3?}", start.elapsed().as_secs_f64());
        }
    }
}

#[test]
fn free_plates_have_the_frequencies_of_elasticity_in_space() {
    for (thickness, count) in [(0.01, 16), (0.03, 16), (0.05, 16), (0.1, 8), (0.1, 16)] {
        let size = [1.0, 1.0, thickness];
        let solved = solve_text(&free_plate(size), None, Wanted::Lowest(count), 0.001).unwrap();
        let truth = metal(size).bending(FUNCTIONS, count);
        println!("h/a {thickness}, {} unknowns", solved.unknowns);
        for ((mode, hz), truth) in solved.modes.iter().zip(frequencies(&solved)).zip(&truth) {
            let k = (std::f64::consts::TAU * truth * (8000.0 * thickness / (200e9 * thickness.powi(3) / 12.0)).sqrt()).sqrt();
            let off = hz / truth - 1.0;
            println!("{truth:9.3} off {off:.6} estimate {:.6} (kh)2 {:.4} share {:.4}", mode.error, (k * thickness).powi(2), off / (k * thickness).powi(2));
        }
    }
}
#[test]
fn bars_have_the_frequencies_of_elasticity_in_space() {
    for thickness in [0.008, 0.01] {
        let size = [0.2, 0.03, thickness];
        let solved = solve_text(&free_plate(size), None, Wanted::Below(13e3), 0.001).unwrap();
        let truth = metal(size).bending(Functions { degrees: [16, 8, 6], layer: 6 }, solved.modes.len() + 1);
        println!("bar {thickness}, {} unknowns {:?}", solved.unknowns, truth.last());
        for ((mode, hz), truth) in solved.modes.iter().zip(frequencies(&solved)).zip(&truth) {
            let k = (std::f64::consts::TAU * truth * (8000.0 * thickness / (200e9 * thickness.powi(3) / 12.0)).sqrt()).sqrt();
            let off = hz / truth - 1.0;
            println!("{truth:9.3} off {off:.6} estimate {:.6} (kh)2 {:.4} share {:.4}", mode.error, (k * thickness).powi(2), off / (k * thickness).powi(2));
        }
    }
    let _ = assert_within;
}
