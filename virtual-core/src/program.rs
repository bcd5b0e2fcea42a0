//! Builds thumb programs from inside a test: one cargo call with a target folder of its own.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, OnceLock, PoisonError};

use crate::error::BuildError;

const TARGET: &str = "thumbv7em-none-eabihf";

/// Builds a `no_std` binary crate, optimised, for thumbv7em-none-eabihf and gives the bytes of its ELF file.
///
/// The crate is a workspace of its own (an empty `[workspace]` table, its own `Cargo.lock`), and brings its link script by a build
/// script (`cargo:rustc-link-arg=-T...`), so that no flag has to come from outside. The objects go to
/// `thumb/<package>` in the target folder of the caller (`CARGO_TARGET_DIR`, or else the `target` folder that the running
/// program is in). Cargo's own lock serves when many test binaries ask at once; in one process each manifest is built once.
///
/// # Errors
/// [`BuildError`], with what cargo printed.
pub fn build(manifest: &Path) -> Result<Vec<u8>, BuildError> {
    let name = package_name(manifest)?;
    build_binary(manifest, &name, &[])
}

/// As [`build`], for one of the binaries of a crate, and with further arguments for cargo (`--features` and the like).
///
/// Programs of one crate share a target folder; a lock on a file in it keeps test binaries apart that build it with other arguments.
///
/// # Errors
/// As [`build`].
pub fn build_binary(manifest: &Path, binary: &str, arguments: &[&str]) -> Result<Vec<u8>, BuildError> {
    type Key = (PathBuf, String, Vec<String>);
    static BUILT: OnceLock<Mutex<HashMap<Key, Vec<u8>>>> = OnceLock::new();
    let mut built = BUILT.get_or_init(Mutex::default).lock().unwrap_or_else(PoisonError::into_inner);
    let words = arguments.iter().map(|&word| word.to_owned()).collect();
    let key = (manifest.to_owned(), binary.to_owned(), words);
    if let Some(elf) = built.get(&key) {
        return Ok(elf.clone());
    }
    let elf = run_cargo(manifest, binary, arguments)?;
    built.insert(key, elf.clone());
    Ok(elf)
}

fn run_cargo(manifest: &Path, binary: &str, arguments: &[&str]) -> Result<Vec<u8>, BuildError> {
    let folder = target_folder(manifest).join("thumb").join(package_name(manifest)?);
    let unlockable = |source| BuildError::Program { path: folder.clone(), source };
    std::fs::create_dir_all(&folder).map_err(unlockable)?;
    let lock = std::fs::File::create(folder.join("build.lock")).map_err(unlockable)?;
    lock.lock().map_err(unlockable)?;

    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["build", "--release", "--locked", "--target", TARGET, "--manifest-path"]).arg(manifest);
    cargo.arg("--target-dir").arg(&folder).args(["--bin", binary]).args(arguments);
    cargo.args(["--config", &remapping(manifest)]);
    // The flags, wrappers and profile of the outer cargo call are for the PC.
    for (variable, _) in std::env::vars_os() {
        let variable = variable.to_string_lossy();
        let for_the_pc = ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "RUSTC_WORKSPACE_WRAPPER", "CARGO_BUILD_TARGET"];
        let of_outer_package = ["CARGO_PKG_", "CARGO_MANIFEST_", "CARGO_PROFILE_", "CARGO_TARGET_", "CARGO_BUILD_"];
        if for_the_pc.contains(&&*variable) || of_outer_package.iter().any(|prefix| variable.starts_with(prefix)) {
            cargo.env_remove(&*variable);
        }
    }
    let output = cargo.output().map_err(|source| BuildError::Cargo { manifest: manifest.to_owned(), source })?;
    if !output.status.success() {
        let output = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(BuildError::Failed { manifest: manifest.to_owned(), output });
    }
    let path = folder.join(TARGET).join("release").join(binary);
    std::fs::read(&path).map_err(|source| BuildError::Program { path, source })
}

/// A cargo setting that keeps the place of the sources out of the program: messages that name a file would otherwise be longer or shorter, and
/// all that lies behind them in flash would move.
fn remapping(manifest: &Path) -> String {
    let crates = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let crates = crates.or_else(|| Some(std::env::home_dir()?.join(".cargo")));
    let package = manifest.parent().and_then(|folder| folder.canonicalize().ok());
    let project = package.as_deref().and_then(Path::parent).map(Path::to_owned);
    let folders = [(crates, "cargo"), (project, "project")];
    let flags = folders.iter().filter_map(|(folder, name)| {
        let folder = folder.as_ref()?.to_str()?;
        Some(format!("'--remap-path-prefix={folder}={name}'"))
    });
    format!("target.{TARGET}.rustflags=[{}]", flags.collect::<Vec<_>>().join(","))
}

/// The name of the package, which is also that of its only binary unless it says otherwise.
fn package_name(manifest: &Path) -> Result<String, BuildError> {
    let wrong = |reason: String| BuildError::Manifest { manifest: manifest.to_owned(), reason };
    let text = std::fs::read_to_string(manifest).map_err(|error| wrong(error.to_string()))?;
    let name = name_in(&text).ok_or_else(|| wrong("no name in a [package] table".to_owned()))?;
    Ok(name.to_owned())
}

/// The `name` of the `[package]` table.
fn name_in(manifest: &str) -> Option<&str> {
    let package = manifest.split("[package]").nth(1)?;
    let line = package
        .lines()
        .take_while(|line| !line.starts_with('['))
        .find(|line| line.split('=').next().is_some_and(|key| key.trim() == "name"))?;
    line.split('"').nth(1)
}

/// The target folder of the outer build: test binaries stand in `<target>/<profile>/deps`.
fn target_folder(manifest: &Path) -> PathBuf {
    if let Some(folder) = std::env::var_os("CARGO_TARGET_DIR") {
        let folder = PathBuf::from(folder);
        // Cargo reads a relative folder from where it was called; a test runs elsewhere and cannot know that place.
        if folder.is_absolute() {
            return folder;
        }
    }
    let program = std::env::current_exe().unwrap_or_default();
    let tagged = program.ancestors().find(|folder| folder.join("CACHEDIR.TAG").is_file());
    let beside_manifest = || manifest.parent().unwrap_or(Path::new(".")).join("target");
    tagged.map_or_else(beside_manifest, Path::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_package_name_is_read_from_its_table() {
        let manifest =
            "[workspace]\n\n[package]\nedition = \"2024\"\nname = \"kernels\"\n\n[[bin]]\nname = \"other\"\n";
        assert_eq!(name_in(manifest), Some("kernels"));
        assert_eq!(name_in("[dependencies]\nname = \"x\"\n"), None);
    }

    #[test]
    fn a_missing_manifest_is_named() {
        let error = build(Path::new("no/such/Cargo.toml")).unwrap_err();
        assert!(error.to_string().contains("no/such/Cargo.toml"), "{error}");
    }
}
