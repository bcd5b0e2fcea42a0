//! Velocity and pressure of hinged rectangles and clamped discs against their shapes.

use std::f64::consts::{PI, TAU};

use shape::gain::{Gain, SPEED_OF_SOUND_M_PER_S};
use shape::solve::Wanted;

use crate::truth::bessel::{clamped_disc_modes, clamped_disc_shape};
use crate::truth::line::gauss;
use crate::{DISC, solve_text};

/// Density of air, kg/m³.
const AIR: f64 = 1.204;

/// Text of a thin plate that is struck at one place; `outline` are its keys.
fn struck(outline: &str, edge: &str, at: [f64; 2], loss: f64, sound: &str) -> String {
    format!(
        "format = 1\nname = \"plate\"\nshape = {{ kind = \"plate\", {outline}, thickness_m = 0.001 }}\n\
         material = {{ density_kg_per_m3 = 8000, youngs_modulus_pa = 200e9, poisson = 0.3, loss_factor = {loss} }}\n\
         support = {{ edge = \"{edge}\" }}\nstrike = {{ path_m = [{at:?}], positions = 1 }}\nsound = {{ {sound} }}\n"
    )
}

/// Waves of the modes of a hinged rectangle, 1.3 m by 1 m, in order.
fn waves() -> Vec<[f64; 2]> {
    let waves = (1..9).flat_map(|m| (1..9).map(move |n| [f64::from(m), f64::from(n)]));
    let mut waves: Vec<[f64; 2]> = waves.collect();
    let square = |[m, n]: [f64; 2]| (m / 1.3).powi(2) + n * n;
    waves.sort_by(|&a, &b| square(a).total_cmp(&square(b)));
    waves
}

/// Shape of unit modal mass of a hinged rectangle of steel 1 mm thick.
fn sines([m, n]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    (m * PI * x / 1.3).sin() * (n * PI * y).sin() * 2.0 / (8000.0_f64 * 0.001 * 1.3).sqrt()
}

/// Gain of a pressure by the integral of shape times e^(-s delay) by distance, real and imaginary,
/// with s = iω - d; and by the shape at the strike.
fn pressure(at_strike: f64, integral: [f64; 2], omega: f64, decay: f64) -> Gain {
    let product = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
    let moves = product([-decay, omega], [1.0, decay / omega]);
    let [real, imaginary] = product(moves, integral).map(|part| part * at_strike * AIR / TAU);
    Gain { cosine: real, sine: -imaginary }
}

/// Difference of two gains as a share of the second one's size.
fn apart(found: Gain, expected: Gain) -> f64 {
    (found.sine - expected.sine).hypot(found.cosine - expected.cosine) / expected.sine.hypot(expected.cosine)
}

#[test]
fn pressure_near_a_hinged_rectangle_is_the_integral_of_its_sines() {
    let (at, heard, loss) = ([0.37, 0.41], [0.5, 0.3, 0.4], 0.02);
    let outline = "polygon_m = [[0, 0], [1.3, 0], [1.3, 1], [0, 1]]";
    let text = struck(outline, "hinged", at, loss, &format!("readout = \"pressure\", at_m = {heard:?}"));
    let solved = solve_text(&text, None, Wanted::Lowest(12), 0.001).unwrap();
    let mut worst = 0.0_f64;
    for (mode, waves) in solved.modes.iter().zip(waves()) {
        let (omega, decay) = (TAU * mode.frequency_hz, mode.decay_per_s);
        let mut integral = [0.0; 2];
        for [x, by_x] in gauss(60) {
            for [y, by_y] in gauss(60) {
                let far = (1.3 * x - heard[0]).hypot(y - heard[1]).hypot(heard[2]);
                let delay = (far - heard[2]) / SPEED_OF_SOUND_M_PER_S;
                let size = 1.3 * by_x * by_y * sines(waves, [1.3 * x, y]) / far * (decay * delay).exp();
                integral[0] += size * (omega * delay).cos();
                integral[1] -= size * (omega * delay).sin();
            }
        }
        let expected = pressure(sines(waves, at), integral, omega, decay);
        worst = worst.max(apart(mode.gains[0], expected));
    }
    println!("worst {:.4} % of 12 modes", 100.0 * worst);
    assert!(worst < 1.2e-3, "{worst}");
}

