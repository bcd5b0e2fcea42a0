//! Sheets of any width: bars seen from their side, against elasticity in space.

use shape::solve::{Solved, Wanted};

use crate::truth::ritz::{Block, Functions, parities, sorted};
use crate::{frequencies, solve_text};

/// Functions whose frequencies are within 2e-5 of those of more functions.
const FUNCTIONS: Functions = Functions { degrees: [18, 9, 13], layer: 0 };

/// Materials: Young's modulus, Poisson's ratio and density of steel, glass and aluminium.
const MATERIALS: [(&str, (f64, f64, f64)); 3] =
    [("steel", (200e9, 0.3, 7850.0)), ("glass", (70e9, 0.2, 2500.0)), ("aluminium", (70e9, 0.33, 2700.0))];

/// Block of the material, with a bar's length, height and width.
fn block(size_m: [f64; 3], (young, poisson, density): (f64, f64, f64)) -> Block {
    Block { size_m, young, poisson, density, is_clamped: false }
}

/// Frequencies of the modes of a block that move alike on both sides of its middle plane.
fn truth(block: &Block, functions: Functions, count: usize) -> Vec<f64> {
    let alike = parities().filter(|parity| !parity[2]);
    sorted(alike.flat_map(|parity| block.of_parity(parity, functions)).collect(), count)
}

/// Solves a block as a sheet.
fn sheet(block: &Block, edge: &str, wanted: Wanted, error: f64) -> Solved {
    let [length, height, width] = block.size_m;
    let Block { young, poisson, density, .. } = block;
    let text = format!(
        "format = 1\nname = \"bar\"\nshape = {{ kind = \"sheet\", polygon_m = [[0, 0], [{length}, 0], [{length}, \
         {height}], [0, {height}]], thickness_m = {width} }}\nmaterial = {{ density_kg_per_m3 = {density}, \
         youngs_modulus_pa = {young}, poisson = {poisson}, loss_factor = 0 }}\nsupport = {{ edge = \"{edge}\" }}\n"
    );
    solve_text(&text, None, wanted, error).unwrap()
}

/// Asserts that frequencies are within a share of the truth, and returns the number of estimates
/// that are less than half the error.
fn assert_near(name: &str, solved: &Solved, truth: &[f64], share: f64) -> usize {
    let found = frequencies(solved);
    let offs: Vec<f64> = found.iter().zip(truth).map(|(found, truth)| (found / truth - 1.0).abs()).collect();
    let worst = offs.iter().copied().fold(0.0, f64::max);
    let quotients: Vec<f64> = solved.modes.iter().zip(&offs).map(|(mode, off)| mode.error / off.max(1e-7)).collect();
    println!("{name}: worst {:.4} % of {} modes; estimate by error {quotients:.1?}", 100.0 * worst, truth.len());
    assert!(found.len() == truth.len() && worst <= share, "{name}: {found:?}\n{truth:?}");
    assert!((found.len()..found.len() + 8).contains(&(solved.counted - solved.rigid)), "{} modes", solved.counted);
    quotients.iter().filter(|quotient| **quotient < 0.5).count()
}

/// Asserts that bars of a height and of some widths have the frequencies of elasticity in space.
fn assert_bars((name, material): (&str, (f64, f64, f64)), height: f64, widths: &[f64]) {
    let mut dishonest = 0;
    for &width in widths {
        let block = block([0.23, height, width], material);
        let solved = sheet(&block, "free", Wanted::Lowest(6), 0.001);
        let name = format!("{name} bar {height} m high and {width} m wide");
        dishonest += assert_near(&name, &solved, &truth(&block, FUNCTIONS, 6), 2.8e-4);
    }
    assert!(20 * dishonest <= 6 * widths.len(), "{dishonest} estimates are less than half the error");
}

/// Asserts that sheets clamped all round have the frequencies of elasticity in space.
fn assert_clamped(widths: &[f64]) {
    for &width in widths {
        let block = Block { is_clamped: true, ..block([1.0, 0.8, width], MATERIALS[0].1) };
        let truth = truth(&block, Functions { degrees: [20, 20, 9], layer: 0 }, 6);
        let solved = sheet(&block, "clamped", Wanted::Lowest(6), 0.001);
        let dishonest = assert_near(&format!("clamped sheet {width} m wide"), &solved, &truth, 5.2e-4);
        assert!(dishonest == 0, "{dishonest} of 6 estimates are less than half the error");
    }
}

#[test]
fn wide_bars_have_the_frequencies_of_elasticity_in_space() {
    assert_bars(MATERIALS[0], 0.02, &[0.02, 0.07]);
}

#[test]
#[ignore = "a minute: cargo test --release -p shape --test bodies sheets -- --ignored --nocapture"]
fn bars_of_any_width_have_the_frequencies_of_elasticity_in_space() {
    for material in MATERIALS {
        [0.02, 0.006].into_iter().for_each(|height| assert_bars(material, height, &[0.002, 0.02, 0.045, 0.07]));
    }
}

#[test]
#[ignore = "half a minute: cargo test --release -p shape --test bodies sheets -- --ignored --nocapture"]
fn sheets_that_bend_across_have_the_frequencies_of_elasticity_in_space() {
    for (size_m, poisson) in [([0.23, 0.02, 0.07], 0.45), ([0.23, 0.006, 0.2], 0.33), ([0.23, 0.1, 0.2], 0.4)] {
        let block = block(size_m, (2e9, poisson, 1200.0));
        let solved = sheet(&block, "free", Wanted::Lowest(12), 0.001);
        let truth = truth(&block, Functions { degrees: [18, 9, 17], layer: 0 }, 12);
        let dishonest = assert_near(&format!("{size_m:?} m, Poisson's ratio {poisson}"), &solved, &truth, 2e-4);
        assert!(dishonest == 0, "{dishonest} of 12 estimates are less than half the error");
    }
}

#[test]
fn clamped_sheets_have_the_frequencies_of_elasticity_in_space() {
    assert_clamped(&[0.1]);
}

#[test]
#[ignore = "half a minute: cargo test --release -p shape --test bodies sheets -- --ignored --nocapture"]
fn clamped_sheets_of_any_width_have_the_frequencies_of_elasticity_in_space() {
    assert_clamped(&[0.03, 0.3, 0.8]);
}

#[test]
fn wood_alike_in_all_directions_has_the_frequencies_of_an_isotropic_sheet() {
    let text = |moduli: &str| {
        format!(
            "format = 1\nname = \"bar\"\nshape = {{ kind = \"sheet\", polygon_m = [[0, 0], [0.23, 0], [0.23, 0.02], \
             [0, 0.02]], thickness_m = 0.06 }}\nmaterial = {{ density_kg_per_m3 = 800, {moduli}, poisson = 0.3, \
             grain_deg = 20, loss_factor = 0 }}\n"
        )
    };
    let plain = text("youngs_modulus_pa = 1e10").replace("grain_deg = 20, ", "");
    let wood = text("youngs_modulus_pa = [1e10, 1e10], shear_modulus_pa = 3.846153846153846e9");
    let [plain, wood] = [plain, wood].map(|text| solve_text(&text, None, Wanted::Lowest(6), 0.001).unwrap());
    for (plain, wood) in frequencies(&plain).iter().zip(frequencies(&wood)) {
        assert!((plain / wood - 1.0).abs() < 1e-9, "{plain} {wood}");
    }
    // The file does not tell how wood contracts across its grain: the estimate knows.
    let larger = wood.modes.iter().zip(&plain.modes).filter(|(wood, plain)| wood.error > plain.error).count();
    assert!(larger >= 5, "{larger} of 6");
}
