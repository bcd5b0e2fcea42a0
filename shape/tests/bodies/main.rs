//! Frequencies, gains and estimates of whole bodies, from the text of a shape file to the modes.

#[path = "../truth/mod.rs"]
mod truth;

mod boxes;
mod ellipses;
mod gains;
mod pairs;
mod polygons;
mod rounds;
mod scaling;
mod sheets;
mod thin;
mod times;

use std::f64::consts::TAU;

use shape::file::ShapeFile;
use shape::outline::Outline;
use shape::solve::{self, SolveError, Solved, Wanted};

/// Material of the tests: E 200 GPa, ν 0.3, ρ 8000 kg/m³, without damping.
pub(crate) const METAL: &str = "density_kg_per_m3 = 8000, youngs_modulus_pa = 200e9, poisson = 0.3, loss_factor = 0";

/// Drawing of a circle of radius 1.
pub(crate) const DISC: &str =
    r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="4"><circle cx="2" cy="2" r="1"/></svg>"#;
/// Profile of a sphere of radius 1.
pub(crate) const SPHERE: &str =
    r#"<svg xmlns="http://www.w3.org/2000/svg" width="2" height="2"><path d="M0,0 A1,1 0 0,1 0,2 Z"/></svg>"#;

pub(crate) fn solve_text(text: &str, svg: Option<&str>, wanted: Wanted, error: f64) -> Result<Solved, SolveError> {
    let file = ShapeFile::parse(text)?;
    let outline = match svg {
        Some(svg) => Outline::from_svg(svg, file.shape.unit_m.unwrap_or(1.0))?,
        None => Outline::polygon(file.corners_m().unwrap_or(&[]), &file.shape.holes_m)?,
    };
    solve::solve(&file, &outline, vec![], wanted, error, &mut |_| {})
}

pub(crate) fn frequencies(solved: &Solved) -> Vec<f64> {
    solved.modes.iter().map(|mode| mode.frequency_hz).collect()
}

/// Text of a plate; `support` is that of all edges.
pub(crate) fn plate(polygon: &str, thickness: f64, support: &str) -> String {
    format!(
        "format = 1\nname = \"plate\"\nshape = {{ kind = \"plate\", {polygon}, thickness_m = {thickness} }}\n\
         material = {{ {METAL} }}\nsupport = {{ edge = \"{support}\" }}\n"
    )
}

/// Frequency of a thin plate of the tests' material whose frequency parameter is λ² = ω a² √(ρh/D).
pub(crate) fn thin_hz(parameter: f64, size_m: f64, thickness: f64) -> f64 {
    let stiffness = 200e9 * thickness.powi(3) / (12.0 * (1.0 - 0.09));
    parameter / (size_m * size_m) * (stiffness / (8000.0 * thickness)).sqrt() / TAU
}

/// Asserts that frequencies are within a share of others, and returns the largest difference.
pub(crate) fn assert_within(solved: &Solved, expected: &[f64], share: f64) -> f64 {
    assert_within_of(solved, expected, share, 0.0)
}

/// Asserts as [`assert_within`], against a theory that itself is off by a share.
pub(crate) fn assert_within_of(solved: &Solved, expected: &[f64], share: f64, theory: f64) -> f64 {
    let found = frequencies(solved);
    assert!(found.len() >= expected.len(), "{found:?}");
    let off = |(found, expected): (&f64, &f64)| (found / expected - 1.0).abs();
    let offs: Vec<f64> = found.iter().zip(expected).map(off).collect();
    let worst = offs.iter().copied().fold(0.0, f64::max);
    println!("worst {:.5} % of {} modes, {} unknowns", 100.0 * worst, expected.len(), solved.unknowns);
    assert!(worst <= share, "{found:?}\n{expected:?}");
    let honest = solved.modes.iter().zip(&offs).filter(|(mode, off)| **off <= 2.0 * mode.error + theory).count();
    assert!(20 * honest >= 19 * expected.len(), "estimates: {honest} of {} are honest", expected.len());
    // A multiplet at the end is counted whole.
    let counted = solved.counted - solved.rigid;
    assert!((found.len()..found.len() + 8).contains(&counted), "the inertia counts {counted} modes");
    worst
}

#[test]
fn benchmarks_are_as_near_as_the_page_says() {
    for benchmark in shape::benchmarks::all() {
        let computed = benchmark.solve(0.001).unwrap();
        let differences: Vec<f64> = computed.iter().zip(benchmark.published_hz).map(|(a, b)| a / b - 1.0).collect();
        println!("{}: {differences:.4?}", benchmark.name);
        let most = match benchmark.name {
            "FV12 free plate" | "FV16 thin-plate theory" => 0.003,
            "FV16 cantilever" => 0.013,
            "FV32 tapered sheet" => 0.001,
            "FV52 hinged, bending" => 0.005,
            _ => 0.003,
        };
        assert!(differences.iter().all(|difference| difference.abs() <= most), "{}", benchmark.name);
    }
}

