//! Thumb program of these tests, built once, and a machine that has loaded it.

use std::path::Path;

use virtual_core::{Image, Machine};

/// Returns the ELF file of the program.
pub(crate) fn elf() -> Vec<u8> {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/Cargo.toml");
    virtual_core::build(Path::new(manifest)).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns a new machine with the program loaded.
pub(crate) fn machine() -> Machine {
    Machine::new(&Image::from_elf(&elf()).unwrap()).unwrap()
}
