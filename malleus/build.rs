//! Build script: sets `has_shared_data` and `has_chromium` if the recordings and a browser are
//! here.
//!
//! If they are absent, cargo counts the tests that need them as ignored.

#[path = "../build/shared_data.rs"]
mod shared_data;

/// Names of the programs under which Chromium may be installed.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

fn main() {
    shared_data::main();
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=PATH");
    println!("cargo::rustc-check-cfg=cfg(has_chromium)");
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let mut found = std::env::split_paths(&folders).flat_map(|folder| BROWSERS.map(|name| folder.join(name)));
    if let Some(browser) = found.find(|file| file.is_file()) {
        println!("cargo::rustc-cfg=has_chromium");
        println!("cargo::rustc-env=CHROMIUM={}", browser.display());
    }
}
