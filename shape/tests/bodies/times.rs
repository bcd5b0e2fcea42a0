//! Processor time of whole searches for modes, on one core.

use cpu_time::ProcessTime;
use shape::eigen;
use shape::element::{Elasticity, Material, PlaneState, Sheet, Support};
use shape::mesh::{Mesh, Sizing};
use shape::outline::Outline;
use shape::solve::Wanted;

use crate::{DISC, plate, solve_text};

#[test]
#[ignore = "measures time: cargo test --release -p shape --test bodies times -- --ignored --nocapture --test-threads 1"]
fn sixty_four_modes_of_plates_take_a_second_of_one_core() {
    for (edge, thickness_m) in [
        ("free", 0.01),
        ("free", 0.03),
        ("free", 0.0005),
        ("hinged", 0.01),
        ("hinged", 0.03),
        ("hinged", 0.0005),
        ("clamped", 0.01),
        ("clamped", 0.03),
        ("clamped", 0.0005),
    ] {
        let text = plate("polygon_m = [[0, 0], [1, 0], [1, 1], [0, 1]]", thickness_m, edge);
        let took_s = took(&format!("{edge} square of h/a {thickness_m}"), &text, None);
        assert!(took_s <= 1.0, "{took_s} s");
    }
}

#[test]
#[ignore = "measures time: cargo test --release -p shape --test bodies times -- --ignored --nocapture --test-threads 1"]
fn sixty_four_modes_of_discs_take_at_most_2_5_times_as_long_as_those_of_squares() {
    for edge in ["free", "hinged", "clamped"] {
        for thickness_m in [0.001, 0.02] {
            let ratios = [0; 5].map(|_| {
                let square = plate("polygon_m = [[0, 0], [2, 0], [2, 2], [0, 2]]", thickness_m, edge);
                let disc = plate("outline = \"disc.svg\", unit_m = 1", thickness_m, edge);
                took(&format!("{edge} disc of h/a {}", thickness_m / 2.0), &disc, Some(DISC))
                    / took(&format!("{edge} square of h/a {}", thickness_m / 2.0), &square, None)
            });
            let middle = median(ratios);
            println!("{middle:.2} times as long");
            assert!(middle <= 2.5, "{middle:.2} times as long");
        }
    }
}

/// Finds 64 modes of a plate; gives the processor time, seconds.
fn took(name: &str, text: &str, svg: Option<&str>) -> f64 {
    let begin = ProcessTime::now();
    let solved = solve_text(text, svg, Wanted::Lowest(64), 0.001).unwrap();
    let took_s = begin.elapsed().as_secs_f64();
    let meshes: Vec<usize> = solved.meshes.iter().map(|mesh| mesh.unknowns).collect();
    println!("{name}: {took_s:.2} s, {meshes:?} unknowns");
    took_s
}

/// Gives the middle one of five numbers.
fn median(mut numbers: [f64; 5]) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[2]
}

#[test]
#[ignore = "measures time: cargo test --release -p shape --test bodies times -- --ignored --nocapture --test-threads 1"]
fn modes_of_quadratic_triangles_with_14_000_unknowns_take_a_second_of_one_core() {
    let outline = Outline::polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &[]).unwrap();
    let material = Material { elasticity: Elasticity::Isotropic { young: 200e9, poisson: 0.3 }, density: 7850.0 };
    let sheet = Sheet { material, thickness: 0.01, state: PlaneState::Stress };
    let begin = ProcessTime::now();
    let mesh = Mesh::over(&outline, &Sizing::even(1.0 / 29.5)).unwrap();
    let problem = sheet.discretise(&mesh, 2, &[Support::Free; 4]).unwrap().problem;
    let found = eigen::modes(&problem, eigen::Wanted::Lowest(32), None).unwrap();
    let took_s = begin.elapsed().as_secs_f64();
    println!("{} unknowns of quadratic triangles, {} modes: {took_s:.2} s", problem.size, found.values.len());
    assert!(problem.size >= 14_000 && took_s <= 1.0, "{} unknowns, {took_s} s", problem.size);
}
