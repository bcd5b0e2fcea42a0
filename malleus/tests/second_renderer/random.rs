//! Noise that the pages give only by its expected power: energies of bands against the formulas.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};

use crate::program::{file, play};
use crate::text::{self, number, numbers, tables};
use crate::{events, mix};

const FS: f64 = 48000.0;

fn fft(signal: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let half = signal.len() / 2;
    if half == 0 {
        return signal.to_vec();
    }
    let [even, odd] = [0, 1].map(|first| fft(&signal.iter().skip(first).step_by(2).copied().collect::<Vec<_>>()));
    let mut spectrum = vec![[0.0; 2]; signal.len()];
    for k in 0..half {
        let (sin, cos) = (-PI * k as f64 / half as f64).sin_cos();
        let turned = [odd[k][0] * cos - odd[k][1] * sin, odd[k][0] * sin + odd[k][1] * cos];
        spectrum[k] = [even[k][0] + turned[0], even[k][1] + turned[1]];
        spectrum[k + half] = [even[k][0] - turned[0], even[k][1] - turned[1]];
    }
    spectrum
}

/// Energies of one side within bands in Hz, as sums of squared samples.
fn energies(samples: &[[i32; 2]], side: usize, bands: &[[f64; 2]]) -> Vec<f64> {
    let mut signal = samples.iter().map(|sides| [f64::from(sides[side]) / 8_388_608.0, 0.0]).collect::<Vec<_>>();
    signal.resize(samples.len().next_power_of_two(), [0.0; 2]);
    let spectrum = fft(&signal);
    let line = FS / signal.len() as f64;
    let power = |[re, im]: [f64; 2]| 2.0 * (re * re + im * im) / signal.len() as f64;
    let within = |band: &[f64; 2]| (band[0] / line).ceil() as usize..(band[1] / line).ceil() as usize;
    bands.iter().map(|band| spectrum[within(band)].iter().copied().map(power).sum()).collect()
}

fn assert_near(what: &str, measured: f64, expected: f64, tolerance_db: f64) {
    let error = 10.0 * (measured / expected).log10();
    println!("{what}: {error:+.2} dB");
    assert!(error.abs() < tolerance_db, "{what}: {error:+.2} dB");
}

/// Writes a file of events with these lines.
fn write(folder: &Path, lines: &str) -> PathBuf {
    let path = folder.join("events.csv");
    fs::write(&path, format!("time_s,pad,velocity\n{lines}")).unwrap();
    path
}

#[test]
fn reference_room_has_the_energy_of_the_page_in_each_band() {
    let folder = tempfile::tempdir().unwrap();
    let (kit, events) = (file("random.toml"), write(folder.path(), "0,click,1\n"));
    let (wet, _) = play(&kit, &format!("--strikes {} --reference --tail 2", events.display()));
    let dry = mix::render(&kit, &events::read(&events, FS), None, FS, wet.len());
    let rooms = tables(&text::parse(&kit), "room");
    let edges = rooms.iter().map(|room| number(room, "from_hz", 0.0)).chain([FS / 2.0]).collect::<Vec<_>>();
    let bands = edges.windows(2).map(|edges| [edges[0] * 1.05, edges[1] / 1.05]).collect::<Vec<_>>();
    let [left, right] = [0, 1].map(|side| energies(&dry, side, &bands));
    let (begin, end) = (0.005, 0.6);
    for side in [0, 1] {
        let answer = &wet[(begin * FS) as usize..(end * FS) as usize];
        for (band, energy) in energies(answer, side, &bands).into_iter().enumerate() {
            let (g, d) = (number(&rooms[band], "gain", 0.0), number(&rooms[band], "decay_per_s", 0.0));
            let part = g * g / (2.0 * d) * ((-2.0 * d * begin).exp() - (-2.0 * d * end).exp());
            assert_near(
                &format!("room, side {side}, band {band}"),
                energy,
                part * (left[band] + right[band]) / 2.0,
                1.5,
            );
        }
    }
}

/// Writes the kit without its room.
fn dry_kit(folder: &Path) -> PathBuf {
    let path = folder.join("dry.toml");
    let all = fs::read_to_string(file("random.toml")).unwrap();
    fs::write(&path, all.split_once("[[room]]").unwrap().0).unwrap();
    path
}

#[test]
fn instrument_residual_has_the_energy_of_the_page_in_each_band() {
    let folder = tempfile::tempdir().unwrap();
    let velocity = 0.9_f64;
    let lines = (0..24).map(|k| format!("{},hiss,{velocity}\n", 0.3 + 0.41 * f64::from(k))).collect::<String>();
    let (kit, events) = (dry_kit(folder.path()), write(folder.path(), &lines));
    let (sound, _) = play(&kit, &format!("--strikes {} --tail 0.5", events.display()));
    let object = &tables(&text::parse(&kit), "object")[1];
    let residual = object["residual"].as_table().unwrap();
    let [edges, weights, decays] = ["edges_hz", "weight", "decay_db_per_s"].map(|key| numbers(&residual[key]));
    let bands = edges.windows(2).map(|edges| [edges[0], edges[1]]).collect::<Vec<_>>();
    let force = 40.0 * velocity.powf(1.2) / number(object, "reference_force", 1.0);
    for (band, energy) in energies(&sound, 0, &bands).into_iter().enumerate() {
        let of_one = (weights[band] * force).powi(2) * 10.0 / (decays[band] * 10f64.ln());
        assert_near(&format!("residual, band {band}"), energy / FS, 24.0 * of_one, 1.0);
    }
}

#[test]
fn instrument_background_has_the_power_of_the_page_in_each_band() {
    let folder = tempfile::tempdir().unwrap();
    let (kit, events) = (dry_kit(folder.path()), write(folder.path(), "0,hiss,0\n"));
    let (sound, _) = play(&kit, &format!("--strikes {} --tail 6", events.display()));
    let kept = &sound[24000..264_000];
    let background = text::parse(&kit)["background"].as_table().unwrap().clone();
    let [edges, weights] = ["edges_hz", "weight"].map(|key| numbers(&background[key]));
    let bands = edges.windows(2).map(|edges| [edges[0], edges[1]]).collect::<Vec<_>>();
    for side in [0, 1] {
        for (band, energy) in energies(kept, side, &bands).into_iter().enumerate() {
            let power = weights[band].powi(2) / 2.0;
            assert_near(&format!("background, side {side}, band {band}"), energy / 240_000.0, power, 1.0);
        }
    }
}