#[test]
fn strike_and_point_exchanged_give_the_same_gains() {
    let text = |strike: &str, heard: &str| {
        format!(
            "format = 1\nname = \"l\"\nshape = {{ kind = \"plate\", polygon_m = [[0, 0], [0.2, 0], [0.2, 0.1], [0.1, 0.1], [0.1, 0.3], [0, 0.3]], thickness_m = 0.004 }}\n\
             material = {{ name = \"steel\" }}\nstrike = {{ path_m = [[{strike}]], positions = 1 }}\nsound = {{ readout = \"velocity\", at_m = [{heard}] }}\n"
        )
    };
    let there = solve_text(&text("0.05, 0.25", "0.17, 0.03"), None, Wanted::Lowest(10), 0.005).unwrap();
    let back = solve_text(&text("0.17, 0.03", "0.05, 0.25"), None, Wanted::Lowest(10), 0.005).unwrap();
    for (a, b) in there.modes.iter().zip(&back.modes) {
        assert!((a.gains[0].cosine - b.gains[0].cosine).abs() <= 1e-9 * a.gains[0].cosine.abs(), "{a:?} {b:?}");
    }
}

#[test]
fn faults_of_a_shape_are_named() {
    let polygon = "polygon_m = [[0, 0], [1, 0], [1, 1], [0, 1]]";
    let named = |text: &str, word: &str| {
        let error = solve_text(text, None, Wanted::Lowest(4), 0.01).unwrap_err().to_string();
        assert!(error.contains(word), "{error}, and not {word}");
    };
    named(&plate("polygon_m = [[0, 0], [1, 1], [1, 0], [0, 0.7]]", 0.01, "free"), "touch");
    named(&plate(polygon, 0.5, "free"), "solid");
    named(&plate("polygon_m = [[0, 0], [100, 0], [100, 100], [0, 100]]", 0.5, "free"), "metres");
    named(&plate(polygon, -0.5, "free"), "thickness_m");
    named(&plate(polygon, 0.01, "glued"), "glued");
    named(&(plate(polygon, 0.01, "free") + "strike = { path_m = [[2, 2]] }\n"), "strike.path_m");
    named(&plate(polygon, 0.01, "free").replace("0.3", "0.5"), "poisson");
    named(&plate(polygon, 0.01, "free").replace("8000", "0"), "density_kg_per_m3");
    named(&plate(polygon, 0.01, "free").replace("kind", "color = 1, kind"), "color");
}

#[test]
fn pairs_of_a_bell_part_by_the_split_and_warble() {
    let text = |split: f64, at: &str| {
        format!(
            "format = 1\nname = \"cup\"\nshape = {{ kind = \"revolve\", split = {split}, profile_m = [[0, 0], [0.03, 0], [0.04, 0.08], [0.037, 0.08], [0.028, 0.003], [0, 0.003]] }}\n\
             material = {{ name = \"glass\" }}\nstrike = {{ path_m = [[0.04, 0.08]], positions = 1 }}\nsound = {{ readout = \"velocity\", at_m = {at} }}\n"
        )
    };
    let round = solve_text(&text(0.0, "[0.04, 0.08]"), None, Wanted::Lowest(6), 0.005).unwrap();
    let split = solve_text(&text(0.002, "[0.04, 0.08]"), None, Wanted::Lowest(6), 0.005).unwrap();
    let [whole, parted] = [frequencies(&round), frequencies(&split)];
    assert!((whole[1] / whole[0] - 1.0).abs() < 1e-9, "{whole:?}");
    assert!((parted[1] / parted[0] - 1.002).abs() < 1e-5, "{parted:?}");
    // The struck member of a perfect pair sounds alone; an imperfect pair shares its sound.
    let [a, b] = [0, 1].map(|mode: usize| round.modes[mode].gains[0].cosine);
    assert!(a.min(b).abs() < 1e-9 * a.max(b), "{a} {b}");
    let shares: f64 = (0..2).map(|mode: usize| split.modes[mode].gains[0].cosine).sum();
    assert!((shares / a.max(b) - 1.0).abs() < 1e-6, "{shares} {a} {b}");
    // A quarter of two waves away from the strike is a node.
    let aside = solve_text(&text(0.0, "[0.04, 0.08, 45]"), None, Wanted::Lowest(2), 0.005).unwrap();
    let heard = aside.modes.iter().map(|mode| mode.gains[0].cosine.abs()).fold(0.0, f64::max);
    assert!(heard < 1e-9 * a.max(b), "{heard}");
}
