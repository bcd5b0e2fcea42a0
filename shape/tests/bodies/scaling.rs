//! Bodies that differ by stiffness, density and size alone.

use shape::solve::{Solved, Wanted};

use crate::solve_text;

/// Factors of stiffness, density and size.
const FACTORS: [[f64; 3]; 5] =
    [[4.0, 1.0, 1.0], [1.0, 0.37, 1.0], [1.0, 1.0, 1.7], [3.19, 0.313, 0.77], [0.293, 2.71, 2.13]];

/// Text of a list of points, times a factor.
fn points(points: &[[f64; 2]], size: f64) -> String {
    format!("{:?}", points.iter().map(|point| point.map(|part| part * size)).collect::<Vec<_>>())
}

/// Text of a material.
fn metal([stiffness, density, _]: [f64; 3]) -> String {
    format!(
        "density_kg_per_m3 = {:?}, youngs_modulus_pa = {:?}, poisson = 0.3, loss_factor = 0",
        8000.0 * density,
        200e9 * stiffness
    )
}

/// Largest difference of frequencies and shapes, as a share, from those that the factors tell.
fn off(first: &Solved, other: &Solved, [stiffness, density, size]: [f64; 3], dimensions: i32) -> f64 {
    let frequency = (stiffness / density).sqrt() / size;
    let shape = (density * size.powi(dimensions)).sqrt().recip();
    let largest = first.modes.iter().flat_map(|mode| &mode.gains).map(|gain| gain.cosine).fold(0.0, f64::max);
    let pairs = first.modes.iter().zip(&other.modes);
    assert_eq!(first.modes.len(), other.modes.len());
    pairs
        .flat_map(|(a, b)| {
            let gains = a.gains.iter().zip(&b.gains);
            let gains = gains.map(move |(a, b)| (b.cosine / shape - a.cosine).abs() / largest);
            gains.chain([(b.frequency_hz / a.frequency_hz / frequency - 1.0).abs()])
        })
        .fold(0.0, f64::max)
}

/// Asserts that a body follows the laws; `text` gives its file for factors.
fn assert_scales(name: &str, dimensions: i32, text: impl Fn([f64; 3]) -> String) {
    let solve = |factors: [f64; 3]| solve_text(&text(factors), None, Wanted::Lowest(8), 0.002).unwrap();
    let first = solve([1.0; 3]);
    let worst = FACTORS.iter().map(|&factors| off(&first, &solve(factors), factors, dimensions)).fold(0.0, f64::max);
    println!("{name}: {worst:.1e}");
    assert!(worst < 1e-12, "{name}: {worst}");
}

#[test]
fn stiffness_density_and_size_scale_all_frequencies_and_shapes() {
    let bar = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.03], [0.0, 0.03]];
    let l = [[0.1, 0.2], [0.3, 0.2], [0.3, 0.31], [0.21, 0.31], [0.21, 0.47], [0.1, 0.47]];
    let cup = [[0.0, 0.0], [0.03, 0.0], [0.04, 0.08], [0.037, 0.08], [0.028, 0.003], [0.0, 0.003]];
    let body = |kind: &str, keys: String, material: String| {
        format!("format = 1\nname = \"x\"\nshape = {{ kind = \"{kind}\", {keys} }}\nmaterial = {{ {material} }}\n")
    };
    let flat = |kind: &'static str, outline: &'static [[f64; 2]], thickness: f64| {
        move |factors: [f64; 3]| {
            let size = factors[2];
            let keys = format!("polygon_m = {}, thickness_m = {:?}", points(outline, size), thickness * size);
            body(kind, keys, metal(factors))
        }
    };
    let [bar, l] = [bar.to_vec().leak(), l.to_vec().leak()];
    assert_scales("bar", 3, flat("plate", bar, 0.008));
    assert_scales("thin free plate", 3, flat("plate", l, 0.0001));
    assert_scales("sheet", 3, flat("sheet", l, 0.02));
    assert_scales("wood", 3, |factors| {
        let [stiffness, density, size] = factors;
        let [along, across, shear] = [12e9, 0.9e9, 0.7e9].map(|modulus: f64| modulus * stiffness);
        let wood = format!(
            "density_kg_per_m3 = {:?}, youngs_modulus_pa = [{along:?}, {across:?}], poisson = 0.4, \
             shear_modulus_pa = {shear:?}, grain_deg = 20, loss_factor = 0",
            700.0 * density
        );
        let keys = format!("polygon_m = {}, thickness_m = {:?}", points(bar, size), 0.0003 * size);
        body("plate", keys, wood)
    });
    assert_scales("cup", 3, |factors| {
        body("revolve", format!("profile_m = {}", points(&cup, factors[2])), metal(factors))
    });
    assert_scales("membrane", 2, |[tension, density, size]| {
        let keys = format!("tension_n_per_m = {:?}, density_kg_per_m2 = {:?}", 900.0 * tension, 0.3 * density);
        body("membrane", format!("polygon_m = {}, {keys}", points(l, size)), "loss_factor = 0".to_owned())
    });
    assert_scales("solid", 3, flat("solid", bar, 0.01));
}
