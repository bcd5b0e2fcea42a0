//! Solids by finite cells, from the surface to the modes.

mod files;
mod surfaces;
#[path = "../truth/mod.rs"]
mod truth;

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;
use shape::eigen;
use shape::file::ShapeFile;
use shape::outline::Outline;
use shape::solid::{Grid, Solid};
use shape::solve::{self, SolveError, Solved, Wanted};
use shape::surface::Surface;
use surfaces::{Mesh, ball, cuboid, cylinder, stl, tube, turned, with_cavity};
use truth::ritz::{Block, Functions};

/// Material of the tests: E 200 GPa, ν 0.3, ρ 8000 kg/m³, without damping.
const METAL: &str = "density_kg_per_m3 = 8000, youngs_modulus_pa = 200e9, poisson = 0.3, loss_factor = 0";
/// Speed of shear waves in it, m/s.
const SHEAR_M_PER_S: f64 = 3_100.868_364_730_21;

fn text(shape: &str, rest: &str) -> String {
    format!("format = 1\nname = \"solid\"\nshape = {{ {shape} }}\nmaterial = {{ {METAL} }}\n{rest}")
}

/// Solves the body of an STL file.
fn solve_surface(mesh: &Mesh, rest: &str, count: usize, error: f64) -> Result<Solved, SolveError> {
    let file = ShapeFile::parse(&text("kind = \"solid\", surface = \"body.stl\"", rest))?;
    let surface = Surface::from_stl(&stl(mesh), 1.0)?;
    solve::solve(&file, &surface, vec![], Wanted::Lowest(count), error, &mut |_| {})
}

/// Solves a body with an outline.
fn solve_outline(shape: &str, count: usize, error: f64) -> Solved {
    let file = ShapeFile::parse(&text(shape, "")).unwrap();
    let outline = Outline::polygon(file.corners_m().unwrap(), &[]).unwrap();
    solve::solve(&file, &outline, vec![], Wanted::Lowest(count), error, &mut |_| {}).unwrap()
}

fn frequencies(solved: &Solved) -> Vec<f64> {
    solved.modes.iter().map(|mode| mode.frequency_hz).collect()
}

/// Asserts that all frequencies are within a share of others, and that the estimates are honest.
fn assert_within(name: &str, solved: &Solved, expected: &[f64], share: f64) {
    let off = |(mode, expected): (&solve::Mode, &f64)| (mode.frequency_hz / expected - 1.0).abs();
    let offs: Vec<f64> = solved.modes.iter().zip(expected).map(off).collect();
    let worst = offs.iter().copied().fold(0.0, f64::max);
    println!("{name}: worst {:.4} % of {} modes, {} unknowns", 100.0 * worst, offs.len(), solved.unknowns);
    assert_eq!(offs.len(), expected.len());
    assert!(worst <= share, "{:?}\n{expected:?}", frequencies(solved));
    let honest = solved.modes.iter().zip(&offs).filter(|(mode, off)| **off <= 2.0 * mode.error).count();
    assert!(20 * honest >= 19 * offs.len(), "{name}: {honest} of {} estimates are honest", offs.len());
    assert_eq!(solved.rigid, 6);
    let counted = solved.counted - solved.rigid;
    assert!((offs.len()..offs.len() + 8).contains(&counted), "the inertia counts {counted} modes");
}

#[test]
fn boxes_at_any_tilt_have_the_frequencies_of_ritz() {
    let size_m = [0.1, 0.09, 0.04];
    let block = Block { size_m, young: 200e9, poisson: 0.3, density: 8000.0, is_clamped: false };
    let expected = block.frequencies(Functions { degrees: [10, 10, 8], layer: 0 }, 20);
    for angles in [[0.0; 3], [0.3, 0.5, 0.7]] {
        let solved = solve_surface(&turned(cuboid(size_m), angles), "", 20, 0.001).unwrap();
        assert_within("box", &solved, &expected, 0.0006);
    }
}

