//! Gives the linker the board's memory map, builds the kits in the images, and sets the log level.

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let firmware = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let memory = match env::var_os("CARGO_FEATURE_BLACKPILL_F411") {
        Some(_) => firmware.join("memory/blackpill-f411.x"),
        None => firmware.join("../memory.x"),
    };
    copy(&memory, &out.join("memory.x"))?;
    copy(&firmware.join("memory/sections.x"), &out.join("sections.x"))?;
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["-Tlink.x", "-Tsections.x", "-Tdefmt.x", "--nmagic"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }

    // `malleus kit build demo` writes these bytes too: both are built by the `kit` crate.
    fs::write(out.join("built-in-kit.bin"), kit::open("demo")?.binary)?;
    println!("cargo::rerun-if-changed=../tables");
    build_self_test_kit(&out)?;

    println!("cargo::rustc-env=GIT_REVISION={}", revision());

    // The image must not depend on the folder in which cargo was called, so the level is set here.
    println!("cargo::rerun-if-env-changed=DEFMT_LOG");
    if env::var_os("DEFMT_LOG").is_none() {
        println!("cargo::rustc-env=DEFMT_LOG=info");
    }
    Ok(())
}

/// Returns the short hash of the commit that is checked out, or `unknown` outside a git checkout.
fn revision() -> String {
    println!("cargo::rerun-if-changed=../.git/HEAD");
    println!("cargo::rerun-if-changed=../.git/logs/HEAD");
    let git = std::process::Command::new("git").args(["rev-parse", "--short=7", "HEAD"]).output();
    let hash = git.ok().filter(|git| git.status.success()).and_then(|git| String::from_utf8(git.stdout).ok());
    hash.map_or("unknown".to_owned(), |hash| hash.trim().to_owned())
}

/// Builds the kit that the self-test times: one object for each form of the modal bank and for each
/// number of gains, 1 and 2.
fn build_self_test_kit(out: &Path) -> Result<(), Box<dyn Error>> {
    const MODES: u32 = 240;
    // Lowest and highest frequency, in Hz, at which the bank takes each form at a sample rate of
    // 48 kHz (dsp-core/src/resonator/coefficient.rs).
    const FORMS: [(&str, f64, f64); 5] = [
        ("coupled", 60.0, 3_700.0),
        ("shifted 0", 3_900.0, 5_400.0),
        ("shifted 1", 5_600.0, 7_900.0),
        ("shifted 2", 8_200.0, 11_900.0),
        ("mirrored", 12_100.0, 20_000.0),
    ];
    let mut text = String::from("format = 1\nname = \"self-test\"\n");
    for (form, low_hz, high_hz) in FORMS {
        for (gains, cosine) in [("one gain", 0.0), ("two gains", 40.0)] {
            writeln!(text, "[[object]]\nname = \"{form} {gains}\"\nmodes = [")?;
            for mode in 0..MODES {
                let frequency_hz = low_hz + (high_hz - low_hz) * f64::from(mode) / f64::from(MODES - 1);
                writeln!(
                    text,
                    "{{ frequency_hz = {frequency_hz:.1}, decay_per_s = 1.4, gain_sine = 50.0, gain_cosine = {cosine:.1} }},"
                )?;
            }
            writeln!(text, "]")?;
        }
    }
    let path = out.join("self-test.toml");
    fs::write(&path, text)?;
    let path = path.to_str().ok_or("the target folder's name is not UTF-8")?;
    fs::write(out.join("self-test-kit.bin"), kit::open(path)?.binary)?;
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed={}", from.display());
    fs::copy(from, to).map_err(|error| format!("{}: {error}", from.display()))?;
    Ok(())
}