#[test]
fn pressure_far_from_a_hinged_rectangle_has_its_closed_form() {
    // Wallace, Radiation resistance of a rectangular panel (1972).
    let (at, far) = ([0.37, 0.41], 2000.0_f64);
    let way = [0.48, 0.36, 0.8];
    let heard = way.map(|part| far * part);
    let outline = "polygon_m = [[0, 0], [1.3, 0], [1.3, 1], [0, 1]]";
    let text = struck(outline, "hinged", at, 0.0, &format!("readout = \"pressure\", at_m = {heard:?}"));
    let solved = solve_text(&text, None, Wanted::Lowest(12), 0.001).unwrap();
    let sizes = solved.modes.iter().zip(waves()).map(|(mode, waves)| {
        let omega = TAU * mode.frequency_hz;
        let along = |axis: usize, length: f64| {
            let phase = omega / SPEED_OF_SOUND_M_PER_S * way[axis] * length;
            let sign = if waves[axis] % 2.0 == 0.0 { 1.0 } else { -1.0 };
            let ends = (2.0_f64 - 2.0 * sign * phase.cos()).sqrt();
            length * ends / (waves[axis] * PI * ((phase / (waves[axis] * PI)).powi(2) - 1.0).abs())
        };
        let most = 2.0 / (8000.0_f64 * 0.001 * 1.3).sqrt();
        let expected = sines(waves, at).abs() * omega * AIR / (TAU * far) * most * along(0, 1.3) * along(1, 1.0);
        (mode.gains[0].sine.hypot(mode.gains[0].cosine), expected)
    });
    let worst = sizes.map(|(found, expected)| (found / expected - 1.0).abs()).fold(0.0, f64::max);
    println!("worst {:.4} % of 12 modes", 100.0 * worst);
    assert!(worst < 1.6e-3, "{worst}");
}

/// Factor of a clamped disc's shape, of radius 1 m, for unit modal mass.
fn unit((waves, number): (u32, f64)) -> f64 {
    let square = |[r, part]: [f64; 2]| part * r * clamped_disc_shape((waves, number), r).powi(2);
    let round = if waves == 0 { TAU } else { PI };
    (8000.0 * 0.001 * round * gauss(60).into_iter().map(square).sum::<f64>()).sqrt().recip()
}

#[test]
fn pairs_of_a_clamped_disc_sum_to_cosines_of_the_angle() {
    // The drawing's middle is at (2, -2).
    let place = |r: f64, angle: f64| [2.0 + r * angle.cos(), -2.0 + r * angle.sin()];
    let outline = "outline = \"disc.svg\", unit_m = 1";
    {
        let (r, angle) = (0.5, 1.3);
        let sound = format!("readout = \"velocity\", at_m = {:?}", place(r, angle));
        let text = struck(outline, "clamped", place(0.6, 0.1), 0.0, &sound);
        let solved = solve_text(&text, Some(DISC), Wanted::Lowest(10), 0.01).unwrap();
        let mut found = solved.modes.iter().map(|mode| mode.gains[0].cosine);
        let mut worst = 0.0_f64;
        for mode in clamped_disc_modes(9.5) {
            let Some(first) = found.next() else { break };
            let sum = first + if mode.0 > 0 { found.next().unwrap() } else { 0.0 };
            let size = |r: f64| unit(mode) * clamped_disc_shape(mode, r);
            let most = (1..100).map(|r| size(f64::from(r) / 100.0).abs()).fold(0.0, f64::max);
            let shape = size(r) * (f64::from(mode.0) * (angle - 0.1)).cos();
            if shape.abs() > 0.1 * most && size(0.6).abs() > 0.1 * most {
                worst = worst.max((sum / (size(0.6) * shape) - 1.0).abs());
            }
        }
        println!("worst {:.4} %", 100.0 * worst);
        assert!(worst < 4e-5, "{worst}");
    }
}

