//! A second renderer, written from docs/kit-format.md and docs/noise.md alone, against
//! `malleus play --reference`.
//!
//! Three kinds of content are told apart:
//!
//! - All that the pages determine is compared sample by sample, with an SNR of 110 dB and more:
//!   each pad alone and all together (every_key.toml, every_key.csv), at 48 and at 44.1 kHz, and a
//!   direct force. When this was written, all 24-bit samples were equal.
//! - Noise that the pages give only by its power is compared by energy ([`random`], random.toml):
//!   the room with `--reference`, and a residual and a background, which `--reference` leaves out,
//!   with the instrument.
//! - Triggers, which only boards have, are not compared. every_key.toml has them.
//!
//! The test uses nothing of the workspace's crates but the program. Each file here stands for a
//! section of the pages.

mod acceleration;
mod biquads;
mod contact;
mod events;
mod filter;
mod keys;
mod mix;
mod modes;
mod noise;
mod program;
mod random;
mod text;

use std::fs;
use std::path::{Path, PathBuf};

use program::{file, play};

/// SNR of a signal in dB; infinite if both signals are equal.
fn snr(signal: &[[i32; 2]], other: &[[i32; 2]]) -> f64 {
    let energy =
        |difference: &dyn Fn(usize) -> i32, n: usize| (0..n).map(|k| f64::from(difference(k)).powi(2)).sum::<f64>();
    let (a, b) = (signal.as_flattened(), other.as_flattened());
    assert_eq!(a.len(), b.len());
    10.0 * (energy(&|k| a[k], a.len()) / energy(&|k| a[k] - b[k], a.len())).log10()
}

fn peak(samples: &[[i32; 2]]) -> i32 {
    samples.as_flattened().iter().map(|sample| sample.abs()).max().unwrap()
}

/// File with the events of every_key.csv, of one pad or of all.
fn events_of(pad: Option<&str>, folder: &Path) -> PathBuf {
    let all = fs::read_to_string(file("every_key.csv")).unwrap();
    let (header, lines) = all.split_once("striker,action\n").unwrap();
    let kept =
        lines.lines().filter(|line| pad.is_none_or(|pad| line.split(',').nth(1).unwrap().trim_matches('"') == pad));
    let path = folder.join("events.csv");
    fs::write(&path, format!("{header}striker,action\n{}\n", kept.collect::<Vec<_>>().join("\n"))).unwrap();
    path
}

/// Asserts that both renderers agree on every pad and on all together at a sample rate.
fn agrees(rate: u32) {
    let folder = tempfile::tempdir().unwrap();
    let kit = file("every_key.toml");
    let pads = [Some("bar"), Some("plate"), Some("breath"), Some("tube"), Some("hiss"), Some("drone"), None];
    let (mut worst, mut loud) = (f64::INFINITY, true);
    for pad in pads {
        let events = events_of(pad, folder.path());
        let (reference, message) =
            play(&kit, &format!("--strikes {} --reference --tail 1 --rate {rate}", events.display()));
        assert!(message.contains("residual") && message.contains("background"), "nothing is said of: {message}");
        let second = mix::render(&kit, &events::read(&events, f64::from(rate)), None, f64::from(rate), reference.len());
        let (peak, snr) = (f64::from(peak(&reference)) / 8_388_608.0, snr(&reference, &second));
        println!("{rate} Hz, {}: peak {:.1} dBFS, SNR {snr:.1} dB", pad.unwrap_or("all"), 20.0 * peak.log10());
        if let Some(n) =
            reference.iter().zip(&second).position(|(a, b)| (0..2).any(|side| a[side].abs_diff(b[side]) > 8))
        {
            println!(
                "  the first difference of more than 8 steps is at sample {n}, {:.4} s",
                n as f64 / f64::from(rate)
            );
        }
        loud &= (0.1..0.999).contains(&peak);
        worst = worst.min(snr);
    }
    assert!(loud, "each peak is to lie between -20 and 0 dBFS");
    assert!(worst >= 110.0, "{worst:.1} dB");
}

#[test]
fn second_renderer_agrees_with_the_reference_at_48000_hz() {
    agrees(48000);
}

#[test]
fn second_renderer_agrees_with_the_reference_at_44100_hz() {
    agrees(44100);
}

#[test]
fn second_renderer_agrees_with_the_reference_under_a_direct_force() {
    let folder = tempfile::tempdir().unwrap();
    let wave = folder.path().join("force.wav");
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 48000,
        bits_per_sample: 24,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(&wave, spec).unwrap();
    let mut generator = noise::Generator::new(1, 2);
    let samples =
        (0..20000).map(|n| (generator.draw() * 4e6 + 2e6 * (f64::from(n) * 0.02).sin()) as i32).collect::<Vec<_>>();
    samples.iter().for_each(|sample| writer.write_sample(*sample).unwrap());
    writer.finalize().unwrap();
    let kit = file("every_key.toml");
    let force = samples.iter().map(|sample| f64::from(*sample) / 8_388_608.0).collect::<Vec<_>>();
    for pad in ["bar", "plate", "tube"] {
        let (reference, _) = play(&kit, &format!("--direct {} --pad {pad} --reference --tail 1", wave.display()));
        let second = mix::render(&kit, &[], Some((pad, &force)), 48000.0, reference.len());
        let (peak, snr) = (f64::from(peak(&reference)) / 8_388_608.0, snr(&reference, &second));
        println!("direct force on {pad}: peak {:.1} dBFS, SNR {snr:.1} dB", 20.0 * peak.log10());
        assert!((0.05..0.999).contains(&peak) && snr >= 110.0, "{pad}: peak {peak}, SNR {snr:.1} dB");
    }
}
