//! Estimates of the errors of polygons, against meshes that are much finer.

use std::f64::consts::TAU;

use shape::solve::Wanted;

use crate::{METAL, frequencies, plate, solve_text};

/// Corners of a polygon around the origin, at distances that a number tells, counter-clockwise.
fn star(corners: usize, mut number: u64) -> Vec<[f64; 2]> {
    let mut draw = || {
        number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (number >> 33) as f64 / f64::from(1_u32 << 31)
    };
    let mut corner = |k: usize| {
        let turn = TAU * (k as f64 + 0.5 * draw()) / corners as f64;
        let far = 0.5 + 0.5 * draw();
        [far * turn.cos(), far * turn.sin()]
    };
    (0..corners).map(&mut corner).collect()
}

/// Text of a sheet or a membrane.
fn flat(kind: &str, polygon: &str) -> String {
    let (keys, material) = if kind == "sheet" {
        ("thickness_m = 0.02", METAL)
    } else {
        ("tension_n_per_m = 1, density_kg_per_m2 = 1", "loss_factor = 0")
    };
    format!(
        "format = 1\nname = \"x\"\nshape = {{ kind = \"{kind}\", {polygon}, {keys} }}\nmaterial = {{ {material} }}\n"
    )
}

#[test]
#[ignore = "half a minute: cargo test --release -p shape --test bodies polygons -- --ignored --nocapture"]
fn estimates_of_polygons_hold_against_finer_meshes() {
    let (mut all, mut honest) = (0, 0);
    for corners in 3..6 {
        for number in 0..2 {
            let polygon = format!("polygon_m = {:?}", star(corners, 10 * corners as u64 + number));
            let bodies = [
                ("membrane", flat("membrane", &polygon)),
                ("sheet", flat("sheet", &polygon)),
                ("clamped plate", plate(&polygon, 0.0005, "clamped")),
                ("hinged plate", plate(&polygon, 0.005, "hinged")),
                ("free plate", plate(&polygon, 0.005, "free")),
            ];
            for (name, text) in bodies {
                // A mesh for four times as many modes has edges half as long.
                let [solved, finer] =
                    [12, 48].map(|count| solve_text(&text, None, Wanted::Lowest(count), 0.001).unwrap());
                let pairs = solved.modes.iter().zip(frequencies(&finer));
                let quotients = pairs.map(|(mode, hz)| (mode.frequency_hz / hz - 1.0).abs() / mode.error);
                let quotients: Vec<f64> = quotients.collect();
                let worst = quotients.iter().copied().fold(0.0, f64::max);
                println!("{name} of {corners} corners: error by estimate at most {worst:.2}, {:?}", solved.unknowns);
                all += quotients.len();
                honest += quotients.iter().filter(|quotient| **quotient <= 2.0).count();
            }
        }
    }
    println!("{honest} of {all} estimates are honest");
    assert!(20 * honest >= 19 * all, "{honest} of {all} estimates are honest");
}

#[test]
fn estimates_of_a_hinged_plate_with_a_corner_into_it_hold_against_a_finer_mesh() {
    let polygon = "polygon_m = [[0, 0], [1, 0], [1, 0.5], [0.5, 0.5], [0.5, 1], [0, 1]]";
    // The finer mesh is that of six times as many modes.
    let text = plate(polygon, 0.01, "hinged");
    let [solved, finer] = [8, 48].map(|count| solve_text(&text, None, Wanted::Lowest(count), 0.001).unwrap());
    assert!(finer.unknowns > solved.unknowns, "{} and {} unknowns", finer.unknowns, solved.unknowns);
    for (mode, hz) in solved.modes.iter().zip(frequencies(&finer)) {
        let off = (mode.frequency_hz / hz - 1.0).abs();
        println!("{:.2} Hz: off by {:.4} %, estimate {:.4} %", hz, 100.0 * off, 100.0 * mode.error);
        assert!(off <= mode.error && mode.error <= 0.001, "{off} at {hz} Hz, estimate {}", mode.error);
    }
}

#[test]
fn free_plates_of_three_to_two_need_two_meshes_for_sixty_four_modes() {
    for thickness_m in [0.00015, 0.001] {
        let text = plate("polygon_m = [[0, 0], [0.3, 0], [0.3, 0.2], [0, 0.2]]", thickness_m, "free");
        let solved = solve_text(&text, None, Wanted::Lowest(64), 0.001).unwrap();
        let unknowns: Vec<usize> = solved.meshes.iter().map(|mesh| mesh.unknowns).collect();
        println!("{unknowns:?} unknowns");
        assert_eq!(unknowns.len(), 2, "{unknowns:?} unknowns");
    }
}
