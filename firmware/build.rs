//! Gives the linker the board's memory map, builds the built-in kit's bytes from the shipped text, and sets the log level.

use std::error::Error;
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

    // The same bytes as `malleus kit build demo`: the `kit` crate reads the text and builds both.
    fs::write(out.join("built-in-kit.bin"), kit::open("demo")?.binary)?;
    println!("cargo::rerun-if-changed=../tables");

    // The log lines are part of what the image does: they do not depend on where cargo was called.
    println!("cargo::rerun-if-env-changed=DEFMT_LOG");
    if env::var_os("DEFMT_LOG").is_none() {
        println!("cargo::rustc-env=DEFMT_LOG=info");
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed={}", from.display());
    fs::copy(from, to).map_err(|error| format!("{}: {error}", from.display()))?;
    Ok(())
}
