//! Builds of thumb programs from inside a test: one cargo call with a target folder of its own.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, OnceLock, PoisonError};

use crate::error::BuildError;

const TARGET: &str = "thumbv7em-none-eabihf";

/// Builds a `no_std` binary crate, optimised, for thumbv7em-none-eabihf, and returns its ELF file.
///
/// The crate must have a `Cargo.lock` of its own (an empty `[workspace]` table makes it a workspace
/// of its own). Its build script must name the link script (`cargo:rustc-link-arg=-T...`), so that
/// no flag has to come from outside.
///
/// The objects go to `thumb/<folder>` in the target folder of the caller: `CARGO_TARGET_DIR`, or
/// else the `target` folder that the running program is in. `<folder>` is the name of the package,
/// or for a workspace the folder of the manifest. A process builds each program once. A lock on a
/// file keeps processes apart that build in one folder.
///
/// # Errors
/// [`BuildError`] if the crate does not build; it holds the output of cargo.
pub fn build(manifest: &Path) -> Result<Vec<u8>, BuildError> {
    let name = package_name(manifest)?;
    build_binary(manifest, &name, &[])
}

/// Builds one of the binaries of a crate as [`build`] does, with further arguments for cargo such
/// as `--features`, and returns its ELF file.
///
/// # Errors
/// [`BuildError`] if the crate does not build; it holds the output of cargo.
pub fn build_binary(manifest: &Path, binary: &str, arguments: &[&str]) -> Result<Vec<u8>, BuildError> {
    build_one_of(manifest, &[binary], binary, "release", arguments)
}

/// Builds several binaries of a crate or workspace in one call of cargo, by a profile of its
/// manifest, and returns the ELF file of one of them, `binary`.
///
/// A later call that asks for another of the binaries does not build anew.
///
/// # Errors
/// [`BuildError`] if the crate does not build, with the output of cargo, or if `binary` is not one
/// of `binaries`.
pub fn build_one_of(
    manifest: &Path,
    binaries: &[&str],
    binary: &str,
    profile: &str,
    arguments: &[&str],
) -> Result<Vec<u8>, BuildError> {
    type Key = (PathBuf, String, Vec<String>);
    static BUILT: OnceLock<Mutex<HashMap<Key, Vec<u8>>>> = OnceLock::new();
    let mut built = BUILT.get_or_init(Mutex::default).lock().unwrap_or_else(PoisonError::into_inner);
    let words: Vec<_> = ["--profile", profile].iter().chain(arguments).map(|&word| word.to_owned()).collect();
    let key = |binary: &str| (manifest.to_owned(), binary.to_owned(), words.clone());
    if let Some(elf) = built.get(&key(binary)) {
        return Ok(elf.clone());
    }
    let elves = run_cargo(manifest, binaries, profile, &words)?;
    built.extend(binaries.iter().map(|binary| key(binary)).zip(elves));
    built.get(&key(binary)).cloned().ok_or_else(|| BuildError::Manifest {
        manifest: manifest.to_owned(),
        reason: format!("{binary:?} is none of the binaries to build, {binaries:?}"),
    })
}

/// Builds binaries by a call of cargo and returns their ELF files, in their order.
fn run_cargo(
    manifest: &Path,
    binaries: &[&str],
    profile: &str,
    arguments: &[String],
) -> Result<Vec<Vec<u8>>, BuildError> {
    let folder = target_folder(manifest).join("thumb").join(folder_name(manifest)?);
    let unlockable = |source| BuildError::Program { path: folder.clone(), source };
    std::fs::create_dir_all(&folder).map_err(unlockable)?;
    let folder = folder.canonicalize().map_err(unlockable)?;
    let manifest =
        manifest.canonicalize().map_err(|source| BuildError::Cargo { manifest: manifest.to_owned(), source })?;
    let lock = std::fs::File::create(folder.join("build.lock")).map_err(unlockable)?;
    lock.lock().map_err(unlockable)?;

    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["build", "--locked", "--target", TARGET, "--manifest-path"]).arg(&manifest);
    cargo.arg("--target-dir").arg(&folder).args(arguments);
    // The program's own `.cargo/config.toml` applies, as it does to one who builds it there.
    if let Some(package) = manifest.parent() {
        cargo.current_dir(package);
    }
    cargo.args(binaries.iter().flat_map(|binary| ["--bin", binary]));
    cargo.args(["--config", &remapping(&manifest)]);
    // Flags, wrappers and profile of the outer cargo call are for the PC and must not apply here.
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
        return Err(BuildError::Failed { manifest, output });
    }
    let built = folder.join(TARGET).join(profile);
    let read = |binary: &&str| {
        let path = built.join(binary);
        std::fs::read(&path).map_err(|source| BuildError::Program { path, source })
    };
    binaries.iter().map(read).collect()
}

/// Returns the name of the folder that a manifest's objects go to.
fn folder_name(manifest: &Path) -> Result<String, BuildError> {
    package_name(manifest).or_else(|error| {
        let folder = manifest.parent().and_then(Path::file_name).filter(|_| manifest.is_file());
        folder.map(|name| name.to_string_lossy().into_owned()).ok_or(error)
    })
}

/// Returns a cargo setting that keeps the folders of the sources out of the program.
///
/// Messages that name a file would otherwise differ in length from folder to folder, and move all
/// that lies after them in flash.
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

/// Returns the name of the package, which is also that of its only binary unless it says otherwise.
fn package_name(manifest: &Path) -> Result<String, BuildError> {
    let wrong = |reason: String| BuildError::Manifest { manifest: manifest.to_owned(), reason };
    let text = std::fs::read_to_string(manifest).map_err(|error| wrong(error.to_string()))?;
    let name = name_in(&text).ok_or_else(|| wrong("no name in a [package] table".to_owned()))?;
    Ok(name.to_owned())
}

/// Returns the `name` of the `[package]` table.
fn name_in(manifest: &str) -> Option<&str> {
    let package = manifest.split("[package]").nth(1)?;
    let line = package
        .lines()
        .take_while(|line| !line.starts_with('['))
        .find(|line| line.split('=').next().is_some_and(|key| key.trim() == "name"))?;
    line.split('"').nth(1)
}

/// Returns the target folder of the outer build, in whose `<profile>/deps` the test binaries lie.
fn target_folder(manifest: &Path) -> PathBuf {
    if let Some(folder) = std::env::var_os("CARGO_TARGET_DIR") {
        let folder = PathBuf::from(folder);
        // Cargo takes a relative folder from the folder in which it was called, which a test cannot
        // know.
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
