//! Plates and bars against elasticity in space.

use std::f64::consts::{PI, TAU};

use shape::solve::{Solved, Wanted};

use crate::truth::ritz::{Block, Functions, sorted};
use crate::{METAL, frequencies, solve_text};

/// Functions whose frequencies are within 2e-5 of those of more functions.
const FUNCTIONS: Functions = Functions { degrees: [14, 14, 5], layer: 5 };

/// Free block of the tests' material.
fn metal(size_m: [f64; 3]) -> Block {
    Block { size_m, young: 200e9, poisson: 0.3, density: 8000.0, is_clamped: false }
}

/// Solves a plate whose edges are alike.
fn plate([length, width, thickness]: [f64; 3], edge: &str, wanted: Wanted) -> Solved {
    let text = format!(
        "format = 1\nname = \"plate\"\nshape = {{ kind = \"plate\", polygon_m = [[0, 0], [{length}, 0], [{length}, \
         {width}], [0, {width}]], thickness_m = {thickness} }}\nmaterial = {{ {METAL} }}\n\
         support = {{ edge = \"{edge}\" }}\n"
    );
    solve_text(&text, None, wanted, 0.001).unwrap()
}

/// Largest difference of frequencies, as a share of them.
fn difference(found: &[f64], truth: &[f64]) -> f64 {
    found.iter().zip(truth).map(|(found, truth)| (found / truth - 1.0).abs()).fold(0.0, f64::max)
}

/// Asserts that frequencies are within a share of the truth, and that at most one of 20 is off by
/// more than twice its estimate.
fn assert_near(name: &str, solved: &Solved, truth: &[f64], share: f64) {
    let found = frequencies(solved);
    let worst = difference(&found, truth);
    let quotient = |((mode, found), truth): ((&shape::solve::Mode, &f64), &f64)| {
        mode.error / (found / truth - 1.0).abs().max(1e-7)
    };
    let quotients: Vec<f64> = solved.modes.iter().zip(&found).zip(truth).map(quotient).collect();
    let honest = quotients.iter().filter(|quotient| **quotient >= 0.5).count();
    println!("{name}: worst {:.4} % of {} modes; estimate by error {quotients:.2?}", 100.0 * worst, found.len());
    assert!(found.len() <= truth.len() && worst <= share, "{found:?}\n{truth:?}");
    assert!(20 * honest >= 19 * found.len(), "{name}: {honest} of {} estimates are honest", found.len());
    assert!((found.len()..found.len() + 8).contains(&(solved.counted - solved.rigid)), "{} modes", solved.counted);
}

#[test]
fn products_of_legendre_polynomials_converge() {
    let plate = metal([1.0, 1.0, 0.05]);
    let [one, more] =
        [FUNCTIONS, Functions { degrees: [14, 14, 6], layer: 6 }].map(|functions| plate.bending(functions, 16));
    let bar = metal([0.2, 0.03, 0.01]);
    let [few, many] = [[16, 8, 6], [18, 10, 8]].map(|degrees| bar.bending(Functions { degrees, layer: 0 }, 6));
    println!("a plate changes by {:.1e}, a bar by {:.1e}", difference(&one, &more), difference(&few, &many));
    assert!(difference(&one, &more) < 2e-5 && difference(&few, &many) < 4e-5);
}

#[test]
#[ignore = "a minute: cargo test --release -p shape --test bodies products -- --ignored --nocapture"]
fn products_of_legendre_polynomials_stand_to_a_hundred_thousandth() {
    let [one, more] = [Functions { degrees: [14, 14, 6], layer: 6 }, Functions { degrees: [16, 16, 7], layer: 8 }];
    for thickness in [0.01, 0.03, 0.05, 0.1] {
        let [one, more] = [one, more].map(|functions| metal([1.0, 1.0, thickness]).bending(functions, 16));
        println!("h/a {thickness}: {:.1e}", difference(&one, &more));
        assert!(difference(&one, &more) < 1e-5);
    }
}

#[test]
fn free_plates_have_the_frequencies_of_elasticity_in_space() {
    for (thickness, count, share) in [(0.01, 16, 2.9e-4), (0.03, 16, 5.6e-4), (0.05, 16, 1.1e-3), (0.1, 8, 2.3e-3)] {
        let size = [1.0, 1.0, thickness];
        let truth = metal(size).bending(FUNCTIONS, count);
        let solved = plate(size, "free", Wanted::Lowest(count));
        assert_near(&format!("free plate of h/a {thickness}"), &solved, &truth, share);
    }
}

#[test]
fn bars_up_to_13_khz_have_the_frequencies_of_elasticity_in_space() {
    for thickness in [0.008, 0.01] {
        let size = [0.2, 0.03, thickness];
        let solved = plate(size, "free", Wanted::Below(13e3));
        let mut truth = metal(size).bending(Functions { degrees: [18, 10, 8], layer: 0 }, solved.modes.len() + 1);
        assert!(truth.pop_if(|above| *above > 13e3).is_some(), "a mode is missing: {truth:?}");
        assert_near(&format!("bar of {thickness} m"), &solved, &truth, 2.3e-3);
    }
}

#[test]
fn clamped_plates_are_off_elasticity_in_space_by_their_estimate() {
    for thickness in [0.03, 0.1] {
        let size = [1.0, 1.0, thickness];
        let truth = Block { is_clamped: true, ..metal(size) }.bending(FUNCTIONS, 12);
        let solved = plate(size, "clamped", Wanted::Lowest(12));
        assert_near(&format!("clamped plate of h/a {thickness}"), &solved, &truth, 0.11 * thickness);
    }
}

/// Frequency in Hz of the lowest wave along a plate of the tests' material that bends it (Rayleigh
/// 1888, Lamb 1889), by wave number, 1/m, and thickness, metres.
fn lamb_hz(number: f64, thickness: f64) -> f64 {
    let shear = (200e9_f64 / 2.6 / 8000.0).sqrt();
    let pressure = shear * (1.4_f64 / 0.4).sqrt();
    let mismatch = |omega: f64| {
        let [a, b] = [pressure, shear].map(|speed| (number * number - (omega / speed).powi(2)).sqrt());
        let squares = number * number + b * b;
        4.0 * number * number * a * b * (b * thickness / 2.0).tanh() - squares * squares * (a * thickness / 2.0).tanh()
    };
    let (mut low, mut high) = (1e-3 * number * shear, 0.99 * number * shear);
    for _ in 0..60 {
        let half = (low + high) / 2.0;
        if mismatch(low) * mismatch(half) <= 0.0 { high = half } else { low = half }
    }
    low / TAU
}

#[test]
fn hinged_plates_have_the_frequencies_of_waves_in_space() {
    for (thickness, share) in [(0.05, 1.9e-3), (0.1, 5e-3), (0.2, 1e-2)] {
        let waves = (1..9).flat_map(|m| (1..9).map(move |n| f64::from(m).hypot(f64::from(n))));
        let truth = sorted(waves.map(|waves| lamb_hz(PI * waves, thickness)).collect(), 16);
        let solved = plate([1.0, 1.0, thickness], "hinged", Wanted::Lowest(16));
        assert_near(&format!("hinged plate of h/a {thickness}"), &solved, &truth, share);
    }
}
