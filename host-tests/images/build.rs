//! Gives the linker the script that all images share.

fn main() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    println!("cargo::rustc-link-arg=-T{folder}/../link.ld");
    println!("cargo::rustc-link-arg=--nmagic");
    println!("cargo::rerun-if-changed=../build.rs");
    println!("cargo::rerun-if-changed=../link.ld");
}
