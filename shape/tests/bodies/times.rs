//! Processor time of whole searches for modes, on one core.

use cpu_time::ProcessTime;
use shape::eigen;
use shape::element::{Elasticity, Material, PlaneState, Sheet, Support};
use shape::mesh::{Mesh, Sizing};
use shape::outline::Outline;
use shape::solve::Wanted;

use crate::{plate, solve_text};

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
        let begin = ProcessTime::now();
        let solved = solve_text(&text, None, Wanted::Lowest(64), 0.001).unwrap();
        let took_s = begin.elapsed().as_secs_f64();
        let meshes: Vec<usize> = solved.meshes.iter().map(|mesh| mesh.unknowns).collect();
        println!("{edge} square of h/a {thickness_m}: {took_s:.2} s, {meshes:?} unknowns");
        assert!(took_s <= 1.0, "{took_s} s");
    }
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
    let found = eigen::modes(&problem, eigen::Wanted::Lowest(32), &mut |_, _| {}).unwrap();
    let took_s = begin.elapsed().as_secs_f64();
    println!("{} unknowns of quadratic triangles, {} modes: {took_s:.2} s", problem.size, found.values.len());
    assert!(problem.size >= 14_000 && took_s <= 1.0, "{} unknowns, {took_s} s", problem.size);
}
