//! Maps as their user makes and plays them: `malleus surface --map`, a kit, and `malleus play
//! --motion`.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use crate::play::{floats, runs};

/// Writes a map with a row a line, in steps of 10 µm, and a kit of one pad with its table.
fn write_map_and_kit(folder: &Path, [columns, rows]: [u32; 2], height_m: impl Fn(f64, f64) -> f64) {
    let row = |row: u32| {
        let heights =
            (0..columns).map(|column| format!("{:e}", height_m(f64::from(column) * 1e-5, f64::from(row) * 1e-5)));
        heights.collect::<Vec<_>>().join(",")
    };
    fs::write(folder.join("map.csv"), (0..rows).map(row).collect::<Vec<_>>().join("\n")).unwrap();
    runs(folder, "surface map.csv --step 1e-5 --map -o map.toml");
    let kit = "format = 1\nname = \"test\"\ninclude = [\"map.toml\"]\n[[object]]\nname = \"bar\"\nsurface = \"map\"\n\
         modes = [{ frequency_hz = 440.0, decay_per_s = 30.0, gain_sine = 300.0 }]\n[[striker]]\nname = \"stick\"\n\
         peak_force = 1.0\ncontact_time_s = 0.0005\n[striker.scrape]\nmass_kg = 0.01\n[[pad]]\nname = \"bar\"\n\
         object = \"bar\"\nstrikers = [\"stick\"]\nlevel_db = -30\n";
    fs::write(folder.join("kit.toml"), kit).unwrap();
}

/// Force in newtons in the middle of a stroke of 0.1 m/s in a direction.
fn stroke(folder: &Path, [c, s]: [f64; 2]) -> Vec<f64> {
    let line = |n: u32| {
        let (time_s, way_m) = (f64::from(n) * 0.01, f64::from(n) * 0.001);
        format!("{time_s},bar,scrape,stick,{},{},1.0\n", way_m * c, way_m * s)
    };
    let motion: String = (0..50).map(line).collect();
    let text = format!("time_s,pad,action,striker,x_m,y_m,normal_n\n{motion}0.5,bar,lift,,,,\n");
    fs::write(folder.join("m.csv"), text).unwrap();
    runs(folder, "play --kit kit.toml --motion m.csv --force f.wav -o out.wav");
    let [force_n, ..] = floats(&folder.join("f.wav"));
    force_n[4_800..19_200].to_vec()
}

fn rms(force_n: &[f64]) -> f64 {
    (force_n.iter().map(|x| x * x).sum::<f64>() / force_n.len() as f64).sqrt()
}

/// Power of a force within 100 Hz about a frequency.
fn power_about(force_n: &[f64], frequency_hz: f64) -> f64 {
    let power = |hz: f64| {
        let angle = |n: usize| TAU * hz * n as f64 / 48_000.0;
        let sum = |wave: fn(f64) -> f64| force_n.iter().enumerate().map(|(n, x)| x * wave(angle(n))).sum::<f64>();
        sum(f64::sin).powi(2) + sum(f64::cos).powi(2)
    };
    (-25..=25).map(|step| power(frequency_hz + 4.0 * f64::from(step))).sum()
}

#[test]
fn grooves_are_silent_along_and_sound_at_the_pitch_at_which_they_are_crossed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_map_and_kit(folder, [300, 280], |_, y| 1e-6 * (TAU * y / 8e-5).sin());
    let [along, across, turned] = [[1.0, 0.0], [0.0, 1.0], [0.8, -0.6]].map(|direction| stroke(folder, direction));
    println!("grooves: {:.2e} N along, {:.2e} N across, {:.2e} N turned", rms(&along), rms(&across), rms(&turned));
    assert!(rms(&across) > 0.01 && rms(&along) < 0.003 * rms(&across));
    // 0.1 m/s over 80 µm, and 0.6 of it. Each line is 200 Hz wide, since the path hops every
    // 0.6 mm.
    for (force_n, crossed_hz, other_hz) in [(&across, 1250.0, 750.0), (&turned, 750.0, 1250.0)] {
        assert!(power_about(force_n, crossed_hz) > 10.0 * power_about(force_n, other_hz), "{crossed_hz} Hz");
    }
}

#[test]
fn maps_of_any_shape_fit_a_kit() {
    let folder = tempfile::tempdir().unwrap();
    for shape in [[256, 60], [700, 25], [260, 500]] {
        write_map_and_kit(folder.path(), shape, |x, y| 1e-6 * (TAU * (x / 7e-5 + y / 9e-5)).sin());
        let rms_n = rms(&stroke(folder.path(), [0.8, 0.6]));
        assert!(rms_n > 0.01, "{shape:?}: {rms_n:.2e} N");
    }
}