#[test]
fn tilted_cubes_keep_the_multiplets_that_their_grid_does_not_know() {
    let block = Block { size_m: [0.1; 3], young: 200e9, poisson: 0.3, density: 8000.0, is_clamped: false };
    let expected = block.frequencies(Functions { degrees: [10, 10, 10], layer: 0 }, 20);
    // The principal axes of a cube are any axes: a corner is cut from the grid on all sides.
    let solved = solve_surface(&turned(cuboid([0.1; 3]), [0.3, 0.5, 0.7]), "", 20, 0.001).unwrap();
    assert_within("cube", &solved, &expected, 0.001);
    let found = frequencies(&solved);
    for multiplet in [&found[0..2], &found[2..5], &found[5..8]] {
        let [low, high] = [multiplet[0], multiplet[multiplet.len() - 1]];
        assert!(high / low - 1.0 < 1e-3, "{multiplet:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn cubes_at_any_tilt_have_their_lowest_mode_on_any_grid(
        angles in [-1.5..1.5, -1.5..1.5, -1.5..1.5_f64],
        size_m in 0.05..0.18_f64,
    ) {
        let (points, triangles) = turned(cuboid([0.1; 3]), angles);
        let surface = Surface::new(&points, &triangles).unwrap();
        // Axes of the file, so that faces cut the cells aslant.
        let grid = Grid::upright(&surface, size_m);
        let cells = Solid { young: 200e9, poisson: 0.3, density: 8000.0 }.discretise(&surface, &grid).unwrap();
        prop_assert!((cells.mass_kg - 8.0).abs() < 1e-9, "{} kg", cells.mass_kg);
        let modes = eigen::modes(&cells.problem, eigen::Wanted::Lowest(7), None).unwrap();
        let hz = modes.values[6].sqrt() / TAU;
        prop_assert!((hz / 14_095.0 - 1.0).abs() < 0.1 && hz > 14_090.0, "{hz} Hz on {:?} cells", grid.counts());
        prop_assert!(modes.values[5].abs() < 1e-6 * modes.values[6], "rigid motions: {:?}", modes.values);
    }
}

#[test]
fn a_sphere_of_triangles_has_the_multiplets_of_a_ball() {
    let solved = solve_surface(&ball(0.1, 40), "", 5, 0.001).unwrap();
    // Triangles lie inside the ball: as the volume is smaller, so are all lengths.
    let length = (solved.mass_kg / (8000.0 * 4.0 / 3.0 * PI * 1e-3)).cbrt();
    let expected = [2.501_133 * SHEAR_M_PER_S / (0.1 * length) / TAU; 5];
    assert!((length - 1.0).abs() < 3e-4, "{length}");
    assert_within("sphere", &solved, &expected, 0.0002);
    assert!(solved.modes[4].frequency_hz / solved.modes[0].frequency_hz - 1.0 < 1e-3);
}

#[test]
fn a_cylinder_twists_at_the_frequencies_of_a_rod_in_torsion() {
    let solved = solve_surface(&cylinder(0.05, 0.2, 160), "", 8, 0.001).unwrap();
    let found = frequencies(&solved);
    for waves in [1.0, 2.0] {
        let expected = waves * SHEAR_M_PER_S / (2.0 * 0.2);
        let near = found.iter().map(|hz| (hz / expected - 1.0).abs()).fold(f64::MAX, f64::min);
        println!("torsion of {waves} half waves: {:.4} %", 100.0 * near);
        assert!(near < 4e-5, "{found:?}, {expected}");
    }
}

#[test]
fn cavities_are_left_out_of_a_body() {
    let hollow = with_cavity(ball(0.1, 24), ball(0.06, 24));
    let solved = solve_surface(&hollow, "", 5, 0.003).unwrap();
    let volume = 4.0 / 3.0 * PI * (1e-3 - 0.216e-3);
    assert!((solved.mass_kg / (8000.0 * volume) - 1.0).abs() < 0.005, "{}", solved.mass_kg);
}

#[test]
#[ignore = "a minute and more than 1 GB: cargo test -p shape --test solid thin_tube -- --ignored --nocapture"]
fn a_thin_tube_of_thirty_thousand_nodes_ends() {
    let clock = cpu_time::ProcessTime::now();
    let solved = solve_surface(&tube([0.037, 0.04], 0.15, 200), "", 20, 0.001).unwrap();
    println!("{} unknowns: {:.1} s of processor time", solved.unknowns, clock.elapsed().as_secs_f64());
    assert!(solved.unknowns > 90_000, "{}", solved.unknowns);
}

#[test]
#[ignore = "measures time: cargo test -p shape --test solid twenty_modes -- --ignored --nocapture"]
fn twenty_modes_of_a_solid_take_six_seconds_of_one_core_at_most() {
    let (points, triangles) = turned(cuboid([0.1, 0.09, 0.08]), [0.3, 0.5, 0.7]);
    let surface = Surface::new(&points, &triangles).unwrap();
    let clock = cpu_time::ProcessTime::now();
    let cells = Solid { young: 200e9, poisson: 0.3, density: 8000.0 }
        .discretise(&surface, &Grid::upright(&surface, 0.033))
        .unwrap();
    eigen::modes(&cells.problem, eigen::Wanted::Lowest(26), None).unwrap();
    let seconds = clock.elapsed().as_secs_f64();
    println!("{} unknowns: {seconds:.2} s of processor time", cells.problem.size);
    assert!(cells.problem.size > 8000 && seconds < 6.0, "{seconds} s of {} unknowns", cells.problem.size);
}

#[test]
fn plate_and_solid_agree_on_a_bar() {
    let outline = "polygon_m = [[0, 0], [0.2, 0], [0.2, 0.03], [0, 0.03]], thickness_m = 0.008";
    let plate = frequencies(&solve_outline(&format!("kind = \"plate\", {outline}"), 6, 0.001));
    // The solid moves in the plane of the plate, too: each mode of the plate is one of its modes.
    let solid = frequencies(&solve_outline(&format!("kind = \"solid\", {outline}"), 10, 0.001));
    for hz in plate {
        let near = solid.iter().map(|other| (hz / other - 1.0).abs()).fold(f64::MAX, f64::min);
        println!("plate at {hz:.1} Hz and solid: {:.3} %", 100.0 * near);
        assert!(near < 0.0034, "{hz} and {solid:?}");
    }
}

#[test]
fn sheet_and_solid_agree_on_undercut_bars_of_any_width() {
    let arch = "[[0, 0], [0.06, 0], [0.08, 0.01], [0.15, 0.01], [0.17, 0], [0.23, 0], [0.23, 0.02], [0, 0.02]]";
    for width in [0.02, 0.045, 0.07] {
        let outline = format!("polygon_m = {arch}, thickness_m = {width}");
        let sheet = frequencies(&solve_outline(&format!("kind = \"sheet\", {outline}"), 3, 0.001));
        let solid = frequencies(&solve_outline(&format!("kind = \"solid\", {outline}"), 12, 0.001));
        for hz in sheet {
            let near = solid.iter().map(|other| (hz / other - 1.0).abs()).fold(f64::MAX, f64::min);
            println!("sheet {width} m wide at {hz:.1} Hz and solid: {:.3} %", 100.0 * near);
            assert!(near < 0.004, "{hz} and {solid:?}");
        }
    }
}

#[test]
fn planes_of_the_grid_lie_in_the_faces_of_a_slot() {
    let block = [[0.0, 0.0], [0.12, 0.0], [0.12, 0.05], [0.0, 0.05]];
    let slot = vec![[0.02, 0.02], [0.1, 0.02], [0.1, 0.026], [0.02, 0.026]];
    let surface = Surface::extruded(&Outline::polygon(&block, &[slot]).unwrap(), 0.06).unwrap();
    let grid = Grid::over(&surface, 0.02);
    for (axis, at_m) in [(0, 0.02), (0, 0.1), (1, 0.02), (1, 0.026)] {
        assert!(grid.planes_m[axis].iter().any(|plane| (plane - at_m).abs() < 1e-12), "{:?}", grid.planes_m);
    }
    // Cells within the slot are left out: its sides share no motion but at its ends.
    let cells = Solid { young: 1e10, poisson: 0.3, density: 700.0 }.discretise(&surface, &grid).unwrap();
    let slot_cells = 4 * 3;
    assert_eq!(cells.len(), grid.count() - slot_cells, "{:?}", grid.counts());
}

#[test]
fn strike_and_point_exchanged_give_the_same_gains_on_a_solid() {
    let rest = |strike: &str, heard: &str| {
        format!(
            "strike = {{ path_m = [{strike}], positions = 1 }}\nsound = {{ readout = \"velocity\", at_m = {heard} }}\n"
        )
    };
    let (top, side) = ("[0.03, 0.02, 0.04]", "[0.1, 0.05, 0.01]");
    let body = cuboid([0.1, 0.09, 0.04]);
    let one = solve_surface(&body, &rest(top, side), 8, 0.01).unwrap();
    let other = solve_surface(&body, &rest(side, top), 8, 0.01).unwrap();
    for (a, b) in one.modes.iter().zip(&other.modes) {
        let largest = one.modes.iter().map(|mode| mode.gains[0].cosine.abs()).fold(0.0, f64::max);
        assert!((a.gains[0].cosine - b.gains[0].cosine).abs() <= 1e-9 * largest);
    }
}

#[test]
fn faults_of_solids_are_named() {
    let body = cuboid([0.1, 0.09, 0.04]);
    let fault = |rest: &str| solve_surface(&body, rest, 3, 0.01).unwrap_err().to_string();
    let inside = "strike = { path_m = [[0.05, 0.04, 0.02]] }\n";
    assert!(fault(inside).contains("not on the surface"), "{}", fault(inside));
    let flat = "strike = { path_m = [[0.05, 0.04]] }\n";
    assert!(fault(flat).contains("three coordinates"), "{}", fault(flat));
    assert!(fault("support = { edge = \"clamped\" }\n").contains("a solid is free"));
    let pressure = "sound = { readout = \"pressure\", at_m = [0, 0, 1] }\n";
    assert!(fault(pressure).contains("pressure"), "{}", fault(pressure));
    let millimetres = solve_surface(&cuboid([100.0, 90.0, 40.0]), "", 3, 0.01).unwrap_err();
    assert!(matches!(millimetres, SolveError::Size { .. }), "{millimetres}");
    // Two bodies that share a part: their surface encloses it twice.
    let mut crossed = cuboid([0.1; 3]);
    let second = crossed.0.iter().map(|point| point.map(|part| part * 0.9 + 0.05)).collect::<Vec<_>>();
    let triangles = crossed.1.iter().map(|&[a, b, c]| [a + 8, c + 8, b + 8]).collect::<Vec<_>>();
    crossed.0.extend(second);
    crossed.1.extend(triangles);
    let crossed = solve_surface(&crossed, "", 3, 0.01).unwrap_err();
    assert!(crossed.to_string().contains("crosses itself"), "{crossed}");
}
