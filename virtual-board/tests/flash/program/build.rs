//! Passes the link script to the linker.

fn main() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").unwrap();
    println!("cargo:rustc-link-arg=-T{folder}/link.ld");
    println!("cargo:rustc-link-arg=--nmagic");
    println!("cargo:rerun-if-changed=link.ld");
}
