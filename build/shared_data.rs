//! Build script of each crate whose tests compare with recordings that are not part of this
//! repository.
//!
//! Sets `has_shared_data` if the recordings lie in `../shared/data` beside the workspace. If the
//! folder is missing, cargo counts these tests as ignored and gives the reason. `SHARED_DATA` is
//! the path of the folder.

use std::path::{Path, PathBuf};

pub(crate) fn main() {
    let crate_folder = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo names the crate's folder"));
    println!("cargo::rustc-check-cfg=cfg(has_shared_data)");
    println!("cargo::rerun-if-changed=../build/shared_data.rs");
    let data = crate_folder.join("../../shared/data");
    println!("cargo::rustc-env=SHARED_DATA={}", data.display());
    watch(&data);
    if data.is_dir() {
        println!("cargo::rustc-cfg=has_shared_data");
    }
}

/// Looks again when the folder comes or goes.
///
/// Cargo builds a crate anew in every run if a path that it watches is missing. So cargo watches
/// the folder if it exists, and otherwise the folder above it. If both are missing, the test
/// `recordings_are_absent_as_they_were_when_this_was_built` says what to do once they are there.
fn watch(data: &Path) {
    let above = data.parent().filter(|above| above.is_dir());
    if let Some(folder) = if data.is_dir() { Some(data) } else { above } {
        println!("cargo::rerun-if-changed={}", folder.display());
    }
}