#[test]
fn pressure_on_the_axis_of_a_clamped_disc_is_that_of_its_bessel_functions() {
    let (height, loss) = (0.7, 0.02);
    let sound = format!("readout = \"pressure\", at_m = [2, -2, {height}]");
    let text = struck("outline = \"disc.svg\", unit_m = 1", "clamped", [2.3, -2.2], loss, &sound);
    let solved = solve_text(&text, Some(DISC), Wanted::Lowest(10), 0.01).unwrap();
    let mut modes = solved.modes.iter();
    let (mut worst, mut count, mut most) = (0.0_f64, 0, 0.0_f64);
    for truth in clamped_disc_modes(9.5) {
        let Some(mode) = modes.next() else { break };
        let size = |gain: shape::gain::Gain| gain.sine.hypot(gain.cosine);
        if truth.0 > 0 {
            // Both of a pair have no pressure on the axis.
            let silent = [Some(mode), modes.next()].into_iter().flatten();
            assert!(silent.map(|mode| size(mode.gains[0])).all(|size| size < 1e-3 * most), "{truth:?}");
            continue;
        }
        let (omega, decay) = (TAU * mode.frequency_hz, mode.decay_per_s);
        let mut integral = [0.0; 2];
        for [r, part] in gauss(80) {
            let far = r.hypot(height);
            let delay = (far - height) / SPEED_OF_SOUND_M_PER_S;
            let shape = unit(truth) * clamped_disc_shape(truth, r);
            let size = TAU * r * part * shape / far * (decay * delay).exp();
            integral[0] += size * (omega * delay).cos();
            integral[1] -= size * (omega * delay).sin();
        }
        let struck = unit(truth) * clamped_disc_shape(truth, 0.3_f64.hypot(0.2));
        let expected = pressure(struck, integral, omega, decay);
        most = most.max(size(expected));
        worst = worst.max(apart(mode.gains[0], expected));
        count += 1;
    }
    println!("worst {:.4} % of {count} modes", 100.0 * worst);
    assert!(count == 2 && worst < 1.2e-5, "{worst} of {count}");
}

#[test]
fn gains_of_a_hinged_rectangle_are_those_of_its_sines() {
    let text = "format = 1\nname = \"plate\"\n\
        shape = { kind = \"plate\", polygon_m = [[0, 0], [1.3, 0], [1.3, 1], [0, 1]], thickness_m = 0.001 }\n\
        material = { density_kg_per_m3 = 8000, youngs_modulus_pa = 200e9, poisson = 0.3, loss_factor = 0.01 }\n\
        support = { edge = \"hinged\" }\n\
        strike = { path_m = [[0.2, 0.3], [0.9, 0.8]], positions = 5 }\n\
        sound = { readout = \"velocity\", at_m = [0.31, 0.27] }\n";
    let solved = solve_text(text, None, Wanted::Lowest(12), 0.001).unwrap();
    let mass: f64 = 8000.0 * 0.001 * 1.3;
    let mut worst = 0.0_f64;
    for (mode, waves) in solved.modes.iter().zip(waves()) {
        for (position, gain) in mode.gains.iter().enumerate() {
            let share = position as f64 / 4.0;
            let at = [0.2 + 0.7 * share, 0.3 + 0.5 * share];
            let expected = sines(waves, at) * sines(waves, [0.31, 0.27]);
            let largest = 4.0 / mass;
            if expected.abs() > 0.1 * largest {
                worst = worst.max((gain.cosine / expected - 1.0).abs());
            }
            let ratio = mode.decay_per_s / (TAU * mode.frequency_hz);
            assert!((gain.sine + gain.cosine * ratio).abs() <= 1e-12 * largest, "{gain:?}");
        }
    }
    println!("worst {:.4} %", 100.0 * worst);
    assert!(worst < 3e-3, "{worst}");
}

#[test]
fn a_slanted_strike_gives_a_plate_the_part_across_it() {
    let outline = "polygon_m = [[0, 0], [1.3, 0], [1.3, 1], [0, 1]]";
    let sound = "readout = \"velocity\", at_m = [0.31, 0.27]";
    let straight = struck(outline, "hinged", [0.4, 0.6], 0.01, sound);
    // The third of 2, 1 and 2 is two thirds of their length.
    let slanted = straight.replace("positions = 1", "positions = 1, direction = [2, 1, 2]");
    let [straight, slanted] =
        [straight, slanted].map(|text| solve_text(&text, None, Wanted::Lowest(4), 0.01).unwrap().modes);
    for (straight, slanted) in straight.iter().zip(&slanted) {
        let [straight, slanted] = [straight, slanted].map(|mode| mode.gains[0].cosine);
        assert!((slanted - straight * 2.0 / 3.0).abs() <= 1e-12 * straight.abs(), "{straight} {slanted}");
    }
    let flat = struck(outline, "hinged", [0.4, 0.6], 0.01, sound).replace("positions = 1", "direction = [1, 0]");
    let fault = solve_text(&flat, None, Wanted::Lowest(4), 0.01).unwrap_err().to_string();
    assert!(fault.contains("a direction has two numbers"), "{fault}");
}
